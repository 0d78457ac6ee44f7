# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Limbs of flat shapes are what the shortest cuts from concave points separate."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.closed_curves import ClosedCurve, boundary_of
from convwass_addon.geometry.plane.outline_limbs import outline_limbs, without_limb
from convwass_addon.geometry.plane.plane_angles import rotated
from tests.flat_shapes import ellipse, rectangle

LETTER_T = np.array([(-0.5, 0), (0.5, 0), (0.5, 4), (2, 4), (2, 5), (-2, 5), (-2, 4), (-0.5, 4)], float)
# One unit wide.
LETTER_L = np.array([(0, 0), (4, 0), (4, 1), (1, 1), (1, 8), (0, 8)], float)


def limbs(ring, *holes):
    curve = ring if isinstance(ring, ClosedCurve) else ClosedCurve(np.asarray(ring, float))
    area = boundary_of([curve]).area
    return outline_limbs(curve, list(map(ClosedCurve, holes)), (0.02 * area, 0.3 * area))


@pytest.mark.parametrize("angle", [0.0, 0.4, 2.0])
@pytest.mark.parametrize("size", [1.0, 1e-3, 1e4])
def test_the_arms_of_a_t(angle, size):
    found = limbs(size * rotated(LETTER_T, angle))
    assert [limb.width for limb in found] == pytest.approx([size, size])
    centers = np.array([boundary_of([limb.outline]).center for limb in found]) / size
    centers = rotated(centers, -angle)
    assert sorted(centers[:, 0]) == pytest.approx([-1.25, 1.25])
    assert centers[:, 1] == pytest.approx([4.5, 4.5])
    axes = rotated(np.array([limb.axis for limb in found]), -angle)
    assert axes == pytest.approx(np.sign(centers[:, :1]) * (1.0, 0.0), abs=1e-9)
    for limb in found:
        places, distances = limb.coordinates(limb.outline.points).T
        assert sorted(places) == pytest.approx([0, 0, 1, 1], abs=1e-9)
        assert sorted(distances) == pytest.approx([0, 0, 1.5 * size, 1.5 * size], abs=1e-9 * size)


def test_a_t_without_arms_is_an_i():
    once = without_limb(limbs(LETTER_T)[0])
    (other,) = limbs(once)
    left = without_limb(other)
    assert boundary_of([left]).area == pytest.approx(5.0)
    assert boundary_of([left]).bounds == pytest.approx(np.array([(-0.5, 0.0), (0.5, 5.0)]))


@pytest.mark.parametrize(
    "ring",
    [ellipse(), rectangle(), np.array([(0, 0), (3, 0), (1, 1), (0, 3)], float), ellipse(radii=(4.0, 0.5))],
    ids=["disc", "square", "kite", "ellipse"],
)
def test_shapes_without_limbs(ring):
    assert limbs(ring) == []


def test_limbs_are_small():
    """The long stroke of an L is more than half of it."""
    (limb,) = limbs(LETTER_L)
    assert boundary_of([limb.outline]).area == pytest.approx(3.0)
    assert without_limb(limb).length == pytest.approx(18.0)


def test_what_has_a_hole_is_no_limb():
    hole = np.array([(2.3, 0.3), (2.3, 0.7), (2.7, 0.7), (2.7, 0.3)])
    assert limbs(LETTER_L, hole) == []


def test_how_far_a_limb_with_a_slanted_end_reaches():
    """From four at its lower side to two at its upper one; places near each other have the larger reach."""
    slanted = np.array([(0, 0), (5, 0), (3, 1), (1, 1), (1, 12), (0, 12)], float)
    (limb,) = limbs(slanted)
    heights = np.linspace(0.25, 0.9, 5)
    places = limb.coordinates(np.column_stack([np.full(5, 1.0), heights]))[:, 0]
    slope = limb.axis[1] / limb.axis[0]
    # Lines along the axis from the cut meet x = 5 - 2 y.
    ends = (5.0 - 2.0 * (heights - 0.05) - 1.0) / (1.0 + 2.0 * slope)
    assert limb.reaches(places) == pytest.approx(ends / limb.axis[0])


def test_how_far_a_limb_with_a_step_at_its_end_reaches():
    stepped = np.array([(0, 0), (4, 0), (4, 0.4), (3, 0.4), (3, 1), (1, 1), (1, 12), (0, 12)], float)
    limb = limbs(stepped)[-1]
    assert abs(limb.axis[1]) < 0.1
    lower, upper = limb.reaches(np.array([0.2, 0.8]))
    assert (lower, upper) == pytest.approx((3.0, 2.0), abs=0.02)


def test_a_limb_is_sampled_at_its_corners_and_marks():
    (limb,) = limbs(LETTER_L)
    points = limb.sampled(0.8, np.array([(2.3, 0.0), (0.0, 4.0), (2.5, 0.5)])).tolist()
    assert [(x, y) for x, y in points if y == pytest.approx(0.0)][1] == pytest.approx((1.65, 0.0))
    assert [2.3, 0.0] in [pytest.approx(point) for point in points]
    assert [point for point in points if point in ([4.0, 0.0], [4.0, 1.0])] == [[4.0, 0.0], [4.0, 1.0]]
    assert np.ptp(points, axis=0) == pytest.approx([3.0, 1.0])


def test_a_limb_across_the_first_point_of_the_outline():
    for shift in range(len(LETTER_T)):
        found = limbs(np.roll(LETTER_T, shift, axis=0))
        assert [boundary_of([limb.outline]).area for limb in found] == pytest.approx([1.5, 1.5])


def test_noise_has_no_limbs():
    around = np.linspace(0.0, 2.0 * np.pi, 1000, endpoint=False)
    radii = 1.0 + np.random.default_rng(0).normal(0.0, 0.02, len(around))
    assert limbs(radii[:, None] * np.stack([np.cos(around), np.sin(around)], axis=1)) == []
