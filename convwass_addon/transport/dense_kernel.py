# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The heat kernel of a small surface as a matrix, for solvers that apply it to thousands of columns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.algebra.products import multiply
from .surface import Surface

# Kernel entries below this fraction of the largest are set to zero: they would underflow to subnormal float32 numbers,
# which are many times slower. In the factors of the kernel, much smaller entries must be kept.
_NEGLIGIBLE, _NEGLIGIBLE_ON_THE_WAY = np.float32(1e-12), np.float32(1e-18)


def dense_kernel(domain: Surface) -> NDArray[np.float32]:
    """Return the heat kernel of a surface, with the area weights in its rows.

    Parameters
    ----------
    domain : Surface
        A surface of at most a few thousand vertices.

    Returns
    -------
    (k, k) float32
        a(x) H(x, y) between the k vertices that triangles use: ``rows @ kernel`` is ``domain.apply(rows)``. Negligible
        entries are exactly zero.
    """
    used = domain.weights > 0
    places = np.flatnonzero(used)
    columns = np.zeros((len(places), len(used)))
    columns[np.arange(len(places)), places] = 1.0
    # All steps are powers of the first; a few large matrix products are faster than many solves.
    step = domain.with_kernel(domain.gamma / domain.steps, 1).apply(columns)[:, places].astype(np.float32, order="C")
    kernel = _power(step, domain.steps)
    heat = kernel / domain.weights[places, None].astype(np.float32)
    kernel[heat < _NEGLIGIBLE * heat.max()] = 0.0
    return kernel


def _power(matrix: NDArray[np.float32], exponent: int) -> NDArray[np.float32]:
    matrix[matrix < _NEGLIGIBLE_ON_THE_WAY] = 0.0
    if exponent == 1:
        return matrix
    half = _power(matrix, exponent // 2)
    square = np.empty_like(matrix)
    multiply(half, half, square)
    if exponent % 2 == 0:
        return square
    square[square < _NEGLIGIBLE_ON_THE_WAY] = 0.0
    result = np.empty_like(matrix)
    multiply(square, matrix, result)
    return result
