# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycentric coordinates: weights whose barycenter equals a given distribution or is nearest to it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..one_line import one_line
from ..progress import UNINTERRUPTED, Control, drained
from .barycenter import Barycenter, barycenter
from .checks import check_distribution, check_distributions, check_sharpness, check_solver
from .distance import Distance, distance
from .domain import Domain
from .inputs import Inputs
from .sinkhorn import balancing, self_balancing

# Weight of the sum-to-one constraint relative to the quadratic form, in nonnegative least squares. The rounding error
# it causes, 1e4 x 1e-16, is far below the tolerance of any solve.
_CONSTRAINT = 1e4
# Step of the weights for difference quotients of the barycenter; a smaller one is lost in the solver's tolerance.
_NUDGE = 1e-2
_SOLVER_SHARE = 1e-2


@dataclass(frozen=True)
class BarycentricCoordinates:
    """Weights that place a distribution in the family of barycenters of others.

    Attributes
    ----------
    weights : (k,) float64
        Nonnegative, of sum 1.
    residual : float
        Standard deviation, under the distribution, of the weighted mean of the potentials, in squared input units of
        the domain; 0 for members of the family.
    marginal_error : float
        The largest over the plans involved.
    converged : bool
        Whether it is below the tolerance.
    """

    weights: NDArray[np.float64]
    residual: float
    marginal_error: float
    converged: bool

    __repr__ = one_line("weights", "residual", "marginal_error", "converged")


@dataclass(frozen=True)
class NearestBarycenter:
    """The member of a family of barycenters that is nearest to a distribution.

    Attributes
    ----------
    weights : (k,) float64
        Nonnegative, of sum 1.
    barycenter : Barycenter
        Of these weights.
    distance : Distance
        Debiased, from the barycenter to the distribution.
    evaluations : int
        Number of weight vectors tried.
    """

    weights: NDArray[np.float64]
    barycenter: Barycenter
    distance: Distance
    evaluations: int

    __repr__ = one_line("weights", "evaluations")


def barycentric_coordinates(
    mu: ArrayLike,
    mus: ArrayLike,
    domain: Domain,
    *,
    sharpness: float = 0.0,
    tolerance: float = 1e-5,
    max_iterations: int = 1000,
    control: Control = UNINTERRUPTED,
) -> BarycentricCoordinates:
    """Weights for which a distribution comes closest to being the barycenter of others.

    mu is the barycenter of weights alpha exactly where sum_i alpha_i ln v_i - s ln d is constant on it (the invariant
    of Algorithm 2), where v_i is the scaling on its side of the transport to mus[i] and d the one of its transport to
    itself. The weights minimize the variance of that sum under mu, a quadratic program in k unknowns (Werenski et al.
    2022, "Measure estimation in the barycentric coding model", with the potentials in place of their gradients). It
    takes k + 1 transports and no barycenter.

    Parameters
    ----------
    mu : domain.shape
        The distribution.
    mus : (k, *domain.shape)
        The distributions that span the family.
    domain : Domain
        Their common domain.
    sharpness : float
        The sharpness of the family's barycenters.
    tolerance, max_iterations, control
        As in :func:`distance`.

    Returns
    -------
    BarycentricCoordinates
        The weights, and how far mu is from being their barycenter.

    Raises
    ------
    ValueError
        Invalid distributions or parameters; the message names the argument.
    KernelTooNarrowError
        gamma is too small for any of the numerics to reach from one distribution to another.
    """
    target, family = _checked(mu, mus, domain)
    check_sharpness(sharpness)
    check_solver(tolerance, max_iterations)
    limits = {"tolerance": tolerance, "max_iterations": max_iterations, "control": control}
    towards = drained(balancing(np.broadcast_to(target, family.shape).copy(), family, domain, **limits))
    own = drained(self_balancing(target[None], domain, **limits))
    inside = target > 0
    mass = (target * domain.weights)[inside]
    potentials = (towards.log_v - sharpness * own.log_v)[:, inside]
    potentials -= (potentials @ mass)[:, None]
    covariance = (potentials * mass) @ potentials.T
    weights = _least_on_simplex(covariance)
    error = max(float(towards.errors.max()), float(own.errors.max()))
    spread = float(np.sqrt(max(weights @ covariance @ weights, 0.0)))
    residual = domain.gamma * domain.unit_length**2 * spread
    return BarycentricCoordinates(weights, residual, error, error < tolerance)


def nearest_barycenter(
    mu: ArrayLike,
    mus: ArrayLike,
    domain: Domain,
    *,
    sharpness: float = 0.0,
    tolerance: float = 1e-3,
    max_iterations: int = 1000,
    max_evaluations: int = 20,
    control: Control = UNINTERRUPTED,
) -> NearestBarycenter:
    """Weights whose barycenter is nearest to a distribution, in debiased distance.

    Starts from :func:`barycentric_coordinates` and descends by sequential quadratic programming on the simplex. The
    derivative of the distance is the potential at the barycenter; the derivative of the barycenter is a difference
    quotient (Bonneel, Peyré and Cuturi 2016, "Wasserstein barycentric coordinates", differentiate the iterations
    instead).

    Parameters
    ----------
    mu, mus, domain, sharpness, max_iterations, control
        As in :func:`barycentric_coordinates`.
    tolerance : float
        Relative decrease of the squared distance at which the search ends; the barycenters are solved to a hundredth
        of this.
    max_evaluations : int
        Largest number of search steps.

    Returns
    -------
    NearestBarycenter
        The weights, their barycenter and its distance from mu.

    Raises
    ------
    ValueError
        Invalid distributions or parameters; the message names the argument.
    KernelTooNarrowError
        gamma is too small for any of the numerics to reach from one distribution to another.
    """
    target, family = _checked(mu, mus, domain)
    check_sharpness(sharpness)
    check_solver(tolerance, max_iterations)
    if max_evaluations < 1:
        raise ValueError(f"max_evaluations must be at least 1, got {max_evaluations}")
    search = _Search(target, family, domain, sharpness, tolerance * _SOLVER_SHARE, max_iterations, control)
    start = barycentric_coordinates(
        target, family, domain, sharpness=sharpness, max_iterations=max_iterations, control=control
    ).weights
    search.value(start)
    if len(family) > 1:
        # Imported here: SciPy loads a hundred modules for it, which most sessions do not need.
        from scipy.optimize import minimize

        minimize(
            search.value,
            start,
            jac=search.gradient,
            method="SLSQP",
            bounds=[(0.0, 1.0)] * len(family),
            constraints={"type": "eq", "fun": lambda w: w.sum() - 1.0, "jac": np.ones_like},
            options={"maxiter": max_evaluations, "ftol": tolerance * max(search.best.distance.value, 0.0)},
        )
    return replace(search.best, evaluations=search.evaluations)


class _Search:
    """Distance from the barycenter of given weights to the target, its gradient, and the best weights so far."""

    def __init__(
        self,
        target: NDArray[np.float64],
        family: NDArray[np.float64],
        domain: Domain,
        sharpness: float,
        tolerance: float,
        max_iterations: int,
        control: Control,
    ) -> None:
        self.target, self.inputs, self.domain = target, Inputs.of(family, domain), domain
        self.limits = {"tolerance": tolerance, "max_iterations": max_iterations, "control": control}
        self.sharpness = sharpness
        self.evaluations = 0
        self.best: NearestBarycenter | None = None

    def value(self, weights: NDArray[np.float64]) -> float:
        """Squared distance from the barycenter of `weights` to the target."""
        weights = _on_simplex(weights)
        self.evaluations += 1
        found = self._barycenter(weights)
        away = distance(found.density, self.target, self.domain, **self.limits)
        self.last = NearestBarycenter(weights, found, away, self.evaluations)
        if self.best is None or away.value < self.best.distance.value:
            self.best = self.last
        return away.value

    def gradient(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the gradient of :meth:`value`, up to a constant, which has no effect on the simplex."""
        weights = _on_simplex(weights)
        if not np.array_equal(weights, self.last.weights):
            self.value(weights)
        density = self.last.barycenter.density
        own = drained(self_balancing(density[None], self.domain, **self.limits))
        potential = self.domain.gamma * self.domain.unit_length**2 * (self.last.distance.log_v - own.log_v[0])
        slopes = []
        for corner in np.eye(len(weights)):
            moved = self._barycenter(weights + _NUDGE * (corner - weights)).density
            slopes.append(float((potential * (moved - density) * self.domain.weights).sum()) / _NUDGE)
        return np.array(slopes)

    def _barycenter(self, weights: NDArray[np.float64]) -> Barycenter:
        return barycenter(self.inputs, weights, self.domain, sharpness=self.sharpness, **self.limits)


def _checked(mu: ArrayLike, mus: ArrayLike, domain: Domain) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    target, family = check_distribution(mu, domain, "mu"), check_distributions(mus, domain)
    check_distributions(np.concatenate([target[None], family]), domain, "mu and mus")
    return target, family


def _least_on_simplex(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights on the simplex that minimize a quadratic form."""
    # Imported here: SciPy loads a hundred modules for it, which most sessions do not need.
    from scipy.optimize import nnls

    values, vectors = np.linalg.eigh(covariance)
    root = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T
    scale = max(float(np.sqrt(np.trace(covariance))), np.finfo(np.float64).tiny)
    rows = np.vstack([root / scale, np.full(len(covariance), _CONSTRAINT)])
    weights, _ = nnls(rows, np.append(np.zeros(len(covariance)), _CONSTRAINT))
    return weights / weights.sum()


def _on_simplex(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    positive = np.clip(weights, 0.0, 1.0)
    return positive / positive.sum()
