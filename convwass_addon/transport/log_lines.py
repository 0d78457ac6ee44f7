# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaussian blur of logarithms along lines, at any distance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import blas

from .log_range import LOG_NOTHING, NEGLIGIBLE, floored_log, flushed_exp

# Width of a block in standard deviations: across one block the kernel falls by e^(-14^2 / 2) = e^-98, across two by
# e^-392, and float64 holds e^-708 (timings are in docs/performance, "Barycenters on grids").
_BLOCK = 14.0
_LEAST_BLOCK = 8
# A term further below the sum than this does not change it: e^-45 is 3e-20, and float64 sums are accurate to 1e-16.
_DEPTH = 45.0
_PADDING = -1e30


def log_blur(logs: NDArray[np.float64], sigma: float, log_scale: float) -> NDArray[np.float64]:
    """Blur the exponentials of lines by a Gaussian and return the logarithms.

    Lines are cut into blocks. Between a block of sources and one of targets whose centers lie D apart, with offsets u
    and v from the centers,

        -(D + v - u)^2 / 2 sigma^2 = -D^2 / 2 sigma^2 + D u / sigma^2 - D v / sigma^2 - (v - u)^2 / 2 sigma^2

    The second term depends only on the source and the third only on the target, so one small matrix serves all pairs
    of blocks at any distance. Pairs that cannot contribute are skipped, line by line.

    Parameters
    ----------
    logs : (m, n) float64
        Lines; LOG_NOTHING where there is no mass.
    sigma : float
        Standard deviation in cells.
    log_scale : float
        Logarithm of the factor of the Gaussian.

    Returns
    -------
    (m, n) float64
        LOG_NOTHING where nothing arrives.
    """
    count, size = logs.shape
    block = max(int(_BLOCK * sigma), _LEAST_BLOCK)
    blocks = -(-size // block)
    # The tilt between distant blocks could lift LOG_NOTHING to a relevant value, so pad with far less.
    padded = np.full((count, blocks * block), _PADDING)
    np.copyto(padded[:, :size], logs, where=logs > LOG_NOTHING)
    padded = padded.reshape(count, blocks, block)
    offsets = np.arange(block) - (block - 1) / 2
    kernel = np.exp(-((offsets[:, None] - offsets) ** 2) / (2.0 * sigma**2))
    kernel[kernel < NEGLIGIBLE] = 0.0
    result = np.full((count, blocks, block), LOG_NOTHING)
    for target in range(blocks):
        for source, rows in _contributing_blocks(padded, target, offsets, sigma):
            shift = (target - source) * block / sigma**2
            tilted = padded[rows, source] + shift * offsets
            top = tilted.max(axis=1, keepdims=True)
            arrived = np.ascontiguousarray(blas.dgemm(1.0, kernel, flushed_exp(tilted, top).T).T)
            floored_log(arrived, top - shift * offsets - (shift * sigma) ** 2 / 2.0 + log_scale)
            result[rows, target] = np.logaddexp(result[rows, target], arrived)
    blurred = result.reshape(count, -1)[:, :size]
    # The sum of several blocks of LOG_NOTHING is LOG_NOTHING.
    return np.where(blurred > LOG_NOTHING + 1.0, blurred, LOG_NOTHING)


def _contributing_blocks(
    padded: NDArray[np.float64], target: int, offsets: NDArray[np.float64], sigma: float
) -> list[tuple[int, NDArray[np.int64]]]:
    """Source blocks that may contribute to a block of targets, and the lines in which they may.

    Blocks are compared by their largest term at the middle of the target block. Towards its ends, a block may gain on
    another by the difference of their slopes times half a block; the slopes differ by at most their distance over
    sigma^2.
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
