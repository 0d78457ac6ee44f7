# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Trilinear interpolation of a field on a grid of cubic cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
    for start in range(0, len(points), _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        index, weights = corner_weights(points[part], field.shape[:3])
        found = result[part]
        np.multiply(values[index[0]], weights[0][:, None], out=found)
        for corner, weight in zip(index[1:], weights[1:], strict=True):
            found += values[corner] * weight[:, None]
    return result


def corner_weights(
    points: NDArray[np.float64], shape: tuple[int, ...]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the flat indices of the eight cells around every point, and their weights, (8, n) each.

    Parameters
    ----------
    points : (n, 3) float64
        In cells.
    shape : (int, int, int)
        Cells of the grid along each axis, at least two; the indices are in C order.
    """
    sizes = np.array(shape)
    at = np.clip(points - 0.5, 0.0, sizes - 1.0)
    low = np.minimum(at.astype(np.int64), sizes - 2)
    share = at - low
    strides = np.array([sizes[1] * sizes[2], sizes[2], 1])
    first = low @ strides
    index, weights = np.empty((8, len(points)), np.int64), np.empty((8, len(points)))
    for corner in range(8):
        steps = np.array([corner >> 2, corner >> 1 & 1, corner & 1])
        index[corner] = first + int(steps @ strides)
        x, y, z = (share[:, axis] if step else 1.0 - share[:, axis] for axis, step in enumerate(steps))
        weights[corner] = x * y * z
    return index, weights
