# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments of plane shapes compared with closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from convwass_addon.geometry.plane.flat_moments import FlatMoments, directed
from convwass_addon.geometry.plane.outlines import ring_area


def moments(ring):
    return FlatMoments.of(ring, np.roll(ring, -1, axis=0))


def rectangle(width, height, x=0.0, y=0.0):
    corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return corners * (width / 2, height / 2) + (x, y)


@given(width=st.floats(2, 9), height=st.floats(0.1, 1), x=st.floats(-50, 50), angle=st.floats(-1.5, 1.5))
def test_a_rectangle(width, height, x, angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    found = moments(rectangle(width, height) @ turn.T + (x, 1.0))
    assert found.area == pytest.approx(width * height)
    np.testing.assert_allclose(found.center, (x, 1.0), atol=1e-9)
    assert abs(np.sin(found.axis - angle)) < 1e-6


def test_the_long_axis_points_to_the_heavy_end():
    # Both sides of a wedge with its heavy end on the left.
    wedge = np.array([(0.0, -1.0), (6.0, 0.0), (0.0, 1.0)])
    assert np.cos(moments(wedge).axis) == pytest.approx(-1.0)
    assert np.cos(moments(-wedge).axis) == pytest.approx(1.0)


def test_round_shapes_have_no_axis():
    assert moments(rectangle(2.0, 2.0)).axis is None
    assert moments(rectangle(2.0, 2.0)).angle_from(moments(rectangle(3.0, 1.0))) == 0.0


def test_empty_shapes_have_no_area():
    assert FlatMoments.of(np.zeros((0, 2)), np.zeros((0, 2))).area == 0.0


def test_rings_are_oriented_by_their_nesting():
    rings = [rectangle(8, 8)[::-1], rectangle(4, 4), rectangle(2, 2), rectangle(4, 4)]
    found = directed(rings, [0, 0, 0, 1])
    np.testing.assert_allclose([ring_area(ring) for ring in found], [64, -16, 4, 16])
