# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Discs on surfaces, and their embeddings in the plane."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.deformation.planar_embedding import embedded, on_unit_disc
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.mesh_discs import FaceGraph, MeshDisc
from tests.shapes import ball, torus


@pytest.fixture(scope="module")
def graph():
    return FaceGraph.of(ball(points=600))


def above(mesh, height):
    return np.flatnonzero(mesh.corners[:, :, 2].min(axis=1) > height)


def test_a_ring_of_triangles_is_filled_to_a_disc(graph):
    cap, pole = above(graph.mesh, 0.6), above(graph.mesh, 0.9)
    ring = np.setdiff1d(cap, pole)
    assert MeshDisc.of(graph.mesh, ring) is None
    disc = graph.disc_around(ring, 0)
    np.testing.assert_array_equal(disc.triangles, cap)
    rim = graph.mesh.vertices[disc.vertices[disc.rim]]
    # Counter-clockwise seen from above.
    assert np.cross(rim, np.roll(rim, -1, axis=0))[:, 2].min() > 0.0
    assert len(disc.inner) + len(disc.rim) == len(disc.vertices)


@pytest.mark.parametrize("height", [-0.5, 0.3])
def test_on_a_small_surface_the_largest_part_is_outside(height):
    graph = FaceGraph.of(ball(points=60))
    middle = graph.mesh.corners[:, :, 2].mean(axis=1)
    band = np.flatnonzero(np.abs(middle - height) < 0.25)
    small = np.flatnonzero(middle * np.sign(height) > abs(height))
    np.testing.assert_array_equal(graph.filled(band), np.union1d(band, small))


def test_a_disc_at_a_border_includes_what_it_separates_from_the_rest():
    mesh = ball(points=1000)
    half = TriangleMesh(mesh.vertices, mesh.faces[above(mesh, 0.0)])
    places = half.corners[:, :, 0].mean(axis=1)
    strip = np.flatnonzero((places > 0.6) & (places < 0.8))
    assert MeshDisc.of(half, strip) is not None
    disc = FaceGraph.of(half).disc_around(strip, 0)
    np.testing.assert_array_equal(disc.triangles, np.flatnonzero(places > 0.6))


def test_rings_are_the_triangles_that_share_vertices(graph):
    faces = graph.mesh.faces
    for start in (5, 900):
        expected = np.array([start])
        for rings in range(4):
            np.testing.assert_array_equal(graph.grown(np.array([start]), rings), expected)
            expected = np.flatnonzero(np.isin(faces, faces[expected]).any(axis=1))


def test_two_parts_grow_together(graph):
    far = above(graph.mesh, 0.9)[[0, -1]]
    disc = graph.disc_around(far, 12)
    assert np.isin(far, disc.triangles).all()


def test_the_whole_of_a_handle_is_no_disc():
    graph = FaceGraph.of(torus())
    around = np.flatnonzero(graph.mesh.corners[:, :, 0].min(axis=1) > -2.0)
    assert graph.disc_around(around, 3) is None


def test_embeddings_in_a_circle_flip_nothing(graph):
    disc = graph.disc_around(above(graph.mesh, -0.8), 0)
    places = on_unit_disc(graph.mesh.vertices[disc.vertices], disc)
    one, other = (places[disc.faces[:, k]] - places[disc.faces[:, 0]] for k in (1, 2))
    assert (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).min() > 0.0
    assert np.linalg.norm(places, axis=1).max() == pytest.approx(1.0)


def test_an_inner_vertex_is_the_mean_of_its_neighbors_by_inverse_lengths():
    rim = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-4.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    mesh = TriangleMesh(np.concatenate([rim, np.zeros((1, 3))]), np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]))
    disc = MeshDisc.of(mesh, np.arange(4))
    places = np.array([[3.0, 0.0], [0.0, 3.0], [-3.0, 0.0], [0.0, -3.0]])
    found = embedded(mesh.vertices, disc, places[disc.rim])
    np.testing.assert_allclose(found[:4], places)
    # Weights 1, 1/2, 1/4 and 1.
    np.testing.assert_allclose(found[4], np.array([3.0 - 0.75, 1.5 - 3.0]) / 2.75)
