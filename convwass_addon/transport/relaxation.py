# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Successive over-relaxation whose factor is learned from how the errors fall."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Sweeps with one factor before the rate is read off, over the last two of them. What it gains, with these numbers, is
# measured in docs/performance.md, "Distances and propagation"; the numbers themselves were chosen by eye.
_SWEEPS = 6
_LARGEST = 1.9
_GROWING = 0.995
# Rates this near one are noise; the factor that they ask for is the largest anyway.
_LARGEST_RATE = 0.9999


class AdaptiveRelaxation:
    """Over-relaxation factors of several independent iterations.

    Information crosses one edge of a graph per sweep, and the slowest error of a line of K edges falls by 1 - O(1/K^2)
    a sweep. With the factor omega = 2 / (1 + sqrt(1 - rho)), rho the rate without relaxation, it falls by 1 - O(1/K)
    (Young 1954, for sweeps by color). Near its end a Sinkhorn iteration is a linear one, so the theory holds: rho
    follows from the rate lambda seen with omega, (lambda + omega - 1)^2 = lambda omega^2 rho. Where an error grows,
    the factor goes half the way back to one.

    Parameters
    ----------
    count : int
        Number of iterations.

    Attributes
    ----------
    factors : (count,) float64
        The factors to use in the next sweep.
    """

    def __init__(self, count: int) -> None:
        self.factors = np.ones(count)
        self._age = np.zeros(count, np.int64)
        self._history = np.full((3, count), np.inf)

    def learn(self, errors: NDArray[np.float64], live: NDArray[np.bool_]) -> None:
        """Take the errors, (count,), of the sweep that was just done; only `live` iterations were in it."""
        self._age[live] += 1
        self._history = np.concatenate([self._history[1:], np.where(live, errors, self._history[2])[None]])
        measurable = np.isfinite(self._history[0]) & (self._history > 0).all(axis=0)
        ready = live & (self._age >= _SWEEPS) & measurable
        if not ready.any():
            return
        rate = np.sqrt(self._history[2, ready] / self._history[0, ready])
        factor = self.factors[ready]
        unrelaxed = np.minimum((rate + factor - 1.0) ** 2 / (rate * factor**2), _LARGEST_RATE)
        best = np.minimum(2.0 / (1.0 + np.sqrt(1.0 - unrelaxed)), _LARGEST)
        # At and beyond the best factor every rate is omega - 1 and says nothing.
        better = np.where(rate > factor - 1.0, best, factor)
        chosen = np.where(rate < _GROWING, better, 1.0 + 0.5 * (factor - 1.0))
        self._age[ready] = np.where(chosen != factor, 0, self._age[ready])
        self.factors[ready] = chosen
