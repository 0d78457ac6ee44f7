# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Wasserstein propagation: distributions at some vertices of a graph spread to the others (Algorithm 4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import check_distribution, check_distributions, check_solver
from .domain import LOG_NOTHING, RELEVANT, Domain
from .graph import PropagationGraph
from .pieces import PieceMasses
from .relaxation import AdaptiveRelaxation
from .sharpening import BOUNDED_STEP, entropy, sharpening_exponent
from .sinkhorn import KernelInLogarithms, Monitor, log_density, marginal_errors


@dataclass(frozen=True)
class Propagation:
    """Distributions at all vertices of a graph.

    Attributes
    ----------
    densities : (m, *shape) float64
        One per vertex, mass 1; the given ones where they were given.
    iterations : int
        Sweeps over the graph of the part that took longest.
    marginal_errors : (m,) float64
        At every vertex the largest sum of a |s H(a s') - mu| over the plans that meet there.
    converged : (m,) bool
        Whether the part of the graph that the vertex belongs to has reached the tolerance.
    entropies : (m,) float64
        In nats.
    numerics : str
        "scaling" or the domain's far_numerics.
    log_scalings : (2 e, *shape) float64
        The scalings of both ends of every edge that is not between two fixed vertices; to start a similar solve from.
    """

    densities: NDArray[np.float64]
    iterations: int
    marginal_errors: NDArray[np.float64]
    converged: NDArray[np.bool_]
    entropies: NDArray[np.float64]
    numerics: str
    log_scalings: NDArray[np.float64]

    @property
    def marginal_error(self) -> float:
        """The largest error of all vertices."""
        return float(self.marginal_errors.max())


def propagate(
    edges: ArrayLike,
    edge_weights: ArrayLike | float,
    fixed: Mapping[int, ArrayLike],
    domain: Domain,
    *,
    size: int | None = None,
    entropy_limit: Literal["max"] | ArrayLike | None = None,
    initial: Propagation | None = None,
    tolerance: float = 1e-2,
    max_iterations: int = 500,
    monitor: Monitor | None = None,
) -> Propagation:
    """Spread distributions over a graph so that the weighted sum of squared distances along its edges is least.

    Eq. (17): min sum_e alpha_e W2^2(mu_v, mu_w), the mu of some vertices fixed.

    Parameters
    ----------
    edges : (e, 2)
        Pairs of vertices.
    edge_weights : (e,) or float
        Positive alpha of every edge, or of all.
    fixed : mapping from vertex to density
        The given distributions; each is normalized to mass 1.
    domain : Domain
        Owns the area weights and the heat kernel.
    size : int, optional
        Number of vertices; by default just enough for the edges and the fixed vertices.
    entropy_limit : None, "max", float or (size,)
        Upper bound of the entropies of the free vertices in nats (Algorithm 3); "max" takes the largest of the given
        distributions; an array holds one bound per vertex.
    initial : Propagation, optional
        A solution for the same graph and similar distributions, to start from.
    tolerance : float
        Largest marginal error at the end.
    max_iterations : int
        Largest number of sweeps.
    monitor : callable, optional
        ``monitor(elements, iteration, error)``, called once per sweep; what it raises ends the solve.

    Returns
    -------
    Propagation
        All distributions and how well they solve the problem.

    Raises
    ------
    ValueError
        A graph, distributions or parameters that make no sense; the message names the argument.
    KernelTooNarrowError
        gamma is too small for numerics of any kind to get from one distribution to another.

    Notes
    -----
    A line of many edges is not the interpolation of its ends by a barycenter: every edge adds the blur of one kernel,
    so that without an entropy limit long lines diffuse; :func:`bisect` does not.
    """
    graph = PropagationGraph.from_edges(edges, edge_weights, fixed.keys(), size)
    check_solver(tolerance, max_iterations)
    vertices = sorted(fixed)
    given = np.stack([check_distribution(fixed[v], domain, f"fixed[{v}]") for v in vertices])
    given = check_distributions(given, domain, "fixed")
    limits = _limits(entropy_limit, given, graph, domain)
    start = None if initial is None else initial.log_scalings
    if start is not None and start.shape != (len(graph.vertex_of_end), *domain.shape):
        raise ValueError("initial must be a solution for the same graph on the same domain")
    state = PropagationIteration(domain, graph, dict(zip(vertices, given, strict=True)), limits, start)
    for iteration in range(1, max_iterations + 1):
        state.sweep(tolerance)
        if monitor is not None:
            monitor(given[0].size, iteration, state.error)
        if state.error < tolerance:
            break
    return Propagation(
        densities=state.densities,
        iterations=iteration,
        marginal_errors=state.errors,
        converged=state.vertex_errors() < tolerance,
        entropies=np.array([entropy(mu, domain.weights) for mu in state.densities]),
        numerics=state.kernel.numerics,
        log_scalings=state.log_scalings,
    )


def _limits(
    entropy_limit: Literal["max"] | ArrayLike | None,
    given: NDArray[np.float64],
    graph: PropagationGraph,
    domain: Domain,
) -> NDArray[np.float64]:
    """One bound per vertex, infinite for none."""
    if entropy_limit is None:
        return np.full(graph.size, np.inf)
    if isinstance(entropy_limit, str):
        if entropy_limit != "max":
            raise ValueError(f'entropy_limit must be "max", a number, or one number per vertex, got {entropy_limit!r}')
        return np.full(graph.size, max(entropy(mu, domain.weights) for mu in given))
    limits = np.asarray(entropy_limit, dtype=np.float64)
    if limits.shape not in ((), (graph.size,)) or np.isnan(limits).any():
        raise ValueError(f"entropy_limit must be one number or {graph.size}, got shape {limits.shape}")
    return np.broadcast_to(limits, graph.size)


class PropagationIteration:
    """Sweeps over a graph, a color at a time; parts of the graph that have converged take no further part.

    The scalings of a free vertex satisfy prod_e s_e^(alpha_e / omega) = 1 after every update of Algorithm 4, so its
    distribution is prod_e H(a s'_e)^(alpha_e / omega) with s' at the other ends, and the new scalings are
    s_e = mu / H(a s'_e): nothing accumulates.

    Parameters
    ----------
    domain : Domain
        Where the distributions live.
    graph : PropagationGraph
        Its fixed vertices are those of `given`.
    given : dict from vertex to density of mass 1
        The fixed distributions.
    limits : (graph.size,) float64
        Entropy bounds of the free vertices, infinite for none.
    log_scalings : (2 e, *shape) float64, optional
        Where to start from; scalings of one otherwise.
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
        self.limits = limits
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

    @property
    def error(self) -> float:
        """The largest error of all vertices."""
        return float(self._part_errors.max(initial=0.0))

    def vertex_errors(self) -> NDArray[np.float64]:
        """Return the largest error of the part that every vertex belongs to; zero at fixed vertices."""
        if not len(self._part_errors):
            return np.zeros(self.graph.size)
        return np.where(self.graph.fixed, 0.0, self._part_errors[self.graph.parts])

    def sweep(self, tolerance: float) -> None:
        """Update the scalings at every vertex once, except in parts whose error is below `tolerance`."""
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
        """Update the scalings of the `ends` at every one of `vertices`, which no edge joins."""
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
                log_mu, share = self._log_given[vertex], 1.0
            else:
                log_mu, share = self._estimate(vertex, own, log_hs)
            errors = marginal_errors(
                self.log_scalings[own] + log_hs,
                np.broadcast_to(self.densities[vertex], log_hs.shape),
                self.domain.weights,
            )
            self.errors[vertex] = errors.max()
            np.maximum.at(found, self.graph.part_of_end[own], errors)
            factors = share * self._relaxation.factors[self.graph.part_of_end[own]]
            self._move(own, log_mu, log_mu - log_hs, factors)

    def _move(
        self,
        ends: NDArray[np.int64],
        log_mu: NDArray[np.float64],
        full: NDArray[np.float64],
        factors: NDArray[np.float64],
    ) -> None:
        """Move scalings toward `full` by the factor of each; all the way from where there was nothing."""
        before = self.log_scalings[ends]
        steps = factors.reshape(-1, *[1] * (full.ndim - 1)) * (full - before)
        moved = np.where(before <= LOG_NOTHING / 2, full, before + steps)
        self.log_scalings[ends] = np.where(log_mu > log_mu.max() - RELEVANT, moved, LOG_NOTHING)

    def _estimate(
        self, vertex: int, own: NDArray[np.int64], log_hs: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], float]:
        """Return ln mu at a free vertex, and the share of the step that its scalings may take."""
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
        # The exponent would raise a mass other than 1 to its power in every sweep.
        return log_mu - (top + np.log(mass)), BOUNDED_STEP / exponent
