# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles split at long edges: the same surface, closed where it was."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.edges import edge_ends, edge_use, topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing.subdivision import with_edges_halved, with_short_edges
from tests.shapes import ball, box


def edge_lengths(mesh):
    return np.linalg.norm(mesh.corners - np.roll(mesh.corners, 1, axis=1), axis=2)


@pytest.mark.parametrize("longest", [2.0, 1.2, 0.7, 0.11])
def test_the_surface_is_unchanged(longest):
    mesh = box((1.0, 2.0, 0.3))
    found = with_short_edges(mesh, longest, 100_000)
    assert edge_lengths(found.mesh).max() <= longest
    assert topology(found.mesh) == topology(mesh)
    assert found.mesh.area == pytest.approx(mesh.area)
    assert found.mesh.volume == pytest.approx(mesh.volume)
    np.testing.assert_array_equal(found.mesh.vertices[: len(mesh.vertices)], mesh.vertices)


def test_parts_lie_in_their_parent_triangles():
    mesh = box((1.0, 2.0, 0.3))
    found = with_short_edges(mesh, 0.25, 100_000)
    normals = np.cross(mesh.corners[:, 1] - mesh.corners[:, 0], mesh.corners[:, 2] - mesh.corners[:, 0])
    away = np.einsum("tcd,td->tc", found.mesh.corners - mesh.corners[found.parents][:, :1], normals[found.parents])
    np.testing.assert_allclose(away, 0.0, atol=1e-12)
    corners = found.mesh.corners
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    np.testing.assert_allclose(np.bincount(found.parents, areas), np.linalg.norm(normals, axis=1))


def test_edges_that_become_long_are_divided():
    """Along x, where the shape is stretched."""
    mesh = box((1.0, 1.0, 1.0))
    found = with_short_edges(mesh, 2.0, 1000, image=lambda points: points * (5.0, 1.0, 1.0)).mesh
    corners = found.corners * (5.0, 1.0, 1.0)
    assert np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() <= 2.0
    assert found.volume == pytest.approx(mesh.volume)
    assert 8 < len(found.vertices) < len(with_short_edges(mesh, 2.0 / 5.0, 10_000).mesh.vertices)


def test_short_edges_are_not_divided_however_long_they_become():
    small = box((0.2, 0.2, 0.2))
    assert with_short_edges(small, 2.0, 1000, image=lambda points: points * 100.0).mesh is small


def test_short_edges_are_unchanged():
    mesh = ball(points=200)
    found = with_short_edges(mesh, 3.0, 1000)
    assert found.mesh is mesh
    assert found.parents is None


def test_the_number_of_vertices_is_limited():
    found = with_short_edges(box(), 0.01, 60)
    assert 8 < len(found.mesh.vertices) <= 60


def test_nonmanifold_and_boundary_edges_are_split():
    fan = TriangleMesh.from_arrays(
        [(0, 0, 0), (1, 0, 0), (0.5, 1, 0), (0.5, -1, 0), (0.5, 0, 1)], [(0, 1, 2), (1, 0, 3), (0, 1, 4)]
    )
    found = with_short_edges(fan, 0.6, 1000).mesh
    assert found.area == pytest.approx(fan.area)
    # The shared edge gets one midpoint.
    on_axis = np.abs(found.vertices[:, 1:]).max(axis=1) < 1e-12
    np.testing.assert_allclose(np.sort(found.vertices[on_axis, 0]), [0.0, 0.5, 1.0])


def test_only_the_chosen_edges_are_split():
    mesh = ball(points=200)
    use = edge_use(mesh.faces)
    chosen = np.zeros(len(use.start), bool)
    chosen[::15] = True
    found = with_edges_halved(mesh, use, chosen)
    assert topology(found.mesh) == topology(mesh)
    assert len(found.mesh.faces) == len(mesh.faces) + 2 * chosen.sum()
    np.testing.assert_array_equal(found.ends, edge_ends(mesh.faces, use)[chosen])
    np.testing.assert_allclose(found.mesh.vertices[len(mesh.vertices) :], mesh.vertices[found.ends].mean(axis=1))
    assert found.mesh.volume == pytest.approx(mesh.volume)
    # Pairs of triangles at even rows, which may be quads, remain pairs at even rows.
    counts = np.bincount(found.parents)
    paired = np.flatnonzero((counts[0::2] == 1) & (counts[1::2] == 1))
    rows = np.stack([2 * paired, 2 * paired + 1], axis=1).ravel()
    assert len(rows) > 10
    np.testing.assert_array_equal(found.parents[: len(rows)], rows)
