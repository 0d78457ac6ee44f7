# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear systems that change little from one to the next, solved with the factorization of an earlier one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from .conjugate_gradients import conjugate_gradients
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
            found = conjugate_gradients(matrix, self._factor.solve_columns, right, start, _ERROR, _MOST_ITERATIONS)
            if found is not None:
                return found
        self._factor = factorize(matrix)
        return self._factor.solve_columns(right)
