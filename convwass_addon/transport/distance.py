# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convolutional Wasserstein distances (Solomon et al. 2015, section 5), debiased or as in the paper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..geometry.arrays.chunks import chunks
from ..one_line import one_line
from ..progress import UNINTERRUPTED, Control, Work, drained, within
from .checks import check_distributions, check_pair, check_solver
from .domain import Domain
from .region import Region
from .rounds import COARSE_SHARE
from .sinkhorn import Scalings, balancing, self_balancing

# Coarser levels only provide the starting point of the finest one.
_COARSE_TOLERANCE = 1e-3
# Pairs are solved together as long as they fit into this many values per array.
_VALUES_AT_ONCE = 1 << 23
# An upper limit, so that progress can be reported; larger blocks are hardly faster.
_PAIRS_AT_ONCE = 16
# Self-transport takes a dozen rounds. For a distance it comes last, from this fraction of the progress on; for a matrix
# it comes first, up to this fraction.
_OWN_BEGIN, _OWN_END = 0.85, 0.1


@dataclass(frozen=True)
class Distance:
    """A solved transport between two distributions.

    Attributes
    ----------
    value : float
        Squared distance W2^2 in squared input units of the domain (cells, or the units of the vertices): the divergence
        converted by ``domain.squared_distance``, and zero where rounding makes it negative. Without debiasing, the
        entropic value.
    entropic_value : float
        Eq. (10), gamma (1 + min KL(pi | H)), in the same units. It does not vanish between equal distributions and has
        an offset from the normalization of H.
    divergence : float
        The entropic value minus half of each distribution's own self-transport value (Feydy et al. 2019), in the same
        units: zero between equal distributions. None without debiasing.
    iterations : int
        Sinkhorn iterations between the two distributions, over all levels.
    marginal_error : float
        Sum of a |v H(a w) - mu0|, the largest over all plans that contribute to the value.
    converged : bool
        Whether the error fell below the tolerance.
    numerics : str
        "scaling" or the domain's far_numerics.
    log_v, log_w : ndarray of the domain's shape
        Logarithms of the scalings: the plan is D_v H D_w with marginals mu0 and mu1.
    """

    value: float
    entropic_value: float
    divergence: float | None
    iterations: int
    marginal_error: float
    converged: bool
    numerics: str
    log_v: NDArray[np.float64]
    log_w: NDArray[np.float64]

    __repr__ = one_line("value", "length", "iterations", "marginal_error", "converged", "numerics")

    @property
    def length(self) -> float:
        """The distance itself, W2, in the domain's input units."""
        return float(np.sqrt(max(self.value, 0.0)))

    @property
    def v(self) -> NDArray[np.float64]:
        """The scaling on the side of mu0, of its shape, clipped to the largest float64."""
        return _exponential(self.log_v)

    @property
    def w(self) -> NDArray[np.float64]:
        """The scaling on the side of mu1, of its shape, clipped to the largest float64."""
        return _exponential(self.log_w)


@dataclass(frozen=True)
class DistanceMatrix:
    """Squared distances between all pairs.

    Attributes
    ----------
    values : (k, k) float64
        Squared distances, symmetric, zero on the diagonal; units as for `Distance`.
    iterations : int
        Iterations of the slowest pair.
    marginal_error : float
        The largest over all plans.
    converged : bool
        Whether it is below the tolerance.
    """

    values: NDArray[np.float64]
    iterations: int
    marginal_error: float
    converged: bool

    __repr__ = one_line("values", "iterations", "marginal_error", "converged")


def distance(
    mu0: ArrayLike,
    mu1: ArrayLike,
    domain: Domain,
    *,
    debias: bool = True,
    tolerance: float = 1e-5,
    max_iterations: int = 1000,
    control: Control = UNINTERRUPTED,
) -> Distance:
    """Squared Wasserstein distance between two distributions (Algorithm 1).

    Parameters
    ----------
    mu0, mu1 : domain.shape
        Nonnegative densities; each is normalized to mass 1.
    domain : Domain
        Owns the area weights and the heat kernel.
    debias : bool
        Whether to subtract the self-transport terms, so that the value is zero between equal distributions and close
        to the true distance; otherwise it is the value of eq. (10).
    tolerance : float
        Largest marginal error.
    max_iterations : int
        At every level.
    control : Control
        Ends the solve when cancelled.

    Returns
    -------
    Distance
        The value and how well it solves the problem.

    Raises
    ------
    ValueError
        Invalid distributions or parameters; the message names the argument.
    KernelTooNarrowError
        gamma is too small for any of the numerics to reach from one distribution to the other.
    """
    return drained(
        distance_rounds(
            mu0, mu1, domain, debias=debias, tolerance=tolerance, max_iterations=max_iterations, control=control
        )
    )


def distance_rounds(
    mu0: ArrayLike,
    mu1: ArrayLike,
    domain: Domain,
    *,
    debias: bool = True,
    tolerance: float = 1e-5,
    max_iterations: int = 1000,
    control: Control = UNINTERRUPTED,
) -> Work[Distance]:
    """Like :func:`distance`, but yields progress after every round; parameters and errors are the same.

    Yields
    ------
    Progress
        After every round of the plan between the two distributions and, if debiased, of their plans to themselves; the
        payload is a :class:`.rounds.Round`.

    Returns
    -------
    Distance
    """
    pair = check_pair(mu0, mu1, domain)
    check_solver(tolerance, max_iterations)
    solving = _coarse_to_fine(pair[:1], pair[1:], domain, tolerance, max_iterations, control)
    solved, iterations = yield from within(solving, 0.0, _OWN_BEGIN if debias else 1.0)
    entropic = float(_entropic_values(solved, pair[:1], pair[1:], domain)[0])
    value, divergence, error = entropic, None, float(solved.errors[0])
    if debias:
        solving = self_balancing(pair, domain, tolerance=tolerance, max_iterations=max_iterations, control=control)
        own = yield from within(solving, _OWN_BEGIN, 1.0)
        divergence = entropic - 0.5 * float(_self_values(own, pair, domain).sum())
        value = float(_squared_distances(np.array(divergence), domain))
        error = max(error, float(own.errors.max()))
    log_v, log_w = _balanced(solved.log_v[0], solved.log_w[0])
    return Distance(value, entropic, divergence, iterations, error, error < tolerance, solved.numerics, log_v, log_w)


def distance_matrix(
    mus: ArrayLike,
    domain: Domain,
    *,
    tolerance: float = 1e-5,
    max_iterations: int = 1000,
    control: Control = UNINTERRUPTED,
) -> DistanceMatrix:
    """Debiased squared distances between all pairs of `mus`, (k, *domain.shape), solved in blocks of pairs.

    Parameters and errors are those of :func:`distance`.
    """
    return drained(
        distance_matrix_rounds(mus, domain, tolerance=tolerance, max_iterations=max_iterations, control=control)
    )


def distance_matrix_rounds(
    mus: ArrayLike,
    domain: Domain,
    *,
    tolerance: float = 1e-5,
    max_iterations: int = 1000,
    control: Control = UNINTERRUPTED,
) -> Work[DistanceMatrix]:
    """Like :func:`distance_matrix`, but yields progress after every round; parameters and errors are the same.

    Yields
    ------
    Progress
        After every round of every block of pairs; the payload is a :class:`.rounds.Round`.

    Returns
    -------
    DistanceMatrix
    """
    densities = check_distributions(mus, domain)
    check_solver(tolerance, max_iterations)
    solving = self_balancing(densities, domain, tolerance=tolerance, max_iterations=max_iterations, control=control)
    own = yield from within(solving, 0.0, _OWN_END)
    self_values = _self_values(own, densities, domain)
    first, second = np.triu_indices(len(densities), 1)
    values = np.zeros((len(densities), len(densities)))
    error, iterations = float(own.errors.max()), own.iterations
    share = (1.0 - _OWN_END) / max(len(first), 1)
    for some in chunks(len(first), min(max(1, _VALUES_AT_ONCE // densities[0].size), _PAIRS_AT_ONCE)):
        i, j = first[some], second[some]
        solving = _coarse_to_fine(densities[i], densities[j], domain, tolerance, max_iterations, control)
        solved, rounds = yield from within(solving, _OWN_END + share * some.start, _OWN_END + share * some.stop)
        found = _entropic_values(solved, densities[i], densities[j], domain)
        divergences = found - 0.5 * (self_values[i] + self_values[j])
        values[i, j] = values[j, i] = _squared_distances(divergences, domain)
        error, iterations = max(error, float(solved.errors.max())), max(iterations, rounds)
    return DistanceMatrix(values, iterations, error, error < tolerance)


def _coarse_to_fine(
    mus: NDArray[np.float64],
    nus: NDArray[np.float64],
    domain: Domain,
    tolerance: float,
    max_iterations: int,
    control: Control,
) -> Work[tuple[Scalings, int]]:
    """Solve pairs on ever finer domains; return the scalings of the finest one and the iterations of all."""
    coarser = None if domain.has_fast_balance else domain.coarser()
    start, before = None, 0
    if coarser is not None:
        loose = max(tolerance, _COARSE_TOLERANCE)
        restricted = domain.restrict(mus), domain.restrict(nus)
        solving = _coarse_to_fine(*restricted, coarser, loose, max_iterations, control)
        coarse, before = yield from within(solving, 0.0, COARSE_SHARE)
        # The potential is -gamma log H(a w).
        start = domain.fall_of_gamma * domain.prolong(coarse.log_kw, Region.whole(domain.shape)).reshape(mus.shape)
    solving = balancing(
        mus, nus, domain, tolerance=tolerance, max_iterations=max_iterations, log_kw=start, control=control
    )
    solved = yield from within(solving, 0.0 if coarser is None else COARSE_SHARE, 1.0)
    return solved, before + solved.iterations


def _entropic_values(
    solved: Scalings, mus: NDArray[np.float64], nus: NDArray[np.float64], domain: Domain
) -> NDArray[np.float64]:
    """Return gamma a^T (mu ln v + nu ln w) of every pair, in squared input units of the domain."""
    return domain.gamma * domain.unit_length**2 * _sums(mus * solved.log_v + nus * solved.log_w, domain)


def _self_values(own: Scalings, mus: NDArray[np.float64], domain: Domain) -> NDArray[np.float64]:
    """Return the entropic values of plans of distributions to themselves.

    Neither marginal of such a plan is exact, so the mass term of the dual, 1 - a^T (v H(a v)), does not vanish.
    """
    plan = np.where(mus > 0, np.exp(np.minimum(own.log_v + own.log_kw, 50.0)), 0.0)
    values = 2.0 * _sums(mus * own.log_v, domain) + 1.0 - _sums(plan, domain)
    return domain.gamma * domain.unit_length**2 * values


def _squared_distances(divergences: NDArray[np.float64], domain: Domain) -> NDArray[np.float64]:
    """Convert divergences to squared distances, both in squared input units of the domain."""
    scale = domain.unit_length**2
    return scale * domain.squared_distance(np.maximum(divergences, 0.0) / scale)


def _sums(columns: NDArray[np.float64], domain: Domain) -> NDArray[np.float64]:
    return (columns * domain.weights).reshape(len(columns), -1).sum(axis=1)


def _balanced(
    log_v: NDArray[np.float64], log_w: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Move a constant from one scaling to the other until their maxima are equal, which leaves the plan unchanged."""
    shift = 0.5 * (log_w.max() - log_v.max())
    return log_v + shift, log_w - shift


def _exponential(logs: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.exp(np.minimum(logs, np.log(np.finfo(np.float64).max)))
