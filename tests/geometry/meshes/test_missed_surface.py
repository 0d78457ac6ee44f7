# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.missed_surface import missed_surface
from tests.shapes import ball, box, joined

BALL, CUBE, KNOB = ball(0.5), box((1.0, 1.0, 1.0)), box((0.5, 0.5, 0.5), (0.0, 0.0, 2.0))


def test_a_knob_is_missed_by_its_share_of_the_area():
    assert missed_surface(joined(CUBE, KNOB), CUBE, 0.01).missed == pytest.approx(0.2, abs=2e-3)
    assert missed_surface(CUBE, joined(CUBE, KNOB), 0.01).missed == 0.0


@pytest.mark.parametrize("distance", [0.02, 0.05, 0.09, 0.11])
def test_a_cube_misses_what_is_moved_away_from_it(distance):
    moved = CUBE.moved((0.0, 0.0, 0.1))
    # The top is outside, the bottom inside, also by its distance from the sides, and the sides stand out above.
    known = (1.0 + (1.0 - 2.0 * distance) ** 2 + 4.0 * (0.1 - distance)) / 6.0 if distance < 0.1 else 0.0
    assert missed_surface(moved, CUBE, distance).missed == pytest.approx(known, abs=0.01)


def test_smaller_triangles_would_not_reach_what_is_farther_than_they_are_long():
    """The diagonals of the cube's triangles are as long as to the middle of the knob, those of a fine ball shorter."""
    sides = 4.0 * 0.5 * (2.25 - 0.5 - np.sqrt(2.0))
    assert missed_surface(joined(CUBE, KNOB), CUBE, 0.01).beyond == pytest.approx((0.25 + sides) / 7.5, abs=2e-3)
    fine = missed_surface(joined(BALL, KNOB), BALL, 0.01)
    assert fine.beyond == fine.missed == pytest.approx(1.5 / (1.5 + BALL.area), abs=2e-3)
