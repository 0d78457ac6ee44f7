# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth extension of fields from some cells of a grid to all others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from .coarser_grid import doubled, halved

# Blur widths in cells of the finest grid and of the coarser ones.
_FINEST_WIDTH, _WIDTH = 0.7, 1.2
# Weight of the means from the next coarser grid relative to those of this one.
_COARSER_SHARE = 1e-2
# Grids with fewer cells along an axis are not halved.
_LEAST_SIDE = 4


def extended(values: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Extend a field to where it is unknown.

    Every cell gets a weighted mean of the known values around it, computed on a pyramid of grids: the finest grid with
    known values nearby dominates.

    Parameters
    ----------
    values : (nx, ny, nz, c) float64
        Valid where the weights are positive; elsewhere any finite numbers.
    weights : (nx, ny, nz) float64
        Nonnegative, not all zero.

    Returns
    -------
    (nx, ny, nz, c) float64
        Slightly blurred where it is known, by 0.7 cells.
    """
    sums = np.concatenate([values * weights[..., None], weights[..., None]], axis=-1)
    return _means(sums, _FINEST_WIDTH)


def _means(sums: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """Weighted means of columns, the last of which is the weight."""
    blurred = gaussian_filter(sums, (width, width, width, 0.0), mode="constant", truncate=3.0)
    if min(sums.shape[:3]) < 2 * _LEAST_SIDE:
        total = sums.sum(axis=(0, 1, 2))
        rest = np.broadcast_to(total[:-1] / total[-1], blurred[..., :-1].shape)
    else:
        rest = doubled(_means(halved(sums), _WIDTH), sums.shape[:3])
    return (blurred[..., :-1] + _COARSER_SHARE * rest) / (blurred[..., -1:] + _COARSER_SHARE)
