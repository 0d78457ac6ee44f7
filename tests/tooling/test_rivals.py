# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The measures for comparing alternatives have the documented meaning."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.rival_measures import Passage, detour
from benchmarks.side_by_side import passage as measured_passage
from convwass_addon.applications.morphs.volumes import Lattice
from tests.shapes import ball, joined


def passage(middle):
    ends = (ball(0.3, (-1.0, 0.0, 0.0)), ball(0.3, (1.0, 0.0, 0.0)))
    lattice = Lattice.around([joined(*ends)], 64, 1.0)
    lattice = Lattice(lattice.shape, lattice.spacing, lattice.origin, np.zeros((1, 3)))
    return Passage.of((ends[0], middle, ends[1]), ends, (0.0, 0.5, 1.0), lattice)


def test_moving_material_is_outside_and_goes_straight():
    found = passage(ball(0.3))
    assert found.outside == 1.0
    assert found.detour == pytest.approx(1.0, abs=0.01)
    np.testing.assert_allclose(found.volumes, 1.0, atol=0.01)
    assert (found.pieces, found.handles, found.smallest, found.arrival) == (1, 0, 1.0, 1.0)


def test_fading_material_stays_and_makes_a_detour():
    # Half of the mass is at each end; the half on the near side has already arrived.
    size = 0.3 * 0.5 ** (1.0 / 3.0)
    found = passage(joined(ball(size, (-1.0, 0.0, 0.0)), ball(size, (1.0, 0.0, 0.0))))
    assert found.outside == 0.0
    # The center of half a ball is three eighths of the radius away from the ball's center.
    near, far = 3.0 / 8.0 * 0.3, 2.0 - 3.0 / 8.0 * 0.3
    assert found.detour == pytest.approx(np.sqrt(0.5 * (near**2 + far**2)), abs=0.01)
    assert found.pieces == 2
    assert found.smallest == pytest.approx(0.5, abs=0.01)


def test_a_path_through_an_end_is_no_detour():
    filled = np.zeros((2, 24, 24, 24))
    filled[0, 4:8, 8:16, 8:16] = filled[1, 14:18, 8:16, 8:16] = 1.0
    assert detour(filled[0], filled) == pytest.approx(1.0, abs=1e-3)


def test_a_fade_of_letters_arrives_with_the_interpolated_volumes():
    """The whole benchmark of one method, in a process of its own."""
    found = measured_passage(("letter_a", "letter_b"), 24, "fade")
    assert len(found["volumes"]) == 5
    assert found["volumes"] == pytest.approx([1.0] * 5, abs=0.03)
    assert found["arrival"] > 0.7
    assert found["detour"] > 1.1
