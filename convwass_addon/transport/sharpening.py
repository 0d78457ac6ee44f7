# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Entropic sharpening: keep a distribution's entropy below a bound (Solomon et al. 2015, Algorithm 3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Densities below exp(-60) of the largest carry no entropy that float64 could show.
_DEPTH = 60.0
_STEPS = 50
# Less is the rounding of an even density, and a step over it would leave the range of float64.
_LEAST_VARIANCE = 1e-200


def entropy(density: NDArray[np.float64], weights: float | NDArray[np.float64]) -> float:
    """Entropy H(mu) = -sum a mu ln mu of a density, in nats; 0 for the uniform density."""
    mass = density * weights
    positive = density > 0
    return -float((mass[positive] * np.log(density[positive])).sum())


def sharpening_exponent(log_density: NDArray[np.float64], limit: float, weights: float | NDArray[np.float64]) -> float:
    """Exponent beta >= 1 for which mu^beta, normalized, has entropy `limit`.

    Parameters
    ----------
    log_density : ndarray
        ln mu, up to a constant.
    limit : float
        Largest entropy allowed, in nats.
    weights : float or ndarray
        Area weights of the domain.

    Returns
    -------
    float
        1 where the entropy is below the limit already; the largest exponent tried where no exponent reaches it.

    Notes
    -----
    With p the normalized mu^beta and q = ln mu, dH/dbeta = -beta Var_p(q): Newton's method on a monotone function,
    kept inside a bracket.
    """
    keep = log_density > log_density.max() - _DEPTH
    logs = log_density[keep] - log_density.max()
    area = np.broadcast_to(weights, log_density.shape)[keep]
    low, high, beta = 1.0, np.inf, 1.0
    for _ in range(_STEPS):
        density = np.exp(beta * logs)
        mass = area * density
        total = mass.sum()
        mean = (mass * logs).sum() / total
        excess = np.log(total) - beta * mean - limit
        if beta == 1.0 and excess <= 0:
            return 1.0
        if abs(excess) < 1e-9:
            break
        low, high = (beta, high) if excess > 0 else (low, beta)
        variance = (mass * logs**2).sum() / total - mean**2
        step = beta + excess / (beta * variance) if variance > _LEAST_VARIANCE else np.inf
        if not low < step < high:
            step = 2.0 * low if np.isinf(high) else 0.5 * (low + high)
        if step > 1e6:
            break
        beta = step
    return float(beta)
