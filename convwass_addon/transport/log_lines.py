# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaussian blurs of logarithms along lines, at any distance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import blas

from .log_range import LOG_NOTHING, NEGLIGIBLE, floored_log

# Cells of a block, in standard deviations: across one the kernel falls by e^(-14^2 / 2) = e^-98, and
# across two by e^-392: float64 holds e^-708 (times are in docs/performance.md, "Barycenters on grids").
_BLOCK = 14.0
_LEAST_BLOCK = 8
# What is smaller than a sum by more than this does not change it: e^-45 is 3e-20, and sums of float64 are exact to
# 1e-16.
_DEPTH = 45.0
_LESS_THAN_NOTHING = -1e30


def log_blur(logs: NDArray[np.float64], sigma: float, log_scale: float) -> NDArray[np.float64]:
    """Blur the exponentials of lines by a Gaussian and return the logarithms.

    Lines are cut into blocks. Between a block of sources and one of targets whose centers lie D apart, with offsets u
    and v from the centers,

        -(D + v - u)^2 / 2 sigma^2 = -D^2 / 2 sigma^2 + D u / sigma^2 - D v / sigma^2 - (v - u)^2 / 2 sigma^2

    of which the second term belongs to the sources and the third to the targets, so that one small matrix serves all
    pairs of blocks and no distance is too far for it. Pairs that cannot matter are left out, line by line.

    Parameters
    ----------
    logs : (m, n) float64
        Lines; LOG_NOTHING where there is nothing.
    sigma : float
        Standard deviation in cells.
    log_scale : float
        Logarithm of what the Gaussian is multiplied by.

    Returns
    -------
    (m, n) float64
        LOG_NOTHING where nothing arrives.
    """
    count, size = logs.shape
    block = max(int(_BLOCK * sigma), _LEAST_BLOCK)
    blocks = -(-size // block)
    # Against the slopes between far blocks even what stands for nothing would count.
    padded = np.full((count, blocks * block), _LESS_THAN_NOTHING)
    np.copyto(padded[:, :size], logs, where=logs > LOG_NOTHING)
    padded = padded.reshape(count, blocks, block)
    offsets = np.arange(block) - (block - 1) / 2
    kernel = np.exp(-((offsets[:, None] - offsets) ** 2) / (2.0 * sigma**2))
    kernel[kernel < NEGLIGIBLE] = 0.0
    result = np.full((count, blocks, block), LOG_NOTHING)
    for target in range(blocks):
        for source, rows in _that_matter(padded, target, offsets, sigma):
            shift = (target - source) * block / sigma**2
            tilted = padded[rows, source] + shift * offsets
            top = tilted.max(axis=1, keepdims=True)
            scaled = np.exp(tilted - top)
            scaled[scaled < NEGLIGIBLE] = 0.0
            arrived = np.ascontiguousarray(blas.dgemm(1.0, kernel, scaled.T).T)
            floored_log(arrived, top - shift * offsets - (shift * sigma) ** 2 / 2.0 + log_scale)
            result[rows, target] = np.logaddexp(result[rows, target], arrived)
    blurred = result.reshape(count, -1)[:, :size]
    # Nothing and nothing, from several blocks, is still nothing.
    return np.where(blurred > LOG_NOTHING + 1.0, blurred, LOG_NOTHING)


def _that_matter(
    padded: NDArray[np.float64], target: int, offsets: NDArray[np.float64], sigma: float
) -> list[tuple[int, NDArray[np.int64]]]:
    """Blocks of sources that may matter to a block of targets, and the lines in which they may.

    Judged by the largest term at the middle of the targets: towards their ends a block may gain on another by the
    difference of their slopes, at most that of their distances over sigma^2 and half a block long.
    """
    blocks, block = padded.shape[1:]
    distances = (np.arange(blocks)[:, None] - target) * block + offsets
    middle = (padded - distances**2 / (2.0 * sigma**2)).max(axis=2)
    best = middle.argmax(axis=1)
    away = (np.abs(np.arange(blocks) - best[:, None]) + 1) * block
    allowed = away * (block / 2) / sigma**2 + _DEPTH
    matters = middle > middle.max(axis=1, keepdims=True) - allowed
    matters &= (padded > LOG_NOTHING).any(axis=2)
    return [(source, np.flatnonzero(own)) for source, own in enumerate(matters.T) if own.any()]
