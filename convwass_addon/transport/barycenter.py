# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Wasserstein barycenters by iterated Bregman projection, in logarithms.

Algorithm 2 of Solomon et al. 2015, with optional debiasing after Janati, Cuturi and Gramfort 2020 ("Debiased Sinkhorn
barycenters") and with the entropy bound of Algorithm 3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..one_line import one_line
from ..progress import UNINTERRUPTED, Control
from .bregman import BregmanIteration
from .checks import check_entropy_limit, check_sharpness, check_solver, check_weights
from .domain import Domain
from .inputs import Inputs, Level
from .log_range import LOG_NOTHING
from .potentials import Potentials
from .region import Region
from .sharpening import entropy

# Coarser levels are solved to this fraction of the tolerance. A larger fraction leaves errors that the finest level
# corrects slowly; a smaller one saves it no rounds (docs/performance, "Constants of the barycenter").
_COARSE_TOLERANCE = 0.6
# A region grows by this many cells while its rim holds more than this fraction of the tolerance, so that the mass cut
# off stays below the tolerance; a third or three times as much changes nothing (the same table).
_RIM_SHARE = 0.1
_RIM_CELLS = 3


@dataclass(frozen=True)
class Barycenter:
    """A solved barycenter.

    Attributes
    ----------
    density : (*shape) float64
        The barycenter, of mass 1 under the area weights: its mean is 1, not its sum. See `masses`.
    levels : tuple of Potentials
        The scalings of the inputs of positive weight, from coarse to fine; the start for a similar solve.
    weights : (k,) float64
        The weights of the inputs, as used.
    sharpness : float
        As given.
    iterations : tuple of int
        Iterations at every level, coarse to fine.
    marginal_error : float
        The mean, with the weights alpha, of the sums of a |v_i H(a w_i) - mu| over the inputs in the last round. The
        density is off by about 1.5 times as much (sum of a |mu - exact mu|), whatever the weights are; the largest sum,
        that of the input of the least weight, would be many times as much next to the other input. The step of d that
        follows may add up to s times the error of d.
    debias_error : float
        Sum of a |d H(a d) - mu| in the last round, whose final step of d halves it; 0 without sharpness.
    mass : float
        Mass of mu before normalization: about 1, or what remains where mass may vanish.
    mass_error : float
        Its difference from 1; 0 where mass may vanish.
    invariant_error : float
        Largest |sum_i alpha_i ln v_i - s ln d - (1 - 1 / beta) ln mu| where the density is not negligible; zero in
        exact arithmetic.
    converged : bool
        Whether the marginal error and the debiasing error fell below their tolerances.
    numerics : str
        How the kernel was applied at the finest level: "scaling" or the domain's far_numerics.
    entropy : float
        Entropy of the density in nats.
    sharpening_exponent : float
        beta of Algorithm 3; 1 where the bound is inactive.
    areas : float or (*shape) float64
        The area weights of the domain, of sum 1.
    """

    density: NDArray[np.float64]
    levels: tuple[Potentials, ...]
    weights: NDArray[np.float64]
    sharpness: float
    iterations: tuple[int, ...]
    marginal_error: float
    debias_error: float
    mass: float
    mass_error: float
    invariant_error: float
    converged: bool
    numerics: str
    entropy: float
    sharpening_exponent: float
    areas: float | NDArray[np.float64]

    __repr__ = one_line("density", "weights", "iterations", "marginal_error", "converged")

    @property
    def masses(self) -> NDArray[np.float64]:
        """The barycenter as a histogram, (*shape): the mass of every element, of sum 1."""
        return self.density * self.areas

    @property
    def log_v(self) -> NDArray[np.float64]:
        """Logarithms of the scalings on the barycenter's side, (a, *shape), one per input of positive weight."""
        return self.levels[-1].region.scatter(self.levels[-1].log_v, LOG_NOTHING)

    @property
    def active(self) -> NDArray[np.int64]:
        """Indices of the inputs whose weight is not zero, (a,)."""
        return np.flatnonzero(self.weights)

    def record(self) -> dict[str, object]:
        """Return the figures, without the arrays, ready for JSON."""
        names = ("sharpness", "iterations", "marginal_error", "debias_error", "mass", "mass_error", "invariant_error")
        others = ("converged", "numerics", "entropy", "sharpening_exponent")
        found = {name: getattr(self, name) for name in (*names, *others)}
        # An error is infinite if the solve ended before measuring it; JSON has no infinity.
        return {name: None if value == np.inf else value for name, value in found.items()}


def barycenter(
    mus: ArrayLike | Inputs,
    weights: Sequence[float] | NDArray[np.float64],
    domain: Domain,
    *,
    sharpness: float = 0.0,
    entropy_limit: Literal["max"] | float | None = None,
    tightening: int = 0,
    reach: float | None = None,
    initial: Barycenter | None = None,
    begun: Barycenter | None = None,
    tolerance: float = 1e-2,
    debias_tolerance: float | None = None,
    max_iterations: int = 500,
    numerics: Literal["automatic", "scaling"] = "automatic",
    control: Control = UNINTERRUPTED,
) -> Barycenter:
    """Barycenter of distributions under the entropic Wasserstein distance.

    Parameters
    ----------
    mus : (k, *domain.shape) or Inputs
        Nonnegative densities, each normalized to mass 1. On a grid these may be histograms that sum to one; on other
        domains, convert histograms with :func:`from_masses`. ``Inputs.of(mus, domain)`` prepares them once for
        many solves.
    weights : (k,)
        Nonnegative, not all zero; normalized to sum 1. Inputs of weight zero are ignored.
    domain : Domain
        Owns the area weights and the heat kernel.
    sharpness : float
        0 is the paper's barycenter and 1 the debiased one of Janati et al. 2020; values between are their geometric
        blend: mu = d^s prod_i (H(a w_i))^alpha_i.
    entropy_limit : None, "max" or float
        Upper bound on the entropy in nats (eq. 14); "max" takes the largest entropy of the inputs.
    tightening : int
        Number of steps in which the bound is tightened, from the entropy of the unbounded barycenter to the limit (end
        of section 6.1), on the finest domain only; 0 applies the limit from the start.
    reach : float, optional
        Distance, in units of the finest domain (cells), beyond which mass vanishes in one place and appears in another
        instead of travelling; by default all mass travels. Cannot be combined with an entropy limit.
    initial : Barycenter, optional
        The barycenter of the same inputs with similar weights on the same domain, to start from. Ignored unless the
        same inputs have positive weight.
    begun : Barycenter, optional
        The barycenter of ``inputs.coarser`` (or of coarser levels still) with the same weights and options, started
        from the coarser part of `initial` if that is given. Its levels are not solved again; the result is the same.
    tolerance : float
        The solve ends when the marginal error is below this and the debiasing error below the next.
    debias_tolerance : float, optional
        By default the tolerance. Errors of the debiasing density have the size of cells and show as wrinkles; those of
        the marginals are smooth.
    max_iterations : int
        At every level.
    numerics : "automatic" or "scaling"
        Where float64 scalings underflow, "automatic" continues in the log domain, which is slower; "scaling" raises.
    control : Control
        Ends the solve when cancelled.

    Returns
    -------
    Barycenter
        The density and how well it solves the problem.

    Raises
    ------
    ValueError
        Invalid distributions, weights or parameters; the message names the argument.
    KernelTooNarrowError
        float64 scalings underflow and `numerics` is "scaling".
    """
    inputs = mus if isinstance(mus, Inputs) else Inputs.of(mus, domain)
    if inputs.domain is not domain:
        raise ValueError("mus must have been prepared for this domain")
    alphas = check_weights(weights, len(inputs))
    check_sharpness(sharpness)
    check_entropy_limit(entropy_limit)
    check_solver(tolerance, max_iterations)
    if debias_tolerance is not None and not debias_tolerance > 0:
        raise ValueError(f"debias_tolerance must be positive, got {debias_tolerance}")
    if tightening < 0 or tightening != int(tightening):
        raise ValueError(f"tightening must be zero or a positive whole number, got {tightening}")
    if numerics not in ("automatic", "scaling"):
        raise ValueError(f'numerics must be "automatic" or "scaling", got {numerics!r}')
    if initial is not None and initial.density.shape != tuple(domain.shape):
        raise ValueError(f"initial must be a barycenter on a domain of shape {tuple(domain.shape)}")
    if begun is not None:
        _check_begun(begun, inputs, alphas, sharpness)
    if reach is not None and not (np.isfinite(reach) and reach > 0):
        raise ValueError(f"reach must be a positive length, got {reach}")
    if reach is not None and entropy_limit is not None:
        raise ValueError("entropy_limit holds a mass of 1 together, so there can be no reach")
    active = np.flatnonzero(alphas)
    input_levels = tuple(level.chosen(active) for level in inputs.levels)
    length = None if reach is None else float(reach) / inputs.aim.unit_length
    tolerances = _Tolerances(tolerance, tolerance if debias_tolerance is None else debias_tolerance)
    problem = _Problem(
        input_levels, inputs.aim, alphas[active], sharpness, length, tolerances, max_iterations, numerics, control
    )
    limit = float(inputs.entropies[active].max()) if entropy_limit == "max" else entropy_limit
    usable = initial is not None and np.array_equal(initial.active, active)
    first = None if tightening else limit
    done = None if begun is None else problem.resumed(begun, first)
    solved = problem.coarse_to_fine(first, initial.levels if usable else (), done)
    if limit is not None and tightening and domain is inputs.aim:
        free = entropy(solved.state.density, solved.state.weights)
        for bound in np.linspace(free, float(limit), tightening + 1)[1:]:
            solved = problem.continued(solved, float(bound))
    return _finished(solved, alphas, sharpness, tolerances)


def _check_begun(begun: Barycenter, inputs: Inputs, alphas: NDArray[np.float64], sharpness: float) -> None:
    coarser = {count: level.domain.shape for count, level in enumerate(inputs.levels[:-1], start=1)}
    if coarser.get(len(begun.levels)) != begun.density.shape:
        raise ValueError("begun must be a barycenter of the coarser levels of these inputs")
    if not np.array_equal(begun.weights, alphas) or begun.sharpness != sharpness:
        raise ValueError("begun must have the weights and the sharpness that are asked for")


@dataclass(frozen=True)
class _Solved:
    """The finest level's iteration, the states of all levels and their iterations."""

    state: BregmanIteration
    levels: tuple[Potentials, ...]
    iterations: tuple[int, ...]


@dataclass(frozen=True)
class _Tolerances:
    """Largest errors of the marginals and of the debiasing density d.

    The barycenter lags behind d even when the marginals agree. The error of d is measured before its last step. After a
    start nearby, twice as large an error of d would be acceptable; after a distant one it shows as jagged creases.
    """

    marginal: float
    debias: float

    def met(self, state: BregmanIteration, factor: float = 1.0) -> bool:
        """Return whether the errors of the last round are below the tolerances times a factor."""
        return state.marginal_error < factor * self.marginal and state.debias_error < factor * self.debias


@dataclass(frozen=True)
class _Problem:
    """Everything that stays the same from level to level and from bound to bound."""

    input_levels: tuple[Level, ...]
    aim: Domain
    alphas: NDArray[np.float64]
    sharpness: float
    reach: float | None
    tolerances: _Tolerances
    max_iterations: int
    numerics: Literal["automatic", "scaling"]
    control: Control

    def resumed(self, begun: Barycenter, limit: float | None) -> _Solved:
        """Restart from the coarse levels that `begun` has solved."""
        level, start = self.input_levels[len(begun.levels) - 1], begun.levels[-1]
        state = BregmanIteration(level, self.alphas, self.sharpness, limit, start, self.numerics, self.reach)
        state.density[...] = start.region.gather(begun.density)
        return _Solved(state, begun.levels, begun.iterations)

    def coarse_to_fine(self, limit: float | None, before: tuple[Potentials, ...], done: _Solved | None) -> _Solved:
        """Solve from coarse to fine, each level started from the last and, if given, from a similar solve's levels."""
        levels: list[Potentials] = [] if done is None else list(done.levels)
        iterations = [] if done is None else list(done.iterations)
        state = None if done is None else done.state
        for depth in range(len(levels), len(self.input_levels)):
            level = self.input_levels[depth]
            domain = level.domain
            region = state.finer_region(self.tolerances.marginal, domain) if depth else Region.whole(domain.shape)
            if before:
                start = before[depth]
                if depth:
                    start = start.corrected(domain, region, levels[-1], before[depth - 1])
            elif depth:
                start = levels[-1].prolonged(domain, region)
            else:
                start = Potentials.flat(len(self.alphas), domain.shape)
            # With a bound, the coarser state already satisfies its own, different invariant.
            if self.reach is None and (limit is None or before or not depth):
                start = start.for_weights(self.alphas, self.sharpness)
            factor = 1.0 if domain is self.aim else _COARSE_TOLERANCE
            state, count = self._solve(level, limit, start, factor)
            levels.append(state.potentials())
            iterations.append(count)
        return _Solved(state, tuple(levels), tuple(iterations))

    def continued(self, solved: _Solved, limit: float) -> _Solved:
        """Solve the finest level again with another bound."""
        state, count = self._solve(self.input_levels[-1], limit, solved.levels[-1])
        return _Solved(state, (*solved.levels[:-1], state.potentials()), (*solved.iterations, count))

    def _solve(
        self,
        level: Level,
        limit: float | None,
        start: Potentials,
        factor: float = 1.0,
    ) -> tuple[BregmanIteration, int]:
        """Iterate on one domain until the errors are below the tolerances times a factor."""
        state = BregmanIteration(level, self.alphas, self.sharpness, limit, start, self.numerics, self.reach)
        for iteration in range(1, self.max_iterations + 1):  # noqa: B007
            state.step()
            self.control.check()
            if self.tolerances.met(state, factor):
                if state.rim_mass() <= _RIM_SHARE * factor * self.tolerances.marginal:
                    break
                state.grow(_RIM_CELLS)
        state.settle()
        return state, iteration


def _finished(solved: _Solved, alphas: NDArray[np.float64], sharpness: float, tolerances: _Tolerances) -> Barycenter:
    state = solved.state
    return Barycenter(
        density=state.region.scatter(state.density, 0.0),
        levels=solved.levels,
        weights=alphas,
        sharpness=sharpness,
        iterations=solved.iterations,
        marginal_error=state.marginal_error,
        debias_error=state.debias_error,
        mass=state.mass,
        mass_error=state.mass_error(),
        invariant_error=state.invariant_error(),
        converged=tolerances.met(state),
        numerics=state.domain.far_numerics if state.far else "scaling",
        entropy=entropy(state.density, state.weights),
        sharpening_exponent=state.exponent,
        areas=state.domain.weights,
    )
