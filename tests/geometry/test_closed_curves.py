# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed polygons by arc length: places, corners, and the curves of a boundary."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.closed_curves import ClosedCurve, boundary_curves, boundary_of
from convwass_addon.geometry.outlines import ring_area
from convwass_addon.geometry.planar_fill import filled_boundary
from tests.flat_shapes import ellipse, rectangle

OBLONG = ClosedCurve(rectangle((0.0, 0.0), (3.0, 1.0)))


def test_places_are_arc_lengths_modulo_the_length():
    assert OBLONG.length == 8.0
    found = OBLONG.at(np.array([0.0, 1.5, 3.25, 7.5, 8.0, 9.5, -0.5]))
    assert found == pytest.approx(np.array([(0, 0), (1.5, 0), (3, 0.25), (0, 0.5), (0, 0), (1.5, 0), (0, 0.5)]))


def test_corners_are_sharp_and_arcs_are_not():
    assert OBLONG.sharp_places(np.radians(20.0)).tolist() == [0.0, 3.0, 4.0, 7.0]
    assert not len(ClosedCurve(ellipse()).sharp_places(np.radians(20.0)))


def test_nearest_places_lie_at_the_feet_of_perpendiculars():
    places, distances = OBLONG.nearest(np.array([(1.0, 0.2), (5.0, 0.5), (-1.0, -1.0), (2.0, 1.0)]))
    assert places == pytest.approx([1.0, 3.5, 0.0, 5.0])
    assert distances == pytest.approx([0.2, 2.0, np.sqrt(2.0), 0.0])


def test_differences_are_at_most_half_of_the_curve():
    found = OBLONG.differences(np.array([7.5, 1.0]), np.array([0.5, 4.0]))
    assert found == pytest.approx(np.array([[1.0, -3.5], [-0.5, 3.0]]))


def test_places_are_spread_evenly_between_knots():
    assert OBLONG.spread(1.0, 9.0, OBLONG.starts[:-1], 1.0) == pytest.approx(np.arange(1.0, 10.0))
    assert OBLONG.spread(2.0, 5.0, np.array([3.5, 3.5, 7.0]), 1.0) == pytest.approx([2.0, 2.75, 3.5, 4.25, 5.0])


def test_resampled_curves_keep_knots_and_have_short_edges():
    circle = ClosedCurve(ellipse())
    knots = np.array([0.3, 2.0])
    coarse = circle.resampled(knots, 0.1)
    assert np.diff(coarse.starts).max() < 0.12
    assert circle.nearest(coarse.points)[1].max() < 1e-9
    assert coarse.nearest(circle.at(knots))[1].max() < 1e-9
    finer = circle.with_places(knots)
    assert len(finer.points) == len(circle.points) + 2
    assert finer.length == pytest.approx(circle.length)


def test_a_boundary_consists_of_closed_curves():
    rings = [rectangle((0, 0), (4, 4)), rectangle((1, 1), (2, 2))[::-1], rectangle((6, 0), (7, 1))]
    curves = boundary_curves(filled_boundary(rings, "non-zero"))
    assert sorted(ring_area(curve.points) for curve in curves) == pytest.approx([-1.0, 1.0, 16.0])
    assert boundary_of(curves).area == pytest.approx(16.0)


@pytest.mark.parametrize("angle", np.radians([0.0, 90.0, 180.0, 270.0]))
def test_regions_that_touch_at_a_corner_have_their_own_curves(angle):
    """Also if a curve begins there."""
    c, s = np.cos(angle), np.sin(angle)
    rings = (
        np.array(ring) @ np.array([[c, s], [-s, c]]) for ring in ([(0, 0), (2, -2), (2, -1)], [(0, 0), (2, 1), (3, 3)])
    )
    curves = boundary_curves(filled_boundary(list(rings), "non-zero"))
    assert sorted(ring_area(curve.points) for curve in curves) == pytest.approx([1.0, 1.5])
