# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sinkhorn's iteration for many pairs of distributions at once, in logarithms (Solomon et al. 2015, Algorithm 1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..progress import UNINTERRUPTED, Control, Work
from .domain import Domain, KernelTooNarrowError
from .log_range import LOG_NOTHING
from .relaxation import AdaptiveRelaxation
from .rounds import RoundReports

# Upper limit of exponents whose exponentials are only compared with densities.
_LARGEST = 50.0


@dataclass(frozen=True)
class Scalings:
    """Solved pairs: the plan of pair p is D_v H D_w.

    Attributes
    ----------
    log_v, log_w : (p, *shape) float64
        Logarithms of the scalings of the first and of the second distribution.
    log_kw : (p, *shape) float64
        log H (a w): minus the potential of the first distribution over gamma; also finite beyond its support.
    errors : (p,) float64
        Sum of a |v H(a w) - mu| before the last update of v.
    iterations : int
        Iterations of the slowest pair.
    numerics : str
        "scaling" or the domain's far_numerics.
    """

    log_v: NDArray[np.float64]
    log_w: NDArray[np.float64]
    log_kw: NDArray[np.float64]
    errors: NDArray[np.float64]
    iterations: int
    numerics: str


class KernelInLogarithms:
    """Applies a domain's kernel with float64 scalings until they underflow, then with the far numerics."""

    def __init__(self, domain: Domain) -> None:
        self.domain = domain
        self.far = False

    def apply(self, logs: NDArray[np.float64], needed: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return log H (a * exp(column)); it must be finite where `needed`.

        Raises
        ------
        KernelTooNarrowError
            Even the domain's far numerics underflow.
        """
        out = np.empty(logs.shape)
        if not self.far:
            self.domain.log_apply(logs, out)
            if np.min(out, where=needed, initial=0.0) > LOG_NOTHING / 2:
                return out
            self.far = True
        self.domain.log_apply_far(logs, out)
        if np.min(out, where=needed, initial=0.0) <= LOG_NOTHING:
            raise KernelTooNarrowError(
                f"gamma = {self.domain.gamma:.3g} is too small for the distance between these distributions; "
                f"try {4 * self.domain.gamma:.3g}"
            )
        return out

    @property
    def numerics(self) -> str:
        """The name of the numerics in use, for records."""
        return self.domain.far_numerics if self.far else "scaling"


def log_density(mus: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ln mu of densities of any shape, LOG_NOTHING where there is no mass."""
    logs = np.full(mus.shape, LOG_NOTHING)
    np.log(mus, out=logs, where=mus > 0)
    return logs


def marginal_errors(
    logs: NDArray[np.float64], mus: NDArray[np.float64], weights: float | NDArray[np.float64]
) -> NDArray[np.float64]:
    """Sum of a |exp(column) - mu| for every column."""
    left = np.abs(np.exp(np.minimum(logs, _LARGEST)) - mus) * weights
    return left.reshape(len(left), -1).sum(axis=1)


def balancing(
    mus: NDArray[np.float64],
    nus: NDArray[np.float64],
    domain: Domain,
    *,
    tolerance: float,
    max_iterations: int,
    log_kw: NDArray[np.float64] | None = None,
    control: Control = UNINTERRUPTED,
) -> Work[Scalings]:
    """Find the scalings of the pairs (mus[p], nus[p]): v = mu / H(a w), w = nu / H(a v).

    Pairs that have converged are not iterated further.

    Parameters
    ----------
    mus, nus : (p, *shape) float64
        Densities of mass 1.
    domain : Domain
        The domain of the densities.
    tolerance : float
        Largest sum of a |v H(a w) - mu| at which a pair counts as converged.
    max_iterations : int
        Largest number of rounds.
    log_kw : (p, *shape), optional
        Where to start from.
    control : Control
        Ends the solve when cancelled.

    Yields
    ------
    Progress
        After every round; the payload is a :class:`.rounds.Round`.

    Returns
    -------
    Scalings
        The scalings of all pairs, in order.
    """
    kernel = KernelInLogarithms(domain)
    log_mus, log_nus = log_density(mus), log_density(nus)
    log_kw = np.zeros_like(mus) if log_kw is None else log_kw.copy()
    # Without mass v must be zero; a start from beyond the reach of a coarser kernel would make it huge.
    log_v, log_w = np.where(mus > 0, log_mus - log_kw, LOG_NOTHING), np.full_like(mus, LOG_NOTHING)
    errors = np.full(len(mus), np.inf)
    relaxation = AdaptiveRelaxation(len(mus))
    live = np.arange(len(mus))
    reports = RoundReports(mus[0].size, tolerance)
    for iteration in range(1, max_iterations + 1):
        first, second = mus[live] > 0, nus[live] > 0
        factors = relaxation.factors[live]
        log_kv = kernel.apply(log_v[live], second)
        log_w[live] = _relaxed(log_w[live], log_nus[live] - log_kv, factors, second)
        log_kw[live] = kernel.apply(log_w[live], first)
        found = marginal_errors(log_v[live] + log_kw[live], mus[live], domain.weights)
        if (factors != 1.0).any():
            found = np.maximum(found, marginal_errors(log_w[live] + log_kv, nus[live], domain.weights))
        errors[live] = found
        relaxation.learn(errors, np.isin(np.arange(len(mus)), live))
        # The last update is a full one, so that the first marginals of the plans are exact.
        done = (found < tolerance) | (iteration == max_iterations)
        log_v[live] = _relaxed(log_v[live], log_mus[live] - log_kw[live], np.where(done, 1.0, factors), first)
        control.check()
        yield reports.after(iteration, float(errors.max()))
        live = live[~done]
        if not len(live):
            break
    return Scalings(log_v, log_w, log_kw, errors, iteration, kernel.numerics)


def self_balancing(
    mus: NDArray[np.float64],
    domain: Domain,
    *,
    tolerance: float,
    max_iterations: int,
    control: Control = UNINTERRUPTED,
) -> Work[Scalings]:
    """Find the scaling of every distribution's plan to itself, v H(a v) = mu, by v = sqrt(v mu / H(a v)).

    The square root makes both scalings of the plan equal; about a dozen rounds suffice for any gamma (Feydy et al.
    2019, "Interpolating between optimal transport and MMD using Sinkhorn divergences", section 3).

    Parameters, progress and results are those of :func:`balancing`.
    """
    kernel = KernelInLogarithms(domain)
    log_mus = log_density(mus)
    inside = mus > 0
    log_v = np.where(inside, 0.5 * log_mus, LOG_NOTHING)
    reports = RoundReports(mus[0].size, tolerance)
    for iteration in range(1, max_iterations + 1):
        log_kv = kernel.apply(log_v, inside)
        errors = marginal_errors(log_v + log_kv, mus, domain.weights)
        control.check()
        yield reports.after(iteration, float(errors.max()))
        if errors.max() < tolerance:
            break
        log_v = np.where(inside, 0.5 * (log_v + log_mus - log_kv), LOG_NOTHING)
    return Scalings(log_v, log_v, log_kv, errors, iteration, kernel.numerics)


def _relaxed(
    before: NDArray[np.float64], full: NDArray[np.float64], factors: NDArray[np.float64], inside: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return over-relaxed steps with the factor of each column; LOG_NOTHING outside the support."""
    if (factors == 1.0).all():
        return np.where(inside, full, LOG_NOTHING)
    steps = factors.reshape(-1, *[1] * (full.ndim - 1)) * (full - before)
    return np.where(inside, before + steps, LOG_NOTHING)
