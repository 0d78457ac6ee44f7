# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Successive over-relaxation with a factor estimated from the decrease of the errors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Sweeps with one factor before the rate is estimated, over the last two of them. The gain with these numbers is
# measured in docs/performance, "Distances and propagation"; the numbers themselves were chosen by eye.
_SWEEPS = 6
_LARGEST = 1.9
_GROWING = 0.995
# Rates this close to one are noise; the factor for them would be the largest anyway.
_LARGEST_RATE = 0.9999
# Errors that grow by more than this from almost nothing are as bad as any; their squares must be finite.
_HUGE = 1e100


class AdaptiveRelaxation:
    """Over-relaxation factors of several independent iterations.

    Information crosses one edge of a graph per sweep, and the slowest error on a path of K edges falls by 1 - O(1/K^2)
    per sweep. With the factor omega = 2 / (1 + sqrt(1 - rho)), where rho is the rate without relaxation, it falls by
    1 - O(1/K) (Young 1954, for sweeps by color). A Sinkhorn iteration is linear near its solution, so the theory
    applies: rho follows from the observed rate lambda with (lambda + omega - 1)^2 = lambda omega^2 rho. Where an error
    grows, the factor is moved half way back to one.

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
        """Update the factors from the errors, (count,), of the last sweep, which only updated `live` iterations."""
        self._age[live] += 1
        self._history = np.concatenate([self._history[1:], np.where(live, errors, self._history[2])[None]])
        measurable = np.isfinite(self._history[0]) & (self._history > 0).all(axis=0)
        ready = live & (self._age >= _SWEEPS) & measurable
        if not ready.any():
            return
        with np.errstate(over="ignore"):
            growth = self._history[2, ready] / self._history[0, ready]
        rate = np.sqrt(np.minimum(growth, _HUGE))
        factor = self.factors[ready]
        unrelaxed = np.minimum((rate + factor - 1.0) ** 2 / (rate * factor**2), _LARGEST_RATE)
        best = np.minimum(2.0 / (1.0 + np.sqrt(1.0 - unrelaxed)), _LARGEST)
        # From the best factor on, the rate is omega - 1 whatever rho is.
        better = np.where(rate > factor - 1.0, best, factor)
        chosen = np.where(rate < _GROWING, better, 1.0 + 0.5 * (factor - 1.0))
        self._age[ready] = np.where(chosen != factor, 0, self._age[ready])
        self.factors[ready] = chosen
