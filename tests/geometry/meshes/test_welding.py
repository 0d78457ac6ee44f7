# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coincident vertices are merged."""

import numpy as np

from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.welding import ClosedSeams, welded
from tests.shapes import ball, box, joined, piece_count


def in_triangles(mesh):
    """The mesh as separate triangles."""
    return TriangleMesh(mesh.corners.reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3))


def test_separate_triangles_become_a_closed_surface():
    whole = box()
    apart = in_triangles(whole)
    assert not topology(apart).closed
    joined = welded(apart)
    assert topology(joined).closed
    assert len(joined.vertices) == len(whole.vertices)
    np.testing.assert_array_equal(joined.corners, whole.corners)


def test_triangles_that_collapse_are_left_out():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [5, 5, 5]])
    joined = welded(TriangleMesh(points, np.array([[0, 1, 2], [0, 1, 3]])))
    assert len(joined.vertices) == 3
    assert len(joined.faces) == 1


def test_merged_vertices_keep_order_and_positions():
    rng = np.random.default_rng(0)
    points = rng.integers(-1, 2, (60, 3)).astype(float)
    faces = rng.integers(0, 50, (40, 3))
    joined = welded(TriangleMesh(points, faces))
    places, index = np.unique(points[faces].reshape(-1, 3), axis=0, return_inverse=True)
    np.testing.assert_array_equal(joined.vertices, places)
    a, b, c = index.reshape(-1, 3).T
    np.testing.assert_array_equal(joined.faces, index.reshape(-1, 3)[(a != b) & (b != c) & (c != a)])


def test_seams_are_closed_and_bodies_that_touch_stay_apart():
    apart = joined(in_triangles(ball(points=60)), box(), box(center=(1.0, 0.0, 0.0)))
    closed = ClosedSeams.of(apart)
    found = closed.mesh
    np.testing.assert_array_equal(found.faces, closed.merged[apart.faces])
    assert topology(found).closed
    assert piece_count(found) == 3
    np.testing.assert_array_equal(found.corners, apart.corners)


def test_without_seams_nothing_is_merged():
    opened = TriangleMesh(box().vertices, box().faces[:-1])
    closed = ClosedSeams.of(opened)
    assert closed.mesh is opened
    np.testing.assert_array_equal(closed.merged, np.arange(len(opened.vertices)))
