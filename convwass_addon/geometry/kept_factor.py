# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear systems that change little from one to the next, solved with the factors of an earlier one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array

from .factorization import Factorization, factorize

# Conjugate gradients end at this error, relative to the solution in the norm of the energy. Factorizing takes as long
# as fifteen iterations or more; after so many it is done.
_ERROR, _MOST_ITERATIONS = 1e-5, 10


class KeptFactor:
    """Solves symmetric positive definite systems by conjugate gradients, preconditioned by the factors of one of them.

    Where that takes too many iterations, the system is factorized, and the new factors are kept instead.
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
            Right sides.
        start : (n, k)
            Near the solution.
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
    """Solve for all columns at once; None where it takes too long."""
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
