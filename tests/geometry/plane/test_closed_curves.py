# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed polygons by arc length: places, corners and resampling."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.closed_curves import ClosedCurve
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
