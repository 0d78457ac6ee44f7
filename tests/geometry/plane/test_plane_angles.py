# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Angles and rotations in the plane."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.plane_angles import best_turn, rotated, signed_angles

POINTS = np.random.default_rng(5).normal(size=(20, 2))


def test_angles_are_positive_to_the_left():
    east, others = np.array([2.0, 0.0]), np.array([(0.0, 3.0), (1.0, -1.0), (-5.0, 0.0)])
    assert signed_angles(east, others) == pytest.approx([np.pi / 2, -np.pi / 4, np.pi])


@pytest.mark.parametrize("angle", [-2.5, -0.3, 0.0, 1.2])
def test_the_best_turn_is_that_of_rotated_points(angle):
    turned = rotated(POINTS, angle)
    assert best_turn(POINTS, 3.0 * turned) == pytest.approx(angle)
    assert signed_angles(POINTS, turned) == pytest.approx(np.full(20, angle))
