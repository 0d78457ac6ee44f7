# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends are shaded as their shapes are."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.shading import Shading, frame_normals
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import triangle_normals, vertex_normals
from convwass_addon.geometry.remeshing.subdivision import with_short_edges
from tests.shapes import ball, box

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""A quarter turn about z, for columns."""


def flat(mesh):
    return Shading(mesh.corners, mesh.faces, np.repeat(triangle_normals(mesh.corners)[:, None], 3, axis=1))


def smooth(mesh):
    return Shading(mesh.corners, mesh.faces, vertex_normals(mesh.vertices, mesh.faces)[mesh.faces])


def finer(mesh):
    found = with_short_edges(mesh, 0.3, 10_000)
    return found.mesh, found.parents.astype(np.int32)


def test_a_turned_box_stays_flat():
    shape = box((1.0, 2.0, 3.0))
    mesh, parents = finer(shape)
    turned = TriangleMesh(mesh.vertices @ TURN.T, mesh.faces)
    found = frame_normals(turned, mesh.vertices[None], parents[None], [flat(shape)], (1.0,))
    assert found.of_corners
    expected = np.repeat(triangle_normals(turned.corners), 3, axis=0)
    np.testing.assert_allclose(found.vectors, expected, atol=1e-6)


def test_normals_set_by_hand_turn_with_the_shape():
    shape = box()
    mesh, parents = finer(shape)
    leaning = flat(shape).normals + np.array([0.3, 0.1, 0.2])
    leaning /= np.linalg.norm(leaning, axis=2, keepdims=True)
    turned = TriangleMesh(mesh.vertices @ TURN.T, mesh.faces)
    shading = Shading(shape.corners, shape.faces, leaning)
    found = frame_normals(turned, mesh.vertices[None], parents[None], [shading], (1.0,))
    np.testing.assert_allclose(found.vectors, np.repeat(leaning[parents][:, 0] @ TURN.T, 3, axis=0), atol=1e-6)


def test_a_coarse_smooth_ball_shows_no_facets():
    """Its blends have the normals that renders interpolate over its facets."""
    shape = ball(points=100)
    mesh, parents = finer(shape)
    found = frame_normals(mesh, mesh.vertices[None], parents[None], [smooth(shape)], (1.0,))
    assert not found.of_corners
    expected = ClosestPointFinder(shape.corners).find(mesh.vertices).interpolated(smooth(shape).normals)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    np.testing.assert_allclose(found.vectors, expected, atol=1e-5)


def test_a_fine_smooth_ball_needs_no_normals():
    mesh = ball(points=3000)
    triangles = np.arange(len(mesh.faces), dtype=np.int32)
    assert frame_normals(mesh, mesh.vertices[None], triangles[None], [smooth(mesh)], (1.0,)) is None


def test_normals_are_averaged_with_the_weights():
    """Half flat and half smooth: each normal lies between both."""
    shape = ball(points=100)
    triangles = np.arange(len(shape.faces), dtype=np.int32)
    origins, both = np.stack([shape.vertices] * 2), np.stack([triangles] * 2)
    found = frame_normals(shape, origins, both, [flat(shape), smooth(shape)], (0.25, 0.75))
    mean = 0.25 * flat(shape).normals + 0.75 * smooth(shape).normals
    mean /= np.linalg.norm(mean, axis=2, keepdims=True)
    np.testing.assert_allclose(found.vectors.reshape(-1, 3, 3), mean, atol=1e-6)


@pytest.mark.parametrize("triangle", [-1, 10_000])
def test_without_a_known_triangle_the_surface_has_its_own_normals(triangle):
    shape = box()
    triangles = np.full((1, len(shape.faces)), triangle, np.int32)
    found = frame_normals(shape, shape.vertices[None], triangles, [flat(shape)], (1.0,))
    expected = vertex_normals(shape.vertices, shape.faces)[shape.faces].reshape(-1, 3)
    np.testing.assert_allclose(found.vectors, expected, atol=1e-6)
