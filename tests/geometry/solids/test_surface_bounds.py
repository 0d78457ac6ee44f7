# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.level_sets.isosurface import surface_at_level
from convwass_addon.geometry.solids.surface_bounds import SurfaceBounds, cells_changed
from tests.shapes import ball, box as cuboid

SHAPE = (40, 40, 40)
CENTER = np.full(3, 20.0)
RADII = np.linalg.norm(np.indices(SHAPE).T + 0.5 - CENTER, axis=-1).T
BALL = ball(10.0, CENTER, points=3000)


def solid(radius):
    """Occupancy of a ball, about one half at its surface."""
    return (1.0 / (1.0 + np.exp(2.0 * (RADII - radius)))).astype(np.float32)


def radii_of(density):
    return np.linalg.norm(surface_at_level(density, 0.5).mesh.vertices - CENTER, axis=1)


def test_distances_of_a_ball():
    bounds = SurfaceBounds.of(BALL.corners, SHAPE, 2.0)
    near = np.abs(RADII - 10.0) < 4.0
    np.testing.assert_allclose(bounds.distances[near], (RADII - 10.0)[near], atol=0.6)
    # Farther away, nothing depends on the distance.
    assert bounds.distances[~near].min() < -3.5 and bounds.distances[~near & (RADII > 10.0)].min() > 3.5


@pytest.mark.parametrize(("radius", "expected"), [(14.0, 12.0), (5.0, 8.0), (11.0, 11.0)])
def test_a_ball_grows_or_shrinks_as_far_as_it_may(radius, expected):
    found = SurfaceBounds.of(BALL.corners, SHAPE, 2.0).limited(solid(radius), 0.5)
    np.testing.assert_allclose(radii_of(found), expected, atol=0.5)
    assert radii_of(found).mean() == pytest.approx(expected, abs=0.35)


def test_a_crack_that_opens_at_once_opens_from_outside():
    cracked = solid(10.0)
    cracked[20] = 0.0
    x, y, z = (
        surface_at_level(SurfaceBounds.of(BALL.corners, SHAPE, 2.0).limited(cracked, 0.5), 0.5).mesh.vertices - CENTER
    ).T
    in_crack = np.abs(x - 0.5) < 1.0
    assert np.hypot(y, z)[in_crack].min() == pytest.approx(8.0, abs=1.0)


def slender(length):
    """Occupancy of a box two cells wide that begins at x = 10, about one half at its surface."""
    x, y, z = np.indices(SHAPE) + 0.5
    depth = np.minimum(np.minimum(x - 10.0, 10.0 + length - x), 1.0 - np.maximum(np.abs(y - 20.0), np.abs(z - 20.0)))
    return (1.0 / (1.0 + np.exp(-2.0 * depth))).astype(np.float32)


SLENDER = SurfaceBounds.of(cuboid((12.0, 2.0, 2.0), (16.0, 20.0, 20.0)).corners, SHAPE, 2.0)


@pytest.mark.parametrize(("length", "expected"), [(13.0, 13.0), (18.0, 14.0)])
def test_the_tip_of_a_slender_part_moves_as_far_as_it_may(length, expected):
    limited, free = SLENDER.limited(slender(length), 0.5), slender(length)
    reached, wanted = (surface_at_level(each, 0.5).mesh.vertices[:, 0].max() - 10.0 for each in (limited, free))
    assert reached == pytest.approx(min(wanted, expected), abs=0.35)


def test_a_tip_that_moves_less_than_it_may_is_not_limited():
    assert cells_changed(slender(13.0), SLENDER.limited(slender(13.0), 0.5), 0.5) == 0


def half_space(depth):
    return np.broadcast_to(np.clip(0.5 + 0.2 * (depth - np.arange(20)), 0, 1)[:, None, None], (20, 8, 8))


@pytest.mark.parametrize(("moved", "expected"), [(0.0, 0), (0.2, 0), (0.3, 64), (1.3, 64)])
def test_cells_beside_which_a_plane_moves(moved, expected):
    assert cells_changed(half_space(9.6), half_space(9.6 + moved), 0.5) == expected


def test_a_vanished_cell_is_counted():
    before = np.zeros((9, 9, 9))
    before[4, 4, 4] = 1.0
    assert cells_changed(before, np.zeros_like(before), 0.5) == 1


def test_a_box_of_a_density_is_limited_alike():
    bounds, box = SurfaceBounds.of(BALL.corners, SHAPE, 2.0), (slice(5, 35), slice(3, 38), slice(6, 36))
    np.testing.assert_array_equal(bounds.limited(solid(14.0)[box], 0.5, box), bounds.limited(solid(14.0), 0.5)[box])


@pytest.mark.parametrize("corners", [BALL.corners + 1000.0, BALL.corners - 1000.0, BALL.corners[:1]])
def test_a_surface_that_encloses_nothing_in_the_grid_sets_no_limits(corners):
    """Such as a shape far away, or an open one."""
    density = solid(14.0)
    np.testing.assert_array_equal(SurfaceBounds.of(corners, SHAPE, 2.0).limited(density, 0.5), density)


def test_parts_outside_the_grid_are_ignored():
    far = BALL.corners - 1000.0
    bounds = [SurfaceBounds.of(corners, SHAPE, 2.0) for corners in (BALL.corners, np.concatenate([BALL.corners, far]))]
    inner = (slice(3, -3),) * 3
    np.testing.assert_allclose(bounds[1].distances[inner], bounds[0].distances[inner], atol=1e-6)
