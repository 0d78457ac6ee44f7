# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.optimize import nnls

from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder, TriangleSamples, closest_in_triangles
from tests.shapes import ball, box, joined, square, torus


def by_force(corners, points):
    """Distances to the closest of all triangles, each from a least-squares problem with coordinates of sum 1."""
    distances = np.empty((len(points), len(corners)))
    scale = 1e5 * (np.abs(corners).max() + np.abs(points).max())
    for row, point in zip(distances, points, strict=True):
        for index, triangle in enumerate(corners):
            shares, _ = nnls(np.vstack([triangle.T, np.full(3, scale)]), np.append(point, scale))
            row[index] = np.linalg.norm(shares / shares.sum() @ triangle - point)
    return distances.min(axis=1)


def check(corners, points):
    found = ClosestPointFinder(corners).find(points)
    assert (found.shares >= 0).all()
    np.testing.assert_allclose(found.shares.sum(axis=1), 1.0)
    places = found.interpolated(corners)
    np.testing.assert_allclose(np.linalg.norm(places - points, axis=1), found.distances, atol=1e-9)
    return found


@pytest.mark.parametrize("shape", [box((1, 2, 3)), joined(ball(1.0, points=30), square(2.0, (3, 0, 0)))])
def test_distances_agree_with_brute_force(shape):
    points = np.random.default_rng(3).uniform(-3, 3, (25, 3))
    found = check(shape.corners, points)
    np.testing.assert_allclose(found.distances, by_force(shape.corners, points), atol=1e-4)


def test_near_and_distant_points_of_a_torus():
    shape = torus(2.0, 0.5, segments=(120, 60))
    points = np.random.default_rng(5).normal(size=(1000, 3)) * 3
    ring = np.hypot(points[:, 0], points[:, 1]) - 2.0
    exact = np.abs(np.hypot(ring, points[:, 2]) - 0.5)
    np.testing.assert_allclose(check(shape.corners, points).distances, exact, atol=3e-3)


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-3, 1.0, 50.0]), st.integers(1, 40))
def test_triangles_of_all_sizes_agree_with_brute_force(seed, spread, count):
    generator = np.random.default_rng(seed)
    sizes = 10.0 ** generator.uniform(-3, 1, (count, 1, 1))
    corners = generator.normal(size=(count, 1, 3)) * spread + generator.normal(size=(count, 3, 3)) * sizes
    points = generator.normal(size=(10, 3)) * spread
    size = np.abs(corners).max() + np.abs(points).max()
    np.testing.assert_allclose(check(corners, points).distances, by_force(corners, points), atol=1e-5 * size)


def test_local_search_is_nearly_as_accurate():
    shape = torus(2.0, 0.5, segments=(120, 60))
    points = np.random.default_rng(7).normal(size=(3000, 3)) * 0.03 + shape.corners[:3000, 1]
    finder = ClosestPointFinder(shape.corners)
    exact, about = finder.find(points).distances, finder.find_about(points).distances
    assert (about >= exact - 1e-12).all()
    assert np.mean(about > exact + 1e-6) < 0.03
    assert (about - exact).max() < 0.02


def test_degenerate_triangles_are_segments_and_points():
    corners = np.array([[[0, 0, 0], [2, 0, 0], [1, 0, 0]], [[5, 5, 5], [5, 5, 5], [5, 5, 5]]], dtype=float)
    found = check(corners, np.array([[1.0, 3, 0], [-1, 0, 0], [5, 5, 7]]))
    np.testing.assert_allclose(found.distances, [3, 1, 2])
    assert found.triangles[2] == 1


def test_values_of_corners_are_interpolated():
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], dtype=float)
    found = ClosestPointFinder(corners).find([[0.25, 0.5, 3.0]])
    np.testing.assert_allclose(found.interpolated(np.array([[[0.0], [1.0], [10.0]]])), [[5.25]])


@pytest.mark.parametrize("radius", [3.0, 1.0, 0.3, 0.11])
def test_samples_are_within_their_radius_of_every_point_and_balanced(radius):
    generator = np.random.default_rng(2)
    corners = generator.normal(size=(20, 3, 3))
    samples = TriangleSamples.spaced(corners, radius)
    nearest = np.full((20, 200), np.inf)
    everywhere = np.einsum("nkc,ncd->nkd", generator.dirichlet([0.7] * 3, (20, 200)), corners)
    for point, triangle in zip(samples.points, samples.triangles, strict=True):
        nearest[triangle] = np.minimum(nearest[triangle], np.linalg.norm(everywhere[triangle] - point, axis=1))
    assert nearest.max() <= samples.radius
    means = [samples.points[samples.triangles == triangle].mean(axis=0) for triangle in range(20)]
    np.testing.assert_allclose(means, corners.mean(axis=1), atol=1e-12)


def test_samples_of_an_equilateral_triangle_are_spaced_exactly():
    corners = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0]]])
    for cuts in (1, 2, 5):
        samples = TriangleSamples.spaced(corners, 1.0 / np.sqrt(3.0) / cuts)
        assert len(samples.points) == cuts**2
        assert samples.radius == pytest.approx(1.0 / np.sqrt(3.0) / cuts)


def test_points_that_every_triangle_may_be_closest_to_agree_with_measuring_all():
    """There are more pairs of points and triangles than are measured at once."""
    corners, points = ball(points=1500).corners, 1e-4 * np.random.default_rng(8).normal(size=(40, 3))
    found = ClosestPointFinder(corners).find(points)
    exact = [closest_in_triangles(corners, np.tile(point, (len(corners), 1))).distances.min() for point in points]
    np.testing.assert_allclose(found.distances, exact, rtol=1e-12)


def test_no_points_are_accepted_and_no_triangles_are_refused():
    assert len(ClosestPointFinder(box().corners).find(np.empty((0, 3))).triangles) == 0
    with pytest.raises(ValueError, match="at least one triangle"):
        ClosestPointFinder(np.empty((0, 3, 3)))
    with pytest.raises(ValueError, match="corners must be finite"):
        ClosestPointFinder(np.full((1, 3, 3), np.nan))
