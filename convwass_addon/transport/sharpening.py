# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Entropic sharpening: bound a distribution's entropy (Solomon et al. 2015, Algorithm 3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .pieces import PieceMasses

# Densities below e^-60 = 9e-27 of the largest do not change an entropy in float64, which is accurate to 1e-16.
_DEPTH = 60.0
_STEPS = 50
# Under an entropy bound, solvers scale their steps by this fraction divided by the exponent, because the exponent
# amplifies every step; full steps would oscillate between two solutions.
BOUNDED_STEP = 0.7
# A smaller variance is rounding error of a uniform density; dividing by it would overflow float64.
_LEAST_VARIANCE = 1e-200


class _Moments:
    """Entropy of mu^beta and variance of ln mu under it."""

    def __init__(self, log_density: NDArray[np.float64], weights: float | NDArray[np.float64]) -> None:
        keep = log_density > log_density.max() - _DEPTH
        self.logs = log_density[keep] - log_density.max()
        self.area = np.broadcast_to(weights, log_density.shape)[keep]

    def entropy_and_variance(self, beta: float) -> tuple[float, float]:
        mass = self.area * np.exp(beta * self.logs)
        total = mass.sum()
        mean = (mass * self.logs).sum() / total
        return float(np.log(total) - beta * mean), float((mass * self.logs**2).sum() / total - mean**2)


class _PieceMoments:
    """Like `_Moments`, where every component keeps its mass."""

    def __init__(self, log_density: NDArray[np.float64], weights: NDArray[np.float64], pieces: PieceMasses) -> None:
        logs = log_density - pieces.tops(log_density)[pieces.labels]
        keep = (logs > -_DEPTH) & (pieces.masses[pieces.labels] > 0) & (weights > 0)
        self.logs, self.area = logs[keep], weights[keep]
        self.pieces = PieceMasses(pieces.labels[keep], pieces.masses)
        self.holds = self.pieces.sums(self.area) > 0

    def entropy_and_variance(self, beta: float) -> tuple[float, float]:
        mass = self.area * np.exp(beta * self.logs)
        first, second, third = (self.pieces.sums(mass * self.logs**k)[self.holds] for k in range(3))
        shares, means = self.pieces.masses[self.holds], second / first
        found = shares @ (np.log(first) - beta * means - np.log(shares))
        return float(found), float(shares @ (third / first - means**2))


def entropy(density: NDArray[np.float64], weights: float | NDArray[np.float64]) -> float:
    """Entropy H(mu) = -sum a mu ln mu of a density, in nats; 0 for the uniform density."""
    mass = density * weights
    positive = density > 0
    return -float((mass[positive] * np.log(density[positive])).sum())


def entropy_between(entropies: ArrayLike, weights: ArrayLike, dimension: int) -> NDArray[np.float64] | np.float64:
    """Entropy of an interpolation between distributions whose effective radii are interpolated linearly.

    The uniform distribution on a ball of radius r in d dimensions has entropy d ln r plus a constant; a ball whose
    radius is the weighted mean has entropy d ln(sum_i weights_i e^(H_i / d)).

    Parameters
    ----------
    entropies : (k, ...)
        In nats.
    weights : (k, ...)
        Nonnegative, of sum one over the first axis.
    dimension : int
        Dimension of the domain.
    """
    own = np.asarray(entropies, dtype=np.float64)
    top = own.max(axis=0)
    return top + dimension * np.log((np.asarray(weights) * np.exp((own - top) / dimension)).sum(axis=0))


def sharpening_exponent(
    log_density: NDArray[np.float64],
    limit: float,
    weights: float | NDArray[np.float64],
    pieces: PieceMasses | None = None,
) -> float:
    """Exponent beta >= 1 for which mu^beta, normalized, has entropy `limit`.

    Parameters
    ----------
    log_density : ndarray
        ln mu, up to a constant.
    limit : float
        Largest entropy allowed, in nats.
    weights : float or ndarray
        Area weights of the domain.
    pieces : PieceMasses, optional
        The masses that connected components keep; by default mass may go anywhere.

    Returns
    -------
    float
        1 where the entropy is already below the limit; the largest exponent tried where no exponent reaches it.

    Notes
    -----
    With p the normalized mu^beta and q = ln mu, dH/dbeta = -beta Var_p(q): Newton's method on a monotone function,
    safeguarded by a bracket. With components that keep their masses M, H = sum M (ln Z - beta mean(q) - ln M) over the
    components, and the variances are summed with the weights M.
    """
    moments = _Moments(log_density, weights) if pieces is None else _PieceMoments(log_density, weights, pieces)
    low, high, beta = 1.0, np.inf, 1.0
    for _ in range(_STEPS):
        found, variance = moments.entropy_and_variance(beta)
        excess = found - limit
        if beta == 1.0 and excess <= 0:
            return 1.0
        if abs(excess) < 1e-9:
            break
        low, high = (beta, high) if excess > 0 else (low, beta)
        step = beta + excess / (beta * variance) if variance > _LEAST_VARIANCE else np.inf
        if not low < step < high:
            step = 2.0 * low if np.isinf(high) else 0.5 * (low + high)
        if step > 1e6:
            break
        beta = step
    return float(beta)
