# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions, compared with whole arrays."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import binary_erosion

from convwass_addon.transport.region import Region


def region(shape, share=0.9, seed=4):
    return Region(np.random.default_rng(seed).random(shape) < share)


@pytest.mark.parametrize("shape", [(40,), (14, 17), (9, 8, 11)])
def test_the_interior_has_all_its_neighbors_in_the_region(shape):
    """What is beyond the border of the grid is no neighbor."""
    own = region(shape)
    expected = binary_erosion(own.inside, np.ones((3,) * len(shape)), border_value=1)
    assert 0 < expected.sum() < len(own)
    np.testing.assert_array_equal(own.interior, expected)
    assert Region.whole(shape).interior.all()


def test_values_are_transferred_to_where_both_regions_are():
    one, other = region((14, 17)), region((14, 17), 0.5, seed=6)
    values = np.random.default_rng(2).random((3, len(one)))
    found = one.transferred(values, other, -7.0)
    np.testing.assert_array_equal(found, other.gather(one.scatter(values, -7.0)))
