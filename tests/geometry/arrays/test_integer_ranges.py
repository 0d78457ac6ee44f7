# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranges of integers of different lengths."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.arrays.integer_ranges import integer_ranges


@pytest.mark.parametrize("lengths", [[2, 0, 3, 1], [0, 0, 0, 0]])
@pytest.mark.parametrize("begin", [0, 5, np.array([7, -2, 4, 0])])
def test_ranges_follow_each_other(begin, lengths):
    firsts = np.broadcast_to(begin, len(lengths)).tolist()
    ranges = [range(first, first + length) for first, length in zip(firsts, lengths, strict=True)]
    owner, numbers = integer_ranges(begin, np.array(lengths))
    assert owner.tolist() == [place for place, own in enumerate(ranges) for _ in own]
    assert numbers.tolist() == [number for own in ranges for number in own]


def test_no_ranges_have_no_integers():
    owner, numbers = integer_ranges(0, np.empty(0, np.int64))
    assert owner.size == numbers.size == 0
