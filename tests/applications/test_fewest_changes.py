# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from itertools import pairwise, product

from hypothesis import given, strategies as st

from convwass_addon.applications.morphs.fewest_changes import fewest_changes


def changes(counts):
    return sum(abs(after - before) for before, after in pairwise(counts))


def test_a_count_that_flickers_changes_once():
    assert fewest_changes([0] * 6, [2, 1, 2, 0, 1, 0], 2, 0) == [2, 1, 1, 0, 0, 0]
    assert fewest_changes([0] * 5, [0, 1, 0, 1, 1], 1, 1) == [0, 0, 0, 1, 1]
    assert fewest_changes([], [], 1, 3) == []


def test_lower_bounds_are_respected():
    assert fewest_changes([0, 0, 2, 0], [1, 1, 2, 1], 0, 0) == [1, 1, 2, 1]
    assert fewest_changes([0, 0, 0, 0], [1, 1, 2, 1], 0, 0) == [0, 0, 0, 0]


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), max_size=4), st.integers(0, 3), st.integers(0, 3))
def test_no_sequence_changes_less_and_of_those_none_is_larger(bounds, first, last):
    least, most = [min(pair) for pair in bounds], [max(pair) for pair in bounds]
    found = fewest_changes(least, most, first, last)
    all_of_them = product(*(range(low, high + 1) for low, high in zip(least, most, strict=True)))
    best = min((changes([first, *one, last]), -sum(one)) for one in all_of_them)
    assert (changes([first, *found, last]), -sum(found)) == best
    assert all(low <= count <= high for low, count, high in zip(least, found, most, strict=True))
