# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear systems that change little from one to the next, solved with the factorization of an earlier one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array

from .factorization import Factorization, factorize

# Conjugate gradients stop at this relative error in the energy norm. A factorization takes at least as long as fifteen
# iterations; it is computed after ten without success.
_ERROR, _MOST_ITERATIONS = 1e-5, 10


class KeptFactor:
    """Solves symmetric positive definite systems by conjugate gradients, preconditioned by an earlier factorization.

    If this takes too many iterations, the system is factorized, and the new factorization is kept instead.
    """

    def __init__(self) -> None:
        self._factor: Factorization | None = None

    def solve(self, matrix: csc_array, right: NDArray[np.float64], start: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the solution of every column, (n, k).

        Parameters
        ----------
        matrix : (n, n) csc_array
            Symmetric and positive definite.
        right : (n, k)
            Right-hand sides.
        start : (n, k)
            Initial guess.
        """
        if self._factor is not None:
            found = _conjugate_gradients(matrix, self._factor, right, start)
            if found is not None:
                return found
        self._factor = factorize(matrix)
        return _solved(self._factor, right)


def _solved(factor: Factorization, right: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.ascontiguousarray(factor.solve(np.ascontiguousarray(right.T)).T)


def _conjugate_gradients(
    matrix: csc_array, factor: Factorization, right: NDArray[np.float64], start: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Solve for all columns together; None after too many iterations."""
    # A symmetric matrix has the same rows as columns, and products by rows are faster.
    by_rows = csr_array((matrix.data, matrix.indices, matrix.indptr), shape=matrix.shape)
    found = start.copy()
    residual = right - by_rows @ found
    limits = _ERROR**2 * np.einsum("nk,nk->k", right, _solved(factor, right))
    gradient = _solved(factor, residual)
    decrease = np.einsum("nk,nk->k", residual, gradient)
    direction = gradient
    for _ in range(_MOST_ITERATIONS):
        if (decrease <= limits).all():
            return found
        product = by_rows @ direction
        curvature = np.einsum("nk,nk->k", direction, product)
        step = np.divide(decrease, curvature, out=np.zeros_like(decrease), where=curvature > 0)
        found += step * direction
        residual -= step * product
        gradient = _solved(factor, residual)
        before, decrease = decrease, np.einsum("nk,nk->k", residual, gradient)
        ratio = np.divide(decrease, before, out=np.zeros_like(decrease), where=before > 0)
        direction = gradient + ratio * direction
    return found if (decrease <= limits).all() else None
