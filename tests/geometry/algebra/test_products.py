# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from importlib.util import module_from_spec, spec_from_file_location

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.linalg import cython_blas

from convwass_addon.geometry.algebra import products


@pytest.fixture(scope="module", params=["as SciPy is", "another SciPy"])
def own(request):
    """The module with the installed SciPy, and with one that declares no C functions."""
    if request.param == "as SciPy is":
        return products
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cython_blas, "__pyx_capi__", {})
        spec = spec_from_file_location("products_of_another_scipy", products.__file__)
        made = module_from_spec(spec)
        spec.loader.exec_module(made)
    assert not made.LETS_OTHERS_WORK
    return made


@settings(max_examples=50, deadline=None)
@given(lines=st.integers(1, 40), size=st.integers(1, 30), new_size=st.integers(1, 30), seed=st.integers(0, 99))
def test_contracts_the_last_axis_and_puts_it_first(own, lines, size, new_size, seed):
    rng = np.random.default_rng(seed)
    source, kernel = rng.normal(size=lines * size), np.asfortranarray(rng.normal(size=(size, new_size)))
    target = np.full(new_size * lines + 3, np.nan)
    kept = source.copy(), kernel.copy()
    own.contract(source, target[:-3], kernel)
    expected = (source.reshape(lines, size) @ kernel).T
    np.testing.assert_allclose(target[:-3].reshape(new_size, lines), expected, atol=1e-12)
    assert np.isnan(target[-3:]).all()
    np.testing.assert_array_equal(source, kept[0])
    np.testing.assert_array_equal(kernel, kept[1])


@pytest.mark.parametrize("band", [0, 20, 70])
def test_blocks_of_a_banded_matrix_are_contracted(own, band):
    """Some of the last columns are empty."""
    rng = np.random.default_rng(band)
    rows, columns = np.indices((230, 310))
    kernel = np.asfortranarray(np.where(np.abs(rows - columns) <= band, rng.normal(size=rows.shape), 0.0))
    source, target = rng.normal(size=7 * 230), np.full(310 * 7, np.nan)
    own.contract(source, target, kernel)
    np.testing.assert_allclose(target.reshape(310, 7), (source.reshape(7, 230) @ kernel).T, atol=1e-12)


@settings(max_examples=50, deadline=None)
@given(count=st.integers(1, 40), size=st.integers(1, 30), new_size=st.integers(1, 30), seed=st.integers(0, 99))
def test_multiplies_in_single_precision(own, count, size, new_size, seed):
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(count, size)).astype(np.float32)
    matrix = rng.normal(size=(size, new_size)).astype(np.float32)
    out = np.full((count + 1, new_size), np.nan, np.float32)
    own.multiply(rows, matrix, out[:-1])
    np.testing.assert_allclose(out[:-1], rows @ matrix, atol=1e-5)
    assert np.isnan(out[-1]).all()


def test_arrays_that_c_would_misread_are_refused():
    rows, matrix, out = (np.ones(shape, np.float32) for shape in ((3, 4), (4, 5), (3, 5)))
    for wrong in [
        (rows, np.asfortranarray(matrix), out),
        (rows, matrix, np.ones((5, 3), np.float32).T),
        (rows.astype(float), matrix, out),
        (np.ones((3, 8), np.float32)[:, ::2], matrix, out),
        (rows, matrix, out[:2]),
        (rows[:, :3], matrix, out),
    ]:
        with pytest.raises(ValueError, match=r"give|float32"):
            products.multiply(*wrong)


def test_the_c_functions_are_found():
    """With every SciPy version of the project; without them, threads block each other in products."""
    assert products.LETS_OTHERS_WORK
