# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The iteration of Wasserstein propagation (Algorithm 4) on one domain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .domain import Domain, Multiscale
from .graph import PropagationGraph
from .log_range import LOG_NOTHING, RELEVANT
from .pieces import PieceMasses
from .region import Region
from .relaxation import AdaptiveRelaxation
from .sharpening import BOUNDED_STEP, sharpening_exponent
from .sinkhorn import KernelInLogarithms, log_density, marginal_errors

# Factor by which the momentum's eigenvalue range is wider than the exponent. With a smaller one, densities with two
# peaks do not converge (docs/performance, "Meshes").
_RANGE = 2.0


class PropagationIteration:
    """Sweeps over a graph, one color at a time; components that have converged are skipped.

    The scalings of a free vertex satisfy prod_e s_e^(alpha_e / omega) = 1 after every update of Algorithm 4. Its
    distribution is therefore prod_e H(a s'_e)^(alpha_e / omega), with s' at the other ends, and the new scalings are
    s_e = mu / H(a s'_e), so that no error accumulates.

    Parameters
    ----------
    domain : Domain
        The domain of the distributions.
    graph : PropagationGraph
        Its fixed vertices are those of `given`.
    given : dict from vertex to density of mass 1
        The fixed distributions.
    limits : (graph.size,) float64
        Entropy bounds of the free vertices, infinite for none.
    log_scalings : (2 e, *shape) float64, optional
        The start; by default scalings of one.
    """

    def __init__(
        self,
        domain: Domain,
        graph: PropagationGraph,
        given: dict[int, NDArray[np.float64]],
        limits: NDArray[np.float64],
        log_scalings: NDArray[np.float64] | None = None,
    ) -> None:
        self.domain = domain
        self.graph = graph
        self.limits = limits.copy()
        self.kernel = KernelInLogarithms(domain)
        self.densities = np.ones((graph.size, *domain.shape))
        for vertex, density in given.items():
            self.densities[vertex] = density
        self._pieces = PieceMasses.of(next(iter(given.values())), domain)
        self._log_given = {vertex: log_density(density) for vertex, density in given.items()}
        ends = len(graph.vertex_of_end)
        self.log_scalings = np.zeros((ends, *domain.shape)) if log_scalings is None else log_scalings.copy()
        self.errors = np.where(graph.fixed, 0.0, np.inf)
        self._part_errors = np.full(graph.parts.max(initial=-1) + 1, np.inf)
        self._relaxation = AdaptiveRelaxation(len(self._part_errors))
        self._earlier_means: dict[int, NDArray[np.float64]] = {}

    @property
    def error(self) -> float:
        """The largest error over all vertices."""
        return float(self._part_errors.max(initial=0.0))

    def vertex_errors(self) -> NDArray[np.float64]:
        """Return for every vertex the largest error in its component; zero at fixed vertices."""
        if not len(self._part_errors):
            return np.zeros(self.graph.size)
        return np.where(self.graph.fixed, 0.0, self._part_errors[self.graph.parts])

    def relieve(self, amount: float, tolerance: float) -> None:
        """Raise the bounds in components whose error is not below `tolerance`."""
        self.limits[self.vertex_errors() >= tolerance] += amount
        self._earlier_means.clear()

    def lifted(self, domain: Multiscale) -> NDArray[np.float64]:
        """Prolong the scalings at free vertices to `domain`, whose coarser domain is this one, as a start.

        Scalings at free vertices are smooth; the first sweep computes those at fixed vertices from them. The physical
        potential is gamma ln s, so ln s grows as gamma falls.
        """
        free = ~self.graph.fixed[self.graph.vertex_of_end]
        finer = domain.prolong(self.log_scalings[free], Region.whole(domain.shape)).reshape(-1, *domain.shape)
        lifted = np.full((len(free), *domain.shape), LOG_NOTHING)
        lifted[free] = np.maximum(domain.fall_of_gamma * finer, LOG_NOTHING)
        return lifted

    def sweep(self, tolerance: float) -> None:
        """Update the scalings at every vertex once, except in components whose error is below `tolerance`."""
        live = ~(self._part_errors < tolerance)
        found = np.zeros_like(self._part_errors)
        for color in self.graph.colors:
            ends = [self.graph.ends_at[vertex] for vertex in color]
            ends = [e[live[self.graph.part_of_end[e]]] for e in ends]
            if sum(map(len, ends)):
                self._update(color, ends, found)
        self._part_errors[live] = found[live]
        self._relaxation.learn(found, live)

    def _update(self, vertices: NDArray[np.int64], ends: list[NDArray[np.int64]], found: NDArray[np.float64]) -> None:
        """Update the scalings of the `ends` at each of `vertices`, no two of which share an edge."""
        every = np.concatenate(ends)
        is_given = self.graph.fixed[self.graph.vertex_of_end[every]]
        needed = is_given.reshape(-1, *[1] * len(self.domain.shape)) & (
            self.densities[self.graph.vertex_of_end[every]] > 0
        )
        across = self.kernel.apply(self.log_scalings[every ^ 1], needed)
        start = 0
        for vertex, own in zip(vertices, ends, strict=True):
            if not len(own):
                continue
            log_hs = across[start : start + len(own)]
            start += len(own)
            if self.graph.fixed[vertex]:
                log_mu, exponent = self._log_given[vertex], 1.0
            else:
                log_mu, exponent = self._estimate(vertex, own, log_hs)
            errors = marginal_errors(
                self.log_scalings[own] + log_hs,
                np.broadcast_to(self.densities[vertex], log_hs.shape),
                self.domain.weights,
            )
            # At fixed vertices, a start from a coarser domain is empty: the error is then unknown, not large.
            known = ~(self.log_scalings[own] <= LOG_NOTHING / 2).reshape(len(own), -1).all(axis=1)
            errors *= known
            self.errors[vertex] = errors.max()
            np.maximum.at(found, self.graph.part_of_end[own], errors)
            self._move(vertex, own, log_mu, log_mu - log_hs, exponent)

    def _move(
        self,
        vertex: int,
        ends: NDArray[np.int64],
        log_mu: NDArray[np.float64],
        full: NDArray[np.float64],
        exponent: float,
    ) -> None:
        """Move the scalings of the `ends` at a vertex towards `full`."""
        is_bounded = not self.graph.fixed[vertex] and np.isfinite(self.limits[vertex])
        if is_bounded and self.domain.has_fast_propagation:
            self._move_with_momentum(vertex, ends, log_mu, full, exponent)
            return
        share = BOUNDED_STEP / exponent if is_bounded else 1.0
        self._move_by_factors(ends, log_mu, full, share * self._relaxation.factors[self.graph.part_of_end[ends]])

    def _move_by_factors(
        self,
        ends: NDArray[np.int64],
        log_mu: NDArray[np.float64],
        full: NDArray[np.float64],
        factors: NDArray[np.float64],
    ) -> None:
        """Move scalings towards `full` by their factors, and all the way where they were empty."""
        before = self.log_scalings[ends]
        steps = factors.reshape(-1, *[1] * (full.ndim - 1)) * (full - before)
        moved = np.where(before <= LOG_NOTHING / 2, full, before + steps)
        self.log_scalings[ends] = np.where(log_mu > log_mu.max() - RELEVANT, moved, LOG_NOTHING)

    def _move_with_momentum(
        self,
        vertex: int,
        ends: NDArray[np.int64],
        log_mu: NDArray[np.float64],
        full: NDArray[np.float64],
        exponent: float,
    ) -> None:
        """Update the mean of the scalings' logarithms with momentum and the deviations from it in full.

        Only the mean, which converges to (1 - 1 / beta) ln mu, depends on the exponent beta. A full step multiplies
        every Fourier mode of its error by -1 where the mode is short compared with the kernel and by -beta where it is
        long, or by up to twice that where several peaks share the mass. For eigenvalues between 1 and b this is the
        fastest step with momentum (Polyak 1964): the error falls by (sqrt(b) - 1) / (sqrt(b) + 1) per sweep.
        """
        root = np.sqrt(_RANGE * exponent)
        step, momentum = (2.0 / (root + 1.0)) ** 2, ((root - 1.0) / (root + 1.0)) ** 2
        before = self.log_scalings[ends]
        weights = self.graph.weight_of_end[ends] / self.graph.weight_of_end[ends].sum()
        mean_before, mean = np.tensordot(weights, before, 1), np.tensordot(weights, full, 1)
        earlier = self._earlier_means.get(vertex, mean_before)
        self._earlier_means[vertex] = mean_before
        change = step * (mean - mean_before)
        change += momentum * np.where(earlier > LOG_NOTHING / 2, mean_before - earlier, 0.0)
        moved = np.where((before <= LOG_NOTHING / 2).any(axis=0), full, full - mean + mean_before + change)
        self.log_scalings[ends] = np.where(log_mu > log_mu.max() - RELEVANT, moved, LOG_NOTHING)

    def _estimate(
        self, vertex: int, own: NDArray[np.int64], log_hs: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], float]:
        """Return ln mu at a free vertex, and the exponent that keeps its entropy below the bound."""
        weights = self.graph.weight_of_end[own]
        log_mu = np.tensordot(weights / weights.sum(), log_hs, 1)
        exponent = 1.0
        if self._pieces is not None:
            log_mu = self._pieces.balanced(log_mu, self.domain.weights)
        if np.isfinite(self.limits[vertex]):
            exponent = sharpening_exponent(log_mu, self.limits[vertex], self.domain.weights, self._pieces)
            log_mu *= exponent
            if self._pieces is not None:
                log_mu = self._pieces.balanced(log_mu, self.domain.weights)
        top = float(log_mu.max())
        density = np.exp(log_mu - top)
        mass = float((density * self.domain.weights).sum())
        self.densities[vertex] = density / mass
        if not np.isfinite(self.limits[vertex]):
            return log_mu, 1.0
        # Otherwise the exponent would raise a mass other than 1 to its power in every sweep.
        return log_mu - (top + np.log(mass)), exponent
