# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Trilinear interpolation of a field on a grid of cubic cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..arrays.chunks import chunks

# Points processed together: their arrays fit into the cache.
_AT_ONCE = 1 << 14


def sampled(field: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Interpolate a field linearly along each axis.

    Parameters
    ----------
    field : (nx, ny, nz, c) float64
        Values at the centers of the cells, at least two along each axis; C-contiguous.
    points : (n, 3) float64
        In cells: the center of the first cell is at (0.5, 0.5, 0.5). Values are constant beyond the outer centers.

    Returns
    -------
    (n, c) float64
    """
    values = field.reshape(-1, field.shape[-1])
    result = np.empty((len(points), values.shape[1]))
    for part in chunks(len(points), _AT_ONCE):
        # A sparse product gathers and sums three times as fast as arrays of indices.
        result[part] = _interpolation(points[part], field.shape[:3]) @ values
    return result


def _interpolation(points: NDArray[np.float64], shape: tuple[int, ...]) -> csr_array:
    """Return the matrix, (n, cells), that takes values at the centers to the points."""
    sizes = np.array(shape)[:, None]
    at = np.clip(points.T - 0.5, 0.0, sizes - 1.0)
    low = np.minimum(at.astype(np.int32), (sizes - 2).astype(np.int32))
    above = at - low
    below = 1.0 - above
    strides = (shape[1] * shape[2], shape[2], 1)
    index, weights = np.empty((len(points), 8), np.int32), np.empty((len(points), 8))
    steps = [strides[0] * (corner >> 2) + strides[1] * (corner >> 1 & 1) + (corner & 1) for corner in range(8)]
    first = low[0] * strides[0] + low[1] * strides[1] + low[2]
    np.add(first[:, None], np.array(steps, np.int32), out=index)
    for corner in range(0, 8, 2):
        share = (above if corner >> 2 else below)[0] * (above if corner >> 1 & 1 else below)[1]
        np.multiply(share, below[2], out=weights[:, corner])
        np.multiply(share, above[2], out=weights[:, corner + 1])
    starts = np.arange(0, 8 * len(points) + 1, 8, dtype=np.int32)
    return csr_array((weights.ravel(), index.ravel(), starts), shape=(len(points), int(np.prod(shape))))
