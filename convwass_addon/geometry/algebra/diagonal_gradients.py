# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Large systems that are nearly diagonal, solved by conjugate gradients with their diagonal as preconditioner."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array

from ...progress import Control
from .conjugate_gradients import conjugate_gradients

# Relative residual at which to stop.
_ERROR = 1e-13


def solved_by_gradients(
    matrix: csc_array | csr_array, right: NDArray[np.float64], most: int, control: Control
) -> NDArray[np.float64] | None:
    """Return the solution of every column, (n, k); None if that takes too many iterations.

    Parameters
    ----------
    matrix : (n, n) sparse
        Symmetric and positive definite.
    right : (n, k) float64
        Right-hand sides.
    most : int
        Largest number of iterations.
    control : Control
        Stops the work.
    """
    inverse = 1.0 / matrix.diagonal()[:, None]
    start = np.zeros_like(right)
    return conjugate_gradients(matrix, lambda residual: inverse * residual, right, start, _ERROR, most, control)
