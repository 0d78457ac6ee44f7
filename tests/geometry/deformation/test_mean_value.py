# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mean value coordinates reproduce points inside, on the surface and outside."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from convwass_addon.geometry.deformation.mean_value import (
    mean_value_coordinates,
    polygon_coordinates,
    positive_coordinates,
)
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.solid_angles import winding_numbers
from tests.shapes import ball, box, joined, torus

_TETRAHEDRON = TriangleMesh.from_arrays(
    [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
)
_SHARES = st.lists(st.floats(0.02, 1.0), min_size=4, max_size=4)


@given(_SHARES)
def test_a_tetrahedron_has_barycentric_coordinates(numbers):
    shares = np.array(numbers) / np.sum(numbers)
    found = mean_value_coordinates(shares @ _TETRAHEDRON.vertices, _TETRAHEDRON)
    np.testing.assert_allclose(found[0], shares, atol=1e-7)


@given(st.lists(st.floats(0.1, 1.0), min_size=3, max_size=3), st.booleans())
def test_a_triangle_has_barycentric_coordinates(numbers, clockwise):
    shares = np.array(numbers) / np.sum(numbers)
    corners = np.array([(0.0, 0.0), (2.0, 0.0), (0.5, 1.0)])
    order = slice(None, None, -1 if clockwise else 1)
    found = polygon_coordinates((shares @ corners)[None], corners[order])
    np.testing.assert_allclose(found[0, order], shares, atol=1e-9)


def test_points_in_a_polygon_are_reproduced():
    """Also where it is not convex, so that some weights are negative."""
    corners = np.array([(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)])
    points = np.array([(0.5, 0.5), (2.5, 0.5), (0.5, 2.5), (0.9, 0.9)])
    found = polygon_coordinates(points, corners)
    assert found.min() < 0
    np.testing.assert_allclose(found.sum(axis=1), 1.0)
    np.testing.assert_allclose(found @ corners, points, atol=1e-9)


@pytest.mark.parametrize("mesh", [box(angles=(0.3, 0.5, 0.1)), ball(points=300), torus()], ids=["box", "ball", "torus"])
def test_points_are_reproduced(mesh):
    low, high = mesh.bounds
    points = np.random.default_rng(1).uniform(low - 0.2, high + 0.2, (200, 3))
    weights = mean_value_coordinates(points, mesh)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    assert np.abs(weights @ mesh.vertices - points).max() < 1e-9


def test_convex_bodies_have_positive_weights():
    mesh = ball(points=200)
    points = np.random.default_rng(0).normal(size=(50, 3))
    points *= 0.9 / np.linalg.norm(points, axis=1, keepdims=True)
    assert mean_value_coordinates(points, mesh).min() > 0


def test_on_the_surface_they_are_barycentric():
    mesh = torus(segments=(12, 8))
    a, b, c = mesh.corners[5]
    points = np.stack([a, 0.25 * a + 0.75 * b, 0.2 * a + 0.3 * b + 0.5 * c])
    expected = np.zeros((3, len(mesh.vertices)))
    expected[0, mesh.faces[5, 0]] = 1.0
    expected[1, mesh.faces[5, :2]] = 0.25, 0.75
    expected[2, mesh.faces[5]] = 0.2, 0.3, 0.5
    np.testing.assert_allclose(mean_value_coordinates(points, mesh), expected, atol=1e-12)


def test_they_are_continuous_at_the_surface():
    mesh = box()
    corners, inward = mesh.corners[0], -mesh.corners[0].mean(axis=0)
    shares = np.array([0.2, 0.3, 0.5])
    on, below = mean_value_coordinates([shares @ corners, shares @ corners + 1e-6 * inward], mesh)
    np.testing.assert_allclose(below, on, atol=1e-4)


def test_points_in_the_planes_of_triangles():
    mesh = joined(box(), box(center=(3.0, 0.0, 0.0)))
    # The points lie in planes of faces of either box, and on lines through edges.
    points = np.array([[0.0, 0.1, 0.5 - 1e-13], [0.2, 0.2, 0.0], [0.0, 0.0, 0.0]])
    assert np.abs(mean_value_coordinates(points, mesh) @ mesh.vertices - points).max() < 1e-7


def test_degenerate_triangles_have_no_weight():
    mesh = box()
    needle = TriangleMesh(mesh.vertices, np.concatenate([mesh.faces, [[0, 0, 1], [2, 3, 2]]]))
    points = [[0.1, 0.2, -0.3]]
    np.testing.assert_allclose(mean_value_coordinates(points, needle), mean_value_coordinates(points, mesh))


def test_positive_weights_reproduce_points_of_a_torus():
    mesh = torus()
    points = np.random.default_rng(2).uniform(*mesh.bounds, (200, 3))
    points = points[winding_numbers(points, mesh) > 0.5]
    weights = mean_value_coordinates(points, mesh)
    found = positive_coordinates(weights, points, mesh.vertices)
    assert weights.min() < 0 <= found.min()
    assert np.abs(found @ mesh.vertices - points).max() < 1e-9
    np.testing.assert_allclose(found.sum(axis=1), 1.0)


def test_points_beyond_the_hull_are_not_exact():
    mesh = box()
    points = np.array([[3.0, 0.0, 0.0], [0.1, 0.1, 0.1]])
    found = positive_coordinates(mean_value_coordinates(points, mesh), points, mesh.vertices)
    errors = np.abs(found @ mesh.vertices - points).max(axis=1)
    assert (errors < 1e-9).tolist() == [False, True]
    assert found.min() >= 0
    np.testing.assert_allclose(found.sum(axis=1), 1.0)
