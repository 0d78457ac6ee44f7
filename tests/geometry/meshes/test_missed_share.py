# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import pytest

from convwass_addon.geometry.meshes.missed_share import missed_share
from tests.shapes import box, joined

CUBE, KNOB = box((1.0, 1.0, 1.0)), box((0.5, 0.5, 0.5), (0.0, 0.0, 2.0))


def test_a_knob_is_missed_by_its_share_of_the_area():
    assert missed_share(joined(CUBE, KNOB), CUBE, 0.01) == pytest.approx(0.2, abs=2e-3)
    assert missed_share(CUBE, joined(CUBE, KNOB), 0.01) == 0.0


@pytest.mark.parametrize("distance", [0.02, 0.05, 0.09, 0.11])
def test_a_cube_misses_what_is_moved_away_from_it(distance):
    moved = CUBE.moved((0.0, 0.0, 0.1))
    # The top is outside, the bottom inside, also by its distance from the sides, and the sides stand out above.
    known = (1.0 + (1.0 - 2.0 * distance) ** 2 + 4.0 * (0.1 - distance)) / 6.0 if distance < 0.1 else 0.0
    assert missed_share(moved, CUBE, distance) == pytest.approx(known, abs=0.01)
