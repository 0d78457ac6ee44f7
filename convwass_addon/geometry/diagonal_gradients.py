# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Large systems that are nearly diagonal, solved by conjugate gradients with their diagonal as preconditioner."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..progress import Control

# Conjugate gradients stop at this residual relative to the right-hand side, in the norm of the inverse diagonal.
_ERROR = 1e-13


def solved_by_gradients(
    matrix: csr_array, right: NDArray[np.float64], most: int, control: Control
) -> NDArray[np.float64] | None:
    """Return the solution of every column, (n, k); None if that takes too many iterations.

    M. Hestenes and E. Stiefel, "Methods of conjugate gradients for solving linear systems", 1952.

    Parameters
    ----------
    matrix : (n, n) csr_array
        Symmetric and positive definite.
    right : (n, k) float64
        Right-hand sides.
    most : int
        Largest number of iterations.
    control : Control
        Stops the work.
    """
    inverse = 1.0 / matrix.diagonal()[:, None]
    found, residual = np.zeros_like(right), right.copy()
    gradient = inverse * residual
    decrease = _dots(residual, gradient)
    limits, direction = _ERROR**2 * decrease, gradient.copy()
    for _ in range(most):
        if (decrease <= limits).all():
            return found
        control.check()
        product = matrix @ direction
        curvature = _dots(direction, product)
        step = np.divide(decrease, curvature, out=np.zeros_like(decrease), where=curvature > 0)
        found += step * direction
        residual -= step * product
        np.multiply(inverse, residual, out=gradient)
        before, decrease = decrease, _dots(residual, gradient)
        direction *= np.divide(decrease, before, out=np.zeros_like(decrease), where=before > 0)
        direction += gradient
    return found if (decrease <= limits).all() else None


def _dots(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the scalar product of every column, (k,)."""
    return np.einsum("nk,nk->k", one, other)
