# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One level of the iterated Bregman projections for barycenters, in logarithms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .domain import KernelTooNarrowError, Multiscale, total_mass
from .fidelity import fidelity
from .inputs import Level
from .log_range import LOG_NOTHING, RELEVANT
from .pieces import PieceMasses
from .potentials import Potentials
from .region import Region
from .sharpening import BOUNDED_STEP, sharpening_exponent

# ln d spans a few orders of magnitude where there is mass. Elsewhere its value is irrelevant, but exp(ln d) must not
# overflow float64, whose logarithms end at 709.
_DEBIAS_RANGE = 700.0
# Over-relaxation of v speeds up grids; it is switched off once a round leaves more than this fraction of the error. A
# safeguard: normal convergence never triggers it (docs/performance, "Constants of the barycenter").
_STALLED = 0.95
# Damping of the step of d. A full step overshoots where the error of ln d varies slowly compared with the kernel;
# where it varies faster, a step leaves 1 - (1 - s) of it. This value leaves the least overall (the same table).
_DEBIAS_STEP = 0.9
# Heavy-ball momentum of ln d, and how much it decreases per unit of missing sharpness: sharper barycenters converge
# more slowly. Measured for sharpness 1 and 0.75 (the same table).
_DEBIAS_MOMENTUM, _MOMENTUM_FALL = 0.6, 1.6
# The largest change of ln d anywhere in the last step, which no measurement follows.
_LAST_STEP = float(np.log(2.0))
# Elements of a coarse barycenter below this fraction of the tolerance, relative to its maximum, are dropped on finer
# levels, except within a margin (docs/performance, "Constants of the barycenter").
_NEGLIGIBLE_SHARE = 0.3


class BregmanIteration:
    """Iterates on one domain; every :meth:`step` is one round of Algorithm 2 (Solomon et al. 2015).

    With the paper's v_i, w_i and the debiasing density d of Janati et al. 2020 raised to the sharpness s, a round is

        w_i = mu_i / H(a v_i),    mu = (d^s prod_i H(a w_i)^alpha_i)^beta,
        v_i = mu / H(a w_i),      d' = d (mu / (d H(a d)))^0.9 (d / d_before)^m,    v_i' = v_i (d' / d)^s

    This is the paper's round with prod_i v_i^alpha_i = d^s built in, so that no error accumulates: from any start, the
    state fits its weights after one round. Without the last step v would lag one round behind d, and errors of d would
    oscillate. The momentum m (Polyak 1964) speeds up the slow errors of sharp barycenters. mu is normalized to mass 1
    inside the round, because otherwise the root in d makes the total mass oscillate for a dozen rounds; v keeps the
    unnormalized mass, which converges to 1.

    Where mass may vanish and appear, every update has an exponent: see :class:`.fidelity.Unbalanced`.

    v_i, d and mu are stored on the region of the start, w_i where mu_i has mass; the rest of the domain costs nothing.

    Parameters
    ----------
    inputs : Level
        The distributions, of mass 1, and their domain.
    alphas : (k,) float64
        Positive weights of sum 1.
    sharpness : float
        s above.
    entropy_limit : float or None
        Bound for the entropy of mu, or none (beta = 1).
    start : Potentials
        Copied.
    numerics : "automatic" or "scaling"
        Whether to continue in the log domain or to raise where float64 scalings underflow.
    reach : float or None
        Distance at which mass fades instead of travelling, in lengths of the domain; None lets all mass travel.
    """

    def __init__(
        self,
        inputs: Level,
        alphas: NDArray[np.float64],
        sharpness: float,
        entropy_limit: float | None,
        start: Potentials,
        numerics: Literal["automatic", "scaling"] = "automatic",
        reach: float | None = None,
    ) -> None:
        self.domain = inputs.domain
        self.fidelity = fidelity(reach, inputs.domain.gamma)
        self.balanced = reach is None
        self.numerics = numerics
        self.alphas = alphas
        self.sharpness = sharpness
        self.entropy_limit = entropy_limit
        self.exponent = 1.0
        self.far = False
        self._momentum = max(_DEBIAS_MOMENTUM - _MOMENTUM_FALL * (1.0 - sharpness), 0.0)
        self._arrived = np.ones(len(alphas))
        self._inputs = inputs.regions
        self._log_mus = inputs.log_mus
        self._pieces = None
        if self.balanced and self.domain.pieces is not None:
            first = inputs.regions[0].scatter(np.exp(inputs.log_mus[0]), 0.0)
            self._pieces = PieceMasses.of(first, self.domain)
        # Exponents below 1 converge without over-relaxation, which would break the invariant.
        self._relaxation = self.domain.relaxation if self.balanced else 1.0
        self._enter(start)

    def _enter(self, start: Potentials) -> None:
        """Load a state and its region."""
        self.region = start.region
        whole = isinstance(self.domain.weights, float)
        self.weights = self.domain.weights if whole else self.region.gather(self.domain.weights)
        self.log_v = start.log_v.copy()
        self.log_debias = start.log_debias.copy()
        self.density = np.empty(len(self.region))
        self._log_kw = np.empty_like(self.log_v)
        self._log_mu = np.empty(len(self.region))
        self._spare = np.empty(len(self.region))
        self._relevant = np.ones(len(self.region), bool)
        self._log_mass = self._log_mass_before = np.inf
        self.marginal_error = np.inf
        self.debias_error = np.inf if self.sharpness else 0.0
        self._debias_step: NDArray[np.float64] | None = None

    def step(self) -> None:
        """Do one round and measure how far the marginals disagree."""
        if self._debias_step is not None:
            self._update_debias()
        self._project_on_inputs()
        self._geometric_mean()
        self._normalize()
        before = self.marginal_error
        self.marginal_error = float(self.alphas @ [self._marginal_error(i) for i in range(len(self.alphas))])
        if self.marginal_error > _STALLED * before:
            self._relaxation = min(self._relaxation, 1.0)
        self._project_on_common()
        if not self.balanced:
            self._settle_constants()
        if self.sharpness:
            self._prepare_debias()

    def _project_on_inputs(self) -> None:
        """w_i = mu_i / H(a v_i): the plans get the inputs as one marginal."""
        here = [self.region] * len(self.alphas)
        log_kv = self._transfer(self.log_v, here, self._inputs)
        if not self.far and min(float(logs.min()) for logs in log_kv) <= LOG_NOTHING / 2:
            # Some mass of an input is too far from the barycenter for float64 scalings.
            if self.numerics == "scaling":
                raise KernelTooNarrowError(f"gamma = {self.domain.gamma:.3g} is too small for scalings of float64")
            self.far = True
            log_kv = self._transfer(self.log_v, here, self._inputs)
        exponent = self.fidelity.exponent
        log_w = [exponent * (log_mu - logs) for log_mu, logs in zip(self._log_mus, log_kv, strict=True)]
        for log_kw, logs in zip(self._log_kw, self._transfer(log_w, self._inputs, here), strict=True):
            log_kw[...] = logs

    def _geometric_mean(self) -> None:
        """Set ln mu = beta (s ln d + sum_i alpha_i ln H(a w_i)), or its unbalanced form, without normalizing it."""
        self.fidelity.log_mean(self._log_kw, self.alphas, self._log_mu)
        np.multiply(self.log_debias, self.sharpness / self.fidelity.exponent, out=self._spare)
        self._log_mu += self._spare
        self._balance()
        if self.entropy_limit is not None:
            self.exponent = sharpening_exponent(self._log_mu, self.entropy_limit, self.weights, self._pieces)
            self._relaxation = BOUNDED_STEP / self.exponent
            self._log_mu *= self.exponent
            self._balance()

    def _balance(self) -> None:
        """Set the mass of every connected component, where there are several."""
        if self._pieces is not None:
            self._log_mu[...] = self._pieces.balanced(self._log_mu, self.weights)

    def _normalize(self) -> None:
        """Compute the density, of mass 1, and remember the logarithm of the mass before normalizing."""
        shift = float(self._log_mu.max())
        np.subtract(self._log_mu, shift, out=self.density)
        np.exp(self.density, out=self.density)
        total = total_mass(self.density, self.weights)
        self.density /= total
        self._log_mass_before = self._log_mass if self.entropy_limit is not None else 0.0
        self._log_mass = shift + float(np.log(total))
        self._relevant = self._log_mu > self._log_mass - RELEVANT

    def _marginal_error(self, index: int) -> float:
        """Sum of a |v_i H(a w_i) - mu|; v_i H(a w_i) has the mass of mu_i in every round.

        The unbalanced form compares v_i^(1 / e) H(a w_i) divided by the mass.
        """
        np.divide(self.log_v[index], self.fidelity.exponent, out=self._spare)
        self._spare += self._log_kw[index]
        if not self.balanced:
            self._spare -= self._log_mass
        np.minimum(self._spare, 50.0, out=self._spare)
        np.exp(self._spare, out=self._spare)
        self._arrived[index] = total_mass(self._spare, self.weights)
        self._spare -= self.density
        np.abs(self._spare, out=self._spare)
        return total_mass(self._spare, self.weights)

    def _prepare_debias(self) -> None:
        """Measure the difference of d H(a d) from mu, and prepare the step of ln d that reduces it."""
        (step,) = self._transfer([self.log_debias], [self.region], [self.region])
        exponent = self.fidelity.exponent
        step += self.log_debias / exponent
        if not self.balanced:
            step -= self._log_mass
        np.exp(np.minimum(step, 50.0, out=self._spare), out=self._spare)
        self._spare -= self.density
        np.abs(self._spare, out=self._spare)
        self.debias_error = total_mass(self._spare, self.weights)
        np.subtract(self._log_mu, step, out=step)
        step -= self._log_mass
        step *= _DEBIAS_STEP * exponent
        if self._debias_step is not None:
            self._debias_step *= self._momentum
            step += self._debias_step
        step += self.log_debias
        np.clip(step, -_DEBIAS_RANGE, _DEBIAS_RANGE, out=step)
        np.copyto(step, -_DEBIAS_RANGE, where=~self._relevant)
        step -= self.log_debias
        self._debias_step = step

    def _update_debias(self) -> None:
        """Take the step that the last round prepared, in d and in v."""
        self.log_debias += self._debias_step
        np.multiply(self._debias_step, self.sharpness, out=self._spare)
        np.copyto(self._spare, 0.0, where=~self._relevant)
        self.log_v += self._spare

    def settle(self) -> None:
        """Take the step of d that the last round prepared, and update mu to match, which saves another round.

        With an entropy bound mu is left alone, because it is not the product that the step changes.
        """
        if self._debias_step is None or self.entropy_limit is not None:
            return
        # At the rim, where there is almost no mass, ln d may still be off by dozens. The errors do not show this, and
        # no later round would undo what a full step does there.
        np.clip(self._debias_step, -_LAST_STEP, _LAST_STEP, out=self._debias_step)
        np.multiply(self._debias_step, self.sharpness / self.fidelity.exponent, out=self._spare)
        self._log_mu += self._spare
        self._balance()
        self._normalize()
        self._update_debias()
        self._debias_step = None

    def _project_on_common(self) -> None:
        """v_i = mu / H(a w_i): the plans get one common marginal on the other side."""
        irrelevant = ~self._relevant
        for log_v, log_kw in zip(self.log_v, self._log_kw, strict=True):
            np.subtract(self._log_mu, log_kw, out=self._spare)
            if not self.balanced:
                self._spare *= self.fidelity.exponent
                np.copyto(self._spare, LOG_NOTHING, where=log_kw <= LOG_NOTHING / 2)
            if self.entropy_limit is not None:
                # Otherwise the exponent would raise a mass other than 1 to its power in every round.
                self._spare -= self._log_mass
            if self._relaxation == 1.0:
                log_v[...] = self._spare
            else:
                # Where there was no mass before there is no step to extrapolate.
                np.copyto(log_v, self._spare, where=log_v <= LOG_NOTHING / 2)
                log_v += self._relaxation * (self._spare - log_v)
            np.copyto(log_v, LOG_NOTHING, where=irrelevant)

    def _settle_constants(self) -> None:
        """Rescale every v_i by the constant that makes the arriving mass right.

        Multiplying v_i (and w_i with it) by c multiplies v_i^(1 / e) H(a w_i) by c^(1 / e - e). On their own the
        constants converge by a factor of e^2 per round, which is very slow for long reaches. Only half of the step is
        taken, because parts too far apart to exchange mass have constants of their own.
        """
        exponent = self.fidelity.exponent
        shifts = -0.5 * np.log(np.maximum(self._arrived, np.finfo(float).tiny)) / (1.0 / exponent - exponent)
        there = self._relevant & (self.log_v > LOG_NOTHING / 2)
        self.log_v += np.where(there, shifts[:, None], 0.0)
        off = self.fidelity.mean_of_scalings(self.log_v, self.alphas) - self.sharpness * self.log_debias
        self.log_v -= np.where(there, off, 0.0)

    def potentials(self) -> Potentials:
        """Return the state, to continue from or to prolong to a finer level.

        Moving a constant from one v_i to the others changes nothing. Here every ln v_i is given the same mean under mu,
        because such a constant would grow fourfold with every finer level.
        """
        if not self.balanced:
            return Potentials(self.region, np.maximum(self.log_v, LOG_NOTHING), self.log_debias)
        mass = self.density * self.weights
        means = np.array([float((log_v * mass).sum()) for log_v in self.log_v])
        for log_v, mean in zip(self.log_v, means, strict=True):
            log_v -= mean - float(self.alphas @ means)
        np.maximum(self.log_v, LOG_NOTHING, out=self.log_v)
        return Potentials(self.region, self.log_v, self.log_debias)

    def finer_region(self, tolerance: float, finer: Multiscale) -> Region:
        """Elements of the next finer domain that its barycenter needs: the support of the coarse one and a margin.

        Densities below a third of the tolerance, relative to the maximum, count as empty.
        """
        support = Region(self.region.scatter(self.density, 0.0) > _NEGLIGIBLE_SHARE * tolerance * self.density.max())
        return finer.refined(support, self.region)

    def rim_mass(self) -> float:
        """Mass of the region's elements that have neighbors outside it: an estimate of the mass cut off."""
        if self.region.is_whole:
            return 0.0
        rim = ~self.region.gather(self.region.interior)
        return total_mass(np.where(rim, self.density, 0.0), self.weights)

    def grow(self, cells: int) -> None:
        """Continue on a larger region."""
        self._enter(self.potentials().on(self.region.grown(cells)))

    @property
    def mass(self) -> float:
        """Mass of mu before normalizing."""
        return float(np.exp(min(self._log_mass, 700.0)))

    def mass_error(self) -> float:
        """Return |a^T mu - 1| before normalizing; with an entropy bound, the change of the mass in the last round.

        Without balance there is no mass that mu should have, and the error is 0.
        """
        if not self.balanced:
            return 0.0
        return float(abs(np.expm1(min(self._log_mass - self._log_mass_before, 700.0))))

    def invariant_error(self) -> float:
        """Largest |sum_i alpha_i ln v_i - s ln d - (1 - 1 / beta) ln mu| where mu is not negligible."""
        expected = self.sharpness * self.log_debias + (1.0 - 1.0 / self.exponent) * self._log_mu
        if self.entropy_limit is not None:
            expected -= self._log_mass
        residual = self.fidelity.mean_of_scalings(self.log_v, self.alphas) - expected
        if self._pieces is not None:
            # Every component has a constant of its own, which changes no plan.
            mass = self.density * self.weights
            means = self._pieces.sums(residual * mass) / np.maximum(self._pieces.sums(mass), np.finfo(float).tiny)
            residual -= means[self._pieces.labels]
        return float(np.abs(residual)[self.density > self.density.max() * 1e-12].max())

    def _transfer(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        transfer = self.domain.log_transfer_far if self.far else self.domain.log_transfer
        return transfer(columns, sources, targets)
