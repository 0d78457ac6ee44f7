# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.ndimage import distance_transform_edt

from convwass_addon.geometry.grids.near import capped_distances, capped_squares


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**31 - 1), st.floats(0.5, 20.0), st.floats(1e-4, 0.05))
def test_distances_up_to_the_reach_agree_with_the_distance_transform(seed, reach, share):
    inside = np.random.default_rng(seed).random((17, 6, 23)) < share
    inside[3, 2, 5] = True
    exact = np.rint(distance_transform_edt(~inside) ** 2)
    found = capped_squares(inside, reach)
    near = exact <= reach**2
    np.testing.assert_array_equal(found[near], exact[near])
    assert (found[~near] > reach**2).all()


@pytest.mark.parametrize("reach", [3.0, 4.5])
def test_distances_from_the_surface_of_a_block(reach):
    inside = np.zeros((20, 5, 5), bool)
    inside[:6] = True
    found = capped_distances(inside, reach)[:, 2, 2]
    exact = np.maximum(np.arange(20) - 5.5, 0.0)
    near = exact <= reach - 0.5
    np.testing.assert_allclose(found[near], exact[near], atol=1e-6)
    assert (found[~near] > reach - 0.5).all() and (found <= reach).all()
