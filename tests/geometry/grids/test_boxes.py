# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.grids.boxes import bounding_box, box_around, padded_box

INSIDE = np.zeros((8, 9, 6), bool)
INSIDE[(2, 3, 5), (1, 2, 4), (5, 4, 3)] = True


def test_bounds_are_those_of_the_cells():
    low, high = bounding_box(INSIDE)
    np.testing.assert_array_equal([low, high], [(2, 1, 3), (6, 5, 6)])


def test_margins_end_at_the_grid():
    assert box_around(INSIDE, 2) == (slice(0, 8), slice(0, 7), slice(1, 6))


@pytest.mark.parametrize("margin", [0, 1, 4])
def test_margins_continue_beyond_the_grid_with_a_constant(margin):
    values = np.random.default_rng(0).random(INSIDE.shape)
    box, low = padded_box(values, INSIDE, margin, -1.0)
    np.testing.assert_array_equal(low, np.array((2, 1, 3)) - margin)
    around = np.pad(values, 10, constant_values=-1.0)
    first, last = low + 10, low + 10 + np.array(box.shape)
    np.testing.assert_array_equal(box, around[tuple(map(slice, first, last))])
    np.testing.assert_array_equal(box.shape, np.array((4, 4, 3)) + 2 * margin)
