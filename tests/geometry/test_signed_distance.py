# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Signed distances against those of a box and a sphere, and against closest points."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.closest_points import ClosestPointFinder
from convwass_addon.geometry.signed_distance import signed_distance
from convwass_addon.progress import Control
from tests.shapes import ball, box, joined, square, torus

REACH = 2.5


def voxel_centers(shape):
    return np.stack(np.meshgrid(*(np.arange(length) + 0.5 for length in shape), indexing="ij"), axis=-1)


def box_distance(points, size):
    """The distance from a box around the origin (I. Quilez, "Distance functions")."""
    beyond = np.abs(points) - 0.5 * np.asarray(size)
    return np.linalg.norm(np.maximum(beyond, 0.0), axis=-1) + np.minimum(beyond.max(axis=-1), 0.0)


@pytest.mark.parametrize("size", [(12.0, 7.3, 9.1), (3.0, 17.0, 0.4)])
def test_a_box(size):
    shape, center = (20, 24, 18), np.array([10.2, 11.9, 9.3])
    found = signed_distance(box(size, center).corners, shape, REACH)
    expected = np.clip(box_distance(voxel_centers(shape) - center, size), -REACH, REACH)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_a_sphere():
    shape, center, radius = (30, 30, 30), np.array([15.1, 14.8, 15.3]), 11.0
    found = signed_distance(ball(radius, center, points=20_000).corners, shape, REACH)
    expected = np.clip(np.linalg.norm(voxel_centers(shape) - center, axis=-1) - radius, -REACH, REACH)
    # Flat triangles lie a little inside of the sphere.
    np.testing.assert_allclose(found, expected, atol=2e-3)


@pytest.mark.parametrize(
    "mesh",
    [torus(8.0, 3.0, (14.0, 14.0, 14.0)), joined(ball(6.0, (9, 9, 9), points=300), box((9, 9, 9), (18, 18, 18)))],
)
def test_sizes_are_those_of_closest_points(mesh):
    shape = (28, 28, 28)
    found = signed_distance(mesh.corners, shape, REACH)
    near = np.abs(found) < REACH
    points = voxel_centers(shape)
    exact = ClosestPointFinder(mesh.corners).find(points[near]).distances
    np.testing.assert_allclose(np.abs(found[near]), exact, atol=1e-5)
    far = ClosestPointFinder(mesh.corners).find(points[~near]).distances
    assert far.min() > REACH - 1e-5
    assert 0.05 < (found < 0).mean() < 0.4


def test_triangles_without_area_are_lines_and_points():
    corners = np.array([[[4.0, 4, 4], [9, 4, 4], [6, 4, 4]], [[2.0, 8, 8], [2, 8, 8], [2, 8, 8]]])
    shape = (12, 12, 12)
    nowhere = np.zeros(shape, bool)
    found = signed_distance(corners, shape, REACH, nowhere)
    points = voxel_centers(shape)
    line = points - np.array([4.0, 4, 4])
    line[..., 0] -= np.clip(line[..., 0], 0.0, 5.0)
    expected = np.minimum(np.linalg.norm(line, axis=-1), np.linalg.norm(points - (2.0, 8, 8), axis=-1))
    np.testing.assert_allclose(found, np.minimum(expected, REACH), atol=1e-5)


def test_what_lies_outside_of_the_grid_counts_in_it():
    shape = (8, 9, 10)
    sheet = square(40.0, (4.0, 4.0, 10.7)).corners
    found = signed_distance(sheet, shape, REACH, np.zeros(shape, bool))
    expected = np.minimum(10.7 - voxel_centers(shape)[..., 2], REACH)
    np.testing.assert_allclose(found, expected, atol=1e-5)
    away = signed_distance(sheet + 50.0, shape, REACH, np.ones(shape, bool))
    np.testing.assert_array_equal(away, np.full(shape, -REACH, np.float32))


def test_the_sign_is_that_of_the_winding_number():
    """Of two nested balls that both look outward the inner one is no cavity."""
    mesh = joined(ball(7.0, (10, 10, 10), points=300), ball(3.0, (10, 10, 10), points=100))
    assert (signed_distance(mesh.corners, (20, 20, 20), REACH)[9:11, 9:11, 9:11] < 0).all()
    hollow = joined(ball(7.0, (10, 10, 10), points=300), ball(3.0, (10, 10, 10), points=100).flipped())
    assert (signed_distance(hollow.corners, (20, 20, 20), REACH)[9:11, 9:11, 9:11] > 0).all()


def test_it_can_be_stopped():
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        signed_distance(box((5, 5, 5), (5, 5, 5)).corners, (10, 10, 10), REACH, control=control)
