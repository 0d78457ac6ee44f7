# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Preconditioned conjugate gradients for several right-hand sides together."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array

from ...progress import UNINTERRUPTED, Control
from .quotients import quotients


def conjugate_gradients(
    matrix: csc_array | csr_array,
    preconditioned: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    right: NDArray[np.float64],
    start: NDArray[np.float64],
    error: float,
    most: int,
    control: Control = UNINTERRUPTED,
) -> NDArray[np.float64] | None:
    """Return the solution of every column, (n, k); None if that takes too many iterations.

    M. Hestenes and E. Stiefel, "Methods of conjugate gradients for solving linear systems", 1952.

    Parameters
    ----------
    matrix : (n, n) sparse
        Symmetric and positive definite.
    preconditioned : callable
        Applies an approximate inverse to columns, (n, k).
    right, start : (n, k) float64
        Right-hand sides, and initial guess.
    error : float
        Residual at which to stop, relative to the right-hand side, in the norm of the approximate inverse.
    most : int
        Largest number of iterations.
    control : Control
        Stops the work.
    """
    # A symmetric matrix has the same rows as columns, and products by rows are faster.
    by_rows = csr_array((matrix.data, matrix.indices, matrix.indptr), shape=matrix.shape)
    found = start.copy()
    residual = right - by_rows @ found
    limits = error**2 * _dots(right, preconditioned(right))
    direction = preconditioned(residual)
    decrease = _dots(residual, direction)
    for _ in range(most):
        if (decrease <= limits).all():
            return found
        control.check()
        product = by_rows @ direction
        curvature = _dots(direction, product)
        step = quotients(decrease, curvature)
        found += step * direction
        residual -= step * product
        gradient = preconditioned(residual)
        before, decrease = decrease, _dots(residual, gradient)
        direction *= quotients(decrease, before)
        direction += gradient
    return found if (decrease <= limits).all() else None


def _dots(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the scalar product of every column, (k,)."""
    return np.einsum("nk,nk->k", one, other)
