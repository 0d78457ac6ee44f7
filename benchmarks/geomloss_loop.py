# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Adapters to measure GeomLoss: soft-min on lines without KeOps, padding to cubes, and a stopping rule.

GeomLoss' barycenter returns only a density, has no stopping rule, and needs KeOps, a compiler, for its soft-min.
Nothing here imports PyTorch, so that it can be tested without.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .clock import Clock

# Numbers in one block of a log-sum-exp: they fit into the processor's cache.
_BLOCK = 1 << 18
_EVERY = 5
# Iterations per halving of the blur (the default), and slightly more than the factor of the blur in one iteration.
SCALING = 10
_STEP = 1.01 * 2 ** (1 / SCALING)


class Lines:
    """Implements with PyTorch the operations on KeOps' LazyTensor that GeomLoss' soft-min on grids uses.

    Parameters
    ----------
    values : (b, 1, n, 1), (1, n, 1, 1) or (1, 1, n, 1) tensor
        Logarithms along lines, or coordinates.
    cost : tensor or None
        Subtracted on evaluation.
    """

    def __init__(self, values, cost=None) -> None:
        self.values = values
        self._cost = cost

    def __sub__(self, other: Lines) -> Lines:
        return Lines(self.values, other.values)

    def __pow__(self, power: int) -> Lines:
        return Lines((self.values - self._cost) ** power)

    def logsumexp(self, dim: int):
        """Return the log-sum-exp along a dimension, in blocks: at once it would take n^4 numbers on a cube."""
        step = max(1, _BLOCK // (self._cost.shape[1] * self._cost.shape[2]))
        found = self.values.new_empty((len(self.values), self._cost.shape[1], 1))
        for start in range(0, len(found), step):
            found[start : start + step] = (self.values[start : start + step] - self._cost).logsumexp(dim)
        return found


def in_cube(densities: NDArray[np.float64]) -> NDArray[np.float64]:
    """Center densities in a square or cube with a power of two of cells per side, which GeomLoss requires.

    Parameters
    ----------
    densities : (k, *shape)
        Densities on a smaller grid.
    """
    shape = densities.shape[1:]
    side = 1 << (max(shape) - 1).bit_length()
    cube = np.zeros((len(densities), *[side] * len(shape)))
    cube[(slice(None), *_middle(shape, side))] = densities
    return cube


def out_of_cube(values: NDArray[np.floating], shape: tuple[int, ...]) -> NDArray[np.floating]:
    """Return the center of a cube, the inverse of `in_cube`."""
    return values[(..., *_middle(shape, values.shape[-1]))]


def _middle(shape: tuple[int, ...], side: int) -> tuple[slice, ...]:
    return tuple(slice((side - n) // 2, (side - n) // 2 + n) for n in shape)


class Reached(Exception):
    """The error is small enough; raised to leave GeomLoss' loop."""


class Watch:
    """Replaces GeomLoss' iteration: runs it, keeps its result and tests the error.

    A plan's scalings are ``a exp(g / eps)`` on the side of the input and ``bar exp(f / eps)`` on the barycenter's
    side: GeomLoss' potentials refer to the product of the two densities, ours to the kernel alone.

    Parameters
    ----------
    iteration, softmin : callable
        GeomLoss' own functions.
    blur : float
        Final blur of the loop; with a larger blur and on coarser grids, the error is not tested.
    side : int
        Cells along a side of the finest grid.
    threshold : float
        Sufficient error.
    clock : Clock
        Paused during the tests.

    Attributes
    ----------
    iterations : int
        Number so far, on all grids.
    log_density : (*shape)
        Logarithm of the barycenter after the last iteration.
    log_v : (k, *shape)
        Logarithms of the scalings on the barycenter's side.
    """

    def __init__(
        self, iteration: Callable, softmin: Callable, *, blur: float, side: int, threshold: float, clock: Clock
    ) -> None:
        self._iteration, self._softmin = iteration, softmin
        self._blur, self._side, self._threshold, self._clock = blur, side, threshold, clock
        self.iterations = 0

    def __call__(self, f_k, g_k, d_log, eps, p, ak_log, w_k):
        """Iterate once.

        Raises
        ------
        Reached
            If the error is small enough.
        """
        target = self._blur**p
        is_last = ak_log.shape[-1] == self._side and eps < _STEP**p * target
        # For a blur of one cell, GeomLoss' schedule ends one step too early.
        eps = target if is_last else eps
        found = self._iteration(f_k, g_k, d_log, eps, p, ak_log, w_k)
        self.iterations += 1
        if not is_last:
            return found
        with self._clock.paused():
            f_k, _, _, bar_log = found
            log_v = bar_log + f_k / eps
            self.log_density, self.log_v = np.asarray(bar_log)[0, 0], np.asarray(log_v)[0]
            if self.iterations % _EVERY == 0 and self._error(log_v, eps, p, ak_log) <= self._threshold:
                raise Reached
        return found

    def _error(self, log_v, eps: float, p: int, ak_log) -> float:
        """Return the largest sum |v H(a / H(v)) - bar|, for densities of mass one."""
        log_w = ak_log + self._softmin(eps, p, log_v) / eps
        through = np.asarray(log_v - self._softmin(eps, p, log_w) / eps, np.float64)[0]
        bar = np.exp(self.log_density.astype(np.float64))
        return max(float(np.abs(np.exp(each) - bar / bar.sum()).sum()) for each in through)
