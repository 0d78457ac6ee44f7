# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.arrays.label_groups import label_groups, label_order
from convwass_addon.geometry.meshes.edges import sorted_pairs


@pytest.mark.parametrize("labels", [[], [0], [2, 0, 2, 4, 0, 2]])
def test_items_are_grouped_by_label(labels):
    labels = np.array(labels, np.int64)
    found = label_groups(labels, 5)
    assert len(found) == 5
    for label, items in enumerate(found):
        np.testing.assert_array_equal(items, np.flatnonzero(labels == label))


@pytest.mark.parametrize("count", [10, 20_000])
def test_many_items_with_the_same_label_stay_in_order(count):
    labels = np.random.default_rng(0).integers(0, 300, count)
    order = label_order(labels, 300)
    assert order.dtype == np.int64
    np.testing.assert_array_equal(order, np.argsort(labels, kind="stable"))


@pytest.mark.parametrize("count", [0, 10, 20_000])
def test_pairs_are_sorted_by_their_smaller_and_then_by_their_larger_item(count):
    one, other = np.random.default_rng(0).integers(0, 100, (2, count))
    low, high = np.minimum(one, other), np.maximum(one, other)
    keys, order = sorted_pairs(one, other)
    np.testing.assert_array_equal(order, np.lexsort((high, low)))
    assert (np.diff(keys) >= 0).all()
    np.testing.assert_array_equal(np.diff(keys) == 0, (np.diff(low[order]) == 0) & (np.diff(high[order]) == 0))
