# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Resampling of images to other grids."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array


def means_in_cells(
    values: NDArray[np.float64], corner: ArrayLike, pixel: float, shape: tuple[int, int]
) -> NDArray[np.float64]:
    """Means of an image over the cells of a grid, by the exact overlap areas of pixels and cells.

    Parameters
    ----------
    values : (w, h) float64
        Values of the pixels; zero outside the image.
    corner : (2,)
        Lower corner of the image, in cells.
    pixel : float
        Size of a pixel in cells.
    shape : (int, int)
        Cells per axis.

    Returns
    -------
    (nx, ny) float64
        Its sum is that of the image's values times the area of a pixel, within the grid.
    """
    low = np.asarray(corner, dtype=np.float64)
    first, second = (_overlaps(n, float(a), pixel, m) for n, a, m in zip(values.shape, low, shape, strict=True))
    return (second @ (first @ values).T).T


def _overlaps(count: int, low: float, pixel: float, cells: int) -> csr_array:
    """Overlap lengths between cells, (cells), and pixels, (count)."""
    edges = low + pixel * np.arange(count + 1)
    cuts = np.unique(np.clip(np.concatenate([edges, np.arange(cells + 1)]), 0.0, float(cells)))
    middle, length = 0.5 * (cuts[1:] + cuts[:-1]), np.diff(cuts)
    own = np.floor((middle - low) / pixel).astype(np.int64)
    inside = (own >= 0) & (own < count) & (length > 0)
    cell = np.minimum(np.floor(middle).astype(np.int64), cells - 1)
    return csr_array((length[inside], (cell[inside], own[inside])), shape=(cells, count))
