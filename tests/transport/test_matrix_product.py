# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.transport import matrix_product


@pytest.mark.parametrize("contract", [matrix_product.contract, matrix_product._by_wrapper])
@settings(max_examples=50, deadline=None)
@given(lines=st.integers(1, 40), size=st.integers(1, 30), new_size=st.integers(1, 30), seed=st.integers(0, 99))
def test_contracts_the_last_axis_and_puts_it_first(contract, lines, size, new_size, seed):
    rng = np.random.default_rng(seed)
    source, kernel = rng.normal(size=lines * size), np.asfortranarray(rng.normal(size=(size, new_size)))
    target = np.full(new_size * lines + 3, np.nan)
    kept = source.copy(), kernel.copy()
    contract(source, target[:-3], kernel)
    expected = (source.reshape(lines, size) @ kernel).T
    np.testing.assert_allclose(target[:-3].reshape(new_size, lines), expected, atol=1e-12)
    assert np.isnan(target[-3:]).all()
    np.testing.assert_array_equal(source, kept[0])
    np.testing.assert_array_equal(kernel, kept[1])


def test_the_function_of_c_is_found():
    """With every SciPy of the project; without it threads wait for each other's products."""
    assert matrix_product._dgemm is not None
