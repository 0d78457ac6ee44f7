# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from convwass_addon.geometry.arrays.chunks import chunks, chunks_by_sizes


@pytest.mark.parametrize(("count", "expected"), [(0, []), (3, [3]), (4, [4]), (9, [4, 4, 1])])
def test_chunks_of_equal_size(count, expected):
    items = np.arange(count)
    found = [items[some] for some in chunks(count, 4)]
    assert [len(own) for own in found] == expected
    np.testing.assert_array_equal(np.concatenate([items[:0], *found]), items)


@given(st.lists(st.integers(0, 20), max_size=30), st.integers(1, 30))
def test_chunks_are_as_long_as_their_sum_allows(sizes, most):
    sizes = np.array(sizes, np.int64)
    found = list(chunks_by_sizes(sizes, most))
    assert [some.start for some in found] == [0, *(some.stop for some in found)][: len(found)]
    assert not len(sizes) or found[-1].stop == len(sizes)
    for some in found:
        assert sizes[some].sum() <= most or some.stop - some.start == 1
        if some.stop < len(sizes):
            assert sizes[some.start : some.stop + 1].sum() > most
