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

# The debiasing density spans a few orders of magnitude where there is mass; elsewhere it does not matter, but its
# exponential must stay within float64, whose logarithms end at 709.
_DEBIAS_RANGE = 700.0
# Over-relaxation of v, which helps on grids, is given up once a round leaves more than this share of the error. A
# guard: where rounds converge as they should it never acts (docs/performance.md, "Constants of the barycenter").
_STALLED = 0.95
# Share of the step that d takes. Where the error of ln d varies slowly against the kernel, whole steps would overshoot;
# where it varies faster, each leaves 1 - (1 - s) of it. Between them this leaves least (the same table).
_DEBIAS_STEP = 0.9
# Share of its last step that ln d goes on by, as a heavy ball does, and how much less of it per lack of sharpness: the
# errors of sharper barycenters are slower. Measured for full sharpness, and for 0.75 (the same table).
_DEBIAS_MOMENTUM, _MOMENTUM_FALL = 0.6, 1.6
# The most that the last step, after which nothing is measured, changes ln d anywhere.
_LAST_STEP = float(np.log(2.0))
# Elements of a coarse barycenter below this share of the tolerance, relative to its maximum, have no counterpart on
# finer levels, beyond a margin (docs/performance.md, "Constants of the barycenter").
_NEGLIGIBLE_SHARE = 0.3


class BregmanIteration:
    """Iterates on one domain; every :meth:`step` is one round of Algorithm 2 (Solomon et al. 2015).

    With the paper's v_i, w_i and the debiasing density d of Janati et al. 2020 raised to the sharpness s, a round is

        w_i = mu_i / H(a v_i),    mu = (d^s prod_i H(a w_i)^alpha_i)^beta,
        v_i = mu / H(a w_i),      d' = d (mu / (d H(a d)))^0.9 (d / d_before)^m,    v_i' = v_i (d' / d)^s

    This is the paper's round with prod_i v_i^alpha_i = d^s built in, so that nothing accumulates: the state is right
    for its weights after one round from any start. Without the last step v would hold the d of the round before, and
    the delay would let errors of d ring. The momentum m (Polyak 1964) is for the slow errors of sharp barycenters. mu
    is normalized to mass 1 inside the round, because the root in d otherwise makes the total mass swing for a dozen
    rounds; v keeps the mass before that, which goes to 1.

    Where mass may vanish and grow, every update has an exponent: :class:`.fidelity.Unbalanced`.

    v_i, d and mu are kept on the region of the start, w_i where mu_i has mass: the rest of the domain costs nothing.

    Parameters
    ----------
    inputs : Level
        The distributions, of mass 1, and where they live.
    alphas : (k,) float64
        Positive weights of sum 1.
    sharpness : float
        s above.
    entropy_limit : float or None
        Bound for the entropy of mu, or none (beta = 1).
    start : Potentials
        Copied.
    numerics : "automatic" or "scaling"
        Whether to go on in the log domain where scalings of float64 do not reach, or to raise.
    reach : float or None
        How far mass goes before it rather fades, in lengths of the domain; with None all mass travels.
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
        first = inputs.regions[0].scatter(np.exp(inputs.log_mus[0]), 0.0) if self.domain.pieces is not None else None
        self._pieces = None if first is None else PieceMasses.of(first, self.domain)
        # Exponents below 1 converge by themselves, and steps beyond would leave the invariant.
        self._relaxation = self.domain.relaxation if self.balanced else 1.0
        self._enter(start)

    def _enter(self, start: Potentials) -> None:
        """Take up a state, and with it the region that it is on."""
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
        """Do one round and measure how far the marginals are from agreeing."""
        if self._debias_step is not None:
            self._update_debias()
        self._project_on_inputs()
        self._geometric_mean()
        self._normalize()
        before = self.marginal_error
        self.marginal_error = max(self._marginal_error(i) for i in range(len(self.alphas)))
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
            # Some of an input's mass is too far from the barycenter for scalings of float64.
            if self.numerics == "scaling":
                raise KernelTooNarrowError(f"gamma = {self.domain.gamma:.3g} is too small for scalings of float64")
            self.far = True
            log_kv = self._transfer(self.log_v, here, self._inputs)
        exponent = self.fidelity.exponent
        log_w = [exponent * (log_mu - logs) for log_mu, logs in zip(self._log_mus, log_kv, strict=True)]
        for log_kw, logs in zip(self._log_kw, self._transfer(log_w, self._inputs, here), strict=True):
            log_kw[...] = logs

    def _geometric_mean(self) -> None:
        """Take ln mu = beta (s ln d + sum_i alpha_i ln H(a w_i)), or its unbalanced form, not yet normalized."""
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
        """Give every connected piece its mass, where there are several."""
        if self._pieces is not None and self.balanced:
            self._log_mu[...] = self._pieces.balanced(self._log_mu, self.weights)

    def _normalize(self) -> None:
        """Fill the density, of mass 1; remember the logarithm of the mass before."""
        shift = float(self._log_mu.max())
        np.subtract(self._log_mu, shift, out=self.density)
        np.exp(self.density, out=self.density)
        total = total_mass(self.density, self.weights)
        self.density /= total
        self._log_mass_before = self._log_mass if self.entropy_limit is not None else 0.0
        self._log_mass = shift + float(np.log(total))
        self._relevant = self._log_mu > self._log_mass - RELEVANT

    def _marginal_error(self, index: int) -> float:
        """Sum of a |v_i H(a w_i) - mu|; the mass of v_i H(a w_i) is that of mu_i in every round.

        Unbalanced it is v_i^(1 / e) H(a w_i), per mass.
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
        """Measure how far d H(a d) is from mu, and prepare the step of ln d towards it."""
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
        """Take the step that the last round prepared, v with d."""
        self.log_debias += self._debias_step
        np.multiply(self._debias_step, self.sharpness, out=self._spare)
        np.copyto(self._spare, 0.0, where=~self._relevant)
        self.log_v += self._spare

    def settle(self) -> None:
        """Take the step of d that the last round prepared, and mu with it: another round less to go.

        Under a bound of the entropy mu is not the product that this changes.
        """
        if self._debias_step is None or self.entropy_limit is not None:
            return
        # Where next to nothing lies, at the rim, ln d may still be off by dozens: no error has that in it, but the step
        # would make something of it, and no round comes to take it back.
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
                # The exponent would raise a mass other than 1 to its power in every round.
                self._spare -= self._log_mass
            if self._relaxation == 1.0:
                log_v[...] = self._spare
            else:
                # Where there was nothing before there is nothing to step beyond.
                np.copyto(log_v, self._spare, where=log_v <= LOG_NOTHING / 2)
                log_v += self._relaxation * (self._spare - log_v)
            np.copyto(log_v, LOG_NOTHING, where=irrelevant)

    def _settle_constants(self) -> None:
        """Multiply every v_i by the constant for which as much arrives as should.

        With v_i times c, and w_i with it, v_i^(1 / e) H(a w_i) is c^(1 / e - e) times what it was. Left to themselves
        the constants would go there by a factor of e^2 in a round, which for long reaches is next to nothing. Half of
        the way, because what lies too far apart to exchange mass has constants of its own.
        """
        exponent = self.fidelity.exponent
        shifts = -0.5 * np.log(np.maximum(self._arrived, np.finfo(float).tiny)) / (1.0 / exponent - exponent)
        there = self._relevant & (self.log_v > LOG_NOTHING / 2)
        self.log_v += np.where(there, shifts[:, None], 0.0)
        off = self.fidelity.mean_of_scalings(self.log_v, self.alphas) - self.sharpness * self.log_debias
        self.log_v -= np.where(there, off, 0.0)

    def potentials(self) -> Potentials:
        """Return the state, to continue from or to prolong.

        A constant may move from one v_i to the others without changing anything; here every ln v_i has the same mean
        under mu, because a constant would grow fourfold with every finer level.
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
        """Elements of the next finer domain that its barycenter needs: the coarse one's support, with a margin.

        What lies below a third of the tolerance, relative to the maximum, counts as empty.
        """
        support = Region(self.region.scatter(self.density, 0.0) > _NEGLIGIBLE_SHARE * tolerance * self.density.max())
        return finer.refined(support, self.region)

    def rim_mass(self) -> float:
        """Mass at the elements of a grid's region that have neighbors outside it: what the region may have cut off."""
        if self.region.is_whole:
            return 0.0
        rim = ~self.region.gather(self.region.interior)
        return total_mass(np.where(rim, self.density, 0.0), self.weights)

    def grow(self, cells: int) -> None:
        """Go on with a larger region."""
        self._enter(self.potentials().on(self.region.grown(cells)))

    @property
    def error(self) -> float:
        """The larger of the marginal error and the error of d: a stale d holds mu back while the marginals agree.

        The error of d is that before the step which :meth:`settle` takes. Twice as much would do after a near start;
        what a far one leaves in d is of the size of cells, and shows as teeth on creases.
        """
        return max(self.marginal_error, self.debias_error)

    @property
    def mass(self) -> float:
        """Mass of mu before normalizing."""
        return float(np.exp(min(self._log_mass, 700.0)))

    def mass_error(self) -> float:
        """Return |a^T mu - 1| before normalizing; with an entropy bound, how far the mass moved in the last round.

        Unbalanced there is no mass that mu should have, and the error is 0.
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
        if self._pieces is not None and self.balanced:
            # Every piece has a constant of its own, which changes no plan.
            mass = self.density * self.weights
            means = self._pieces.sums(residual * mass) / np.maximum(self._pieces.sums(mass), np.finfo(float).tiny)
            residual -= means[self._pieces.labels]
        return float(np.abs(residual)[self.density > self.density.max() * 1e-12].max())

    def _transfer(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        transfer = self.domain.log_transfer_far if self.far else self.domain.log_transfer
        return transfer(columns, sources, targets)
