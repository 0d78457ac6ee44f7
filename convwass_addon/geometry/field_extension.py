# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields known on some cells of a grid, carried on smoothly to all the others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from .grid_halving import doubled, halved

# Width, in cells of its grid, of the means that are taken at each resolution: fine to coarse.
_FINEST_WIDTH, _WIDTH = 0.7, 1.2
# What the means on the next coarser grid count against those here.
_COARSER_SHARE = 1e-2
# Grids of fewer cells along an axis are not halved.
_LEAST_SIDE = 4


def extended(values: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Carry a field on to where it is not known.

    Every cell gets a weighted mean of what is known around it, taken on a pyramid of grids: the finest one on which
    anything is near counts most.

    Parameters
    ----------
    values : (nx, ny, nz, c) float64
        Known where the weights are positive; any finite numbers elsewhere.
    weights : (nx, ny, nz) float64
        Not negative, not all zero.

    Returns
    -------
    (nx, ny, nz, c) float64
        Slightly blurred where it is known: by 0.7 cells.
    """
    sums = np.concatenate([values * weights[..., None], weights[..., None]], axis=-1)
    return _means(sums, _FINEST_WIDTH)


def _means(sums: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """Weighted means of columns whose last one is the weight."""
    blurred = gaussian_filter(sums, (width, width, width, 0.0), mode="constant", truncate=3.0)
    if min(sums.shape[:3]) < 2 * _LEAST_SIDE:
        total = sums.sum(axis=(0, 1, 2))
        rest = np.broadcast_to(total[:-1] / total[-1], blurred[..., :-1].shape)
    else:
        rest = doubled(_means(halved(sums), _WIDTH), sums.shape[:3])
    return (blurred[..., :-1] + _COARSER_SHARE * rest) / (blurred[..., -1:] + _COARSER_SHARE)
