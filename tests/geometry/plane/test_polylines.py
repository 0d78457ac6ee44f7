# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points along polylines."""

from __future__ import annotations

import numpy as np

from convwass_addon.geometry.plane.polylines import along_polyline, arc_lengths


def test_lengths_along_a_staircase_are_those_of_its_steps() -> None:
    corners = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, -2.0]])
    np.testing.assert_allclose(arc_lengths(corners), [0.0, 3.0, 7.0, 7.0, 9.0])


def test_a_single_point_has_no_length() -> None:
    np.testing.assert_array_equal(arc_lengths(np.ones((1, 3))), [0.0])


def test_points_divide_each_piece_in_proportion_and_stop_at_the_ends() -> None:
    points = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 6.0]])
    found = along_polyline([-1.0, 0.5, 1.0, 3.0, 9.0], [0.0, 1.0, 4.0], points)
    np.testing.assert_allclose(found, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 4.0], [2.0, 6.0]])


def test_a_picture_of_places_becomes_a_picture_of_points() -> None:
    points = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.5]])
    found = along_polyline([[0.0, 0.25], [0.5, 1.0]], [0.0, 1.0], points)
    assert found.shape == (2, 2, 3)
    np.testing.assert_allclose(found[0, 1], [0.25, 0.75, 0.125])
