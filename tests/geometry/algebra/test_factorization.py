# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import os
import sys
from decimal import Decimal, localcontext
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csc_array, csc_matrix, diags_array

from convwass_addon.geometry.algebra.factorization import FACTORIZATIONS, FactorizationError, SuperLU, factorize
from convwass_addon.geometry.meshes.laplacian import cotangent_laplacian
from tests.shapes import ball, torus

LIBRARIES = {"CHOLMOD simplicial (cholespy)": "cholespy", "CHOLMOD supernodal": "sksparse", "SuperLU": "scipy"}
MODULES = {"CHOLMOD simplicial (cholespy)": "cholespy", "CHOLMOD supernodal": "sksparse.cholmod"}


@pytest.fixture(params=LIBRARIES)
def only(request, monkeypatch):
    """Leave only one factorization available."""
    if find_spec(LIBRARIES[request.param]) is None:
        pytest.skip(f"{LIBRARIES[request.param]} is not installed")
    monkeypatch.setattr(
        "convwass_addon.geometry.algebra.factorization.FACTORIZATIONS", {request.param: FACTORIZATIONS[request.param]}
    )
    return request.param


def heat_equation(mesh, time):
    """D_a + t L of a mesh of unit area."""
    found = cotangent_laplacian(mesh)
    return csc_array(diags_array(found.areas / found.areas.sum()) + time * found.matrix)


def exact(matrix, column):
    """A^-1 column by elimination with 60 digits and unlimited range."""
    with localcontext(prec=60):
        rows = [[Decimal(x) for x in row] for row in matrix.toarray()]
        right = [Decimal(x) for x in column]
        count = len(right)
        for pivot in range(count):
            for row in range(pivot + 1, count):
                if rows[row][pivot]:
                    factor = rows[row][pivot] / rows[pivot][pivot]
                    rows[row] = [a - factor * b for a, b in zip(rows[row], rows[pivot], strict=True)]
                    right[row] -= factor * right[pivot]
        for pivot in reversed(range(count)):
            known = sum(rows[pivot][j] * right[j] for j in range(pivot + 1, count))
            right[pivot] = (right[pivot] - known) / rows[pivot][pivot]
    return right


def test_order_of_preference():
    assert list(FACTORIZATIONS) == list(LIBRARIES)


@pytest.mark.parametrize("absent", [0, 1, 2])
def test_the_first_available_one_is_used(monkeypatch, absent):
    for name in list(MODULES)[:absent]:
        monkeypatch.setitem(sys.modules, MODULES[name], None)
    there = [name for name in list(LIBRARIES)[absent:] if find_spec(LIBRARIES[name]) is not None]
    factor = factorize(heat_equation(torus(), 1e-3))
    assert factor.name == there[0]
    assert factor.solve(np.ones((1, 48 * 24))).min() > 0


@pytest.mark.parametrize("missing", MODULES)
def test_missing_libraries_are_named(monkeypatch, missing):
    monkeypatch.setitem(sys.modules, MODULES[missing], None)
    with pytest.raises(ImportError):
        FACTORIZATIONS[missing](csc_matrix(np.eye(3)))


def test_solutions_satisfy_the_equation(only):
    matrix = heat_equation(torus(), 1e-3)
    rows = np.random.default_rng(0).standard_normal((3, 48 * 24))
    kept = rows.copy()
    factor = factorize(matrix)
    assert factor.name == only
    solution = factor.solve(rows)
    assert solution.shape == rows.shape
    assert solution.flags.c_contiguous
    np.testing.assert_array_equal(rows, kept)
    np.testing.assert_allclose((matrix @ solution.T).T, rows, atol=1e-12)


@pytest.mark.parametrize("time", [1e-2, 1e-5, 1e-20, 1e-28])
def test_the_tail_is_accurate_to_many_digits(only, time):
    mesh = ball(points=150)
    matrix = heat_equation(mesh, time)
    source = np.eye(1, 150)
    found = factorize(matrix).solve(source)[0]
    expected = np.array([float(value.ln()) for value in exact(matrix, source[0])])
    assert found.min() > 0
    np.testing.assert_allclose(np.log(found), expected, atol=1e-11)
    if time == 1e-28:
        assert expected.min() < np.log(1e-200)


def test_all_agree_on_many_rows(only):
    matrix = heat_equation(torus(segments=(60, 30)), 1e-9)
    rows = np.eye(16, 60 * 30)
    found, reference = factorize(matrix).solve(rows), SuperLU(csc_matrix(matrix)).solve(rows)
    assert found.min() > 0
    assert np.log(found).min() < np.log(1e-40)
    np.testing.assert_allclose(found, reference, rtol=1e-12)


@pytest.mark.parametrize("count", [1, 2, 64, 130])
def test_many_rows_equal_single_rows(only, count):
    factor = factorize(heat_equation(torus(segments=(12, 8)), 1e-3))
    rows = np.random.default_rng(count).random((count, 96))
    together = factor.solve(rows)
    one_by_one = np.concatenate([factor.solve(row[None]) for row in rows])
    np.testing.assert_allclose(together, one_by_one, rtol=1e-12)
    np.testing.assert_array_equal(factor.solve(np.asfortranarray(rows)), together)


@pytest.mark.parametrize("count", [1, 3])
def test_columns_are_solved_as_rows_are(only, count):
    factor = factorize(heat_equation(torus(segments=(12, 8)), 1e-3))
    columns = np.random.default_rng(count).random((96, count))
    kept = columns.copy()
    solution = factor.solve_columns(columns)
    assert solution.flags.c_contiguous
    np.testing.assert_array_equal(columns, kept)
    np.testing.assert_array_equal(solution, factor.solve(columns.T).T)
    np.testing.assert_array_equal(factor.solve_columns(np.asfortranarray(columns)), solution)


def in_halves(matrix, index_dtype):
    """The same matrix with every entry stored as two summands, in random order."""
    data, indices = np.repeat(matrix.data / 2, 2), np.repeat(matrix.indices, 2)
    for start, stop in np.lib.stride_tricks.sliding_window_view(2 * matrix.indptr, 2):
        shuffled = start + np.random.default_rng(start).permutation(stop - start)
        data[start:stop], indices[start:stop] = data[shuffled], indices[shuffled]
    found = csc_array((data, indices, 2 * matrix.indptr), shape=matrix.shape)
    found.indices, found.indptr = found.indices.astype(index_dtype), found.indptr.astype(index_dtype)
    return found


@pytest.mark.parametrize("index_dtype", [np.int32, np.int64])
def test_any_storage_of_the_matrix_is_accepted(only, index_dtype):
    matrix = heat_equation(torus(segments=(12, 8)), 1e-3)
    right = np.ones((1, 96))
    stored = in_halves(matrix, index_dtype)
    kept = stored.indices.copy()
    np.testing.assert_allclose(factorize(stored).solve(right), factorize(matrix).solve(right), rtol=1e-13)
    np.testing.assert_array_equal(stored.indices, kept)
    assert stored.indices.dtype == index_dtype


@pytest.mark.parametrize(
    "matrix",
    [[(1.0, -2.0), (-2.0, 1.0)], [(-1.0, 0.0), (0.0, -1.0)], [(0.0, 0.0), (0.0, 1.0)], [(1.0, 0.0), (0.0, -1e-9)]],
    ids=["indefinite", "negative", "singular", "one below zero"],
)
def test_matrices_that_are_not_positive_definite_are_refused(only, matrix):
    with pytest.raises(FactorizationError, match="not positive definite"):
        factorize(csc_array(matrix))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_nonfinite_numbers_are_refused(only, value):
    with pytest.raises(FactorizationError, match="not numbers"):
        factorize(csc_array([(value, 0.0), (0.0, 1.0)]))


def test_only_square_matrices_are_factorized():
    with pytest.raises(ValueError, match="2 x 3"):
        factorize(csc_array(np.eye(2, 3)))


def test_superlu_reports_its_size():
    # A diagonal matrix has no fill-in: L and U have one number per row each.
    assert SuperLU(csc_matrix(np.eye(10))).factor_bytes == 160


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="Memory is read as Linux shows it")
def test_memory_is_freed(only):
    def used():
        """Memory of this process in bytes."""
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    size = 20_000
    matrix = csc_array(
        diags_array([np.full(size - 1, -1.0), np.full(size, 3.0), np.full(size - 1, -1.0)], offsets=(-1, 0, 1))
    )
    columns = np.ones((8, size))
    before = []
    for _ in range(40):
        factorize(matrix).solve(columns)
        before.append(used())
    # What the solutions take is 1.3 MB.
    assert before[-1] - before[9] < 8 * columns.nbytes
