# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Wasserstein propagation: distributions at some vertices of a graph spread to the others (Algorithm 4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..one_line import one_line
from ..progress import UNINTERRUPTED, Control, Work, drained, within
from .checks import check_distribution, check_distributions, check_solver
from .domain import Domain
from .graph import PropagationGraph
from .propagation_sweeps import PropagationIteration
from .rounds import COARSE_SHARE, RoundReports
from .sharpening import entropy

# Sweeps after which bounds are raised, where that is allowed. On meshes, converging solves take ten to thirty sweeps
# and 57 in the worst case seen (docs/performance, "Meshes").
_PATIENCE = 60


@dataclass(frozen=True)
class Propagation:
    """Distributions at all vertices of a graph.

    Attributes
    ----------
    densities : (m, *shape) float64
        One per vertex, mass 1; given densities are returned unchanged.
    iterations : int
        Sweeps over the slowest component of the graph, on the domain itself.
    coarse_iterations : tuple of int
        The same on coarser domains, coarse to fine, if any were used.
    marginal_errors : (m,) float64
        At every vertex, the largest sum of a |s H(a s') - mu| over the plans that meet there.
    converged : (m,) bool
        Whether the vertex's component of the graph reached the tolerance.
    entropies : (m,) float64
        In nats.
    entropy_limits : (m,) float64
        The bounds in nats, infinite for none; with `relief`, the final ones.
    numerics : str
        "scaling" or the domain's far_numerics.
    log_scalings : (2 e, *shape) float64
        The scalings of both ends of every edge, except those between two fixed vertices; the start for a similar solve.
    areas : float or (*shape) float64
        The area weights of the domain, of sum 1.
    """

    densities: NDArray[np.float64]
    iterations: int
    coarse_iterations: tuple[int, ...]
    marginal_errors: NDArray[np.float64]
    converged: NDArray[np.bool_]
    entropies: NDArray[np.float64]
    entropy_limits: NDArray[np.float64]
    numerics: str
    log_scalings: NDArray[np.float64]
    areas: float | NDArray[np.float64]

    __repr__ = one_line("densities", "iterations", "marginal_error", "numerics")

    @property
    def masses(self) -> NDArray[np.float64]:
        """The distributions as histograms, (m, *shape), each of sum 1."""
        return self.densities * self.areas

    @property
    def marginal_error(self) -> float:
        """The largest error over all vertices."""
        return float(self.marginal_errors.max())


def propagate(
    edges: ArrayLike,
    edge_weights: ArrayLike | float,
    fixed: Mapping[int, ArrayLike],
    domain: Domain,
    *,
    size: int | None = None,
    entropy_limit: Literal["max"] | ArrayLike | None = None,
    relief: float = 0.0,
    initial: Propagation | None = None,
    tolerance: float = 1e-2,
    max_iterations: int = 500,
    control: Control = UNINTERRUPTED,
) -> Propagation:
    """Propagate distributions over a graph, minimizing the weighted sum of squared distances along its edges.

    Eq. (17): min sum_e alpha_e W2^2(mu_v, mu_w), with the mu of some vertices fixed.

    Parameters
    ----------
    edges : (e, 2)
        Pairs of vertices.
    edge_weights : (e,) or float
        Positive alpha of every edge, or one for all.
    fixed : mapping from vertex to density
        The given distributions; each is normalized to mass 1.
    domain : Domain
        Owns the area weights and the heat kernel.
    size : int, optional
        Number of vertices; by default just enough for the edges and the fixed vertices.
    entropy_limit : None, "max", float or (size,)
        Upper bound on the entropies of the free vertices in nats (Algorithm 3); "max" takes the largest entropy of the
        given distributions; an array holds one bound per vertex.
    relief : float
        Nats by which the bounds are raised, once, in components of the graph that have not converged after 60 sweeps: a
        tight bound may oscillate between two solutions. Components that have not converged 60 sweeps later are left.
    initial : Propagation, optional
        A solution for the same graph and similar distributions, to start from. Without one, domains with fast
        propagation start from coarser ones.
    tolerance : float
        Largest marginal error at the end.
    max_iterations : int
        Largest number of sweeps on every level.
    control : Control
        Ends the solve when cancelled.

    Returns
    -------
    Propagation
        All distributions and how well they solve the problem.

    Raises
    ------
    ValueError
        An invalid graph, distributions or parameters; the message names the argument.
    KernelTooNarrowError
        gamma is too small for any of the numerics to reach from one distribution to another.

    Notes
    -----
    A path of many edges is not the same as interpolating its ends by barycenters: every edge adds the blur of one
    kernel, so long paths diffuse unless the entropy is bounded. :func:`bisect` does not diffuse.
    """
    return drained(
        propagation(
            edges,
            edge_weights,
            fixed,
            domain,
            size=size,
            entropy_limit=entropy_limit,
            relief=relief,
            initial=initial,
            tolerance=tolerance,
            max_iterations=max_iterations,
            control=control,
        )
    )


def propagation(
    edges: ArrayLike,
    edge_weights: ArrayLike | float,
    fixed: Mapping[int, ArrayLike],
    domain: Domain,
    *,
    size: int | None = None,
    entropy_limit: Literal["max"] | ArrayLike | None = None,
    relief: float = 0.0,
    initial: Propagation | None = None,
    tolerance: float = 1e-2,
    max_iterations: int = 500,
    control: Control = UNINTERRUPTED,
) -> Work[Propagation]:
    """Like :func:`propagate`, but yields progress after every sweep; parameters and errors are the same.

    Yields
    ------
    Progress
        After every sweep, also on coarser domains; the payload is a :class:`.rounds.Round`.

    Returns
    -------
    Propagation
    """
    graph = PropagationGraph.from_edges(edges, edge_weights, fixed.keys(), size)
    check_solver(tolerance, max_iterations)
    vertices = sorted(fixed)
    given = np.stack([check_distribution(fixed[v], domain, f"fixed[{v}]") for v in vertices])
    given = check_distributions(given, domain, "fixed")
    limits = _limits(entropy_limit, given, graph, domain)
    if not (np.isfinite(relief) and relief >= 0):
        raise ValueError(f"relief must be zero or a positive number, got {relief}")
    start = None if initial is None else initial.log_scalings
    if start is not None and start.shape != (len(graph.vertex_of_end), *domain.shape):
        raise ValueError("initial must be a solution for the same graph on the same domain")
    problem = _Problem(graph, vertices, relief, tolerance, max_iterations, control)
    state, counts = yield from problem.solved(domain, given, limits, start)
    return Propagation(
        densities=state.densities,
        iterations=counts[-1],
        coarse_iterations=tuple(counts[:-1]),
        marginal_errors=state.errors,
        converged=state.vertex_errors() < tolerance,
        entropies=np.array([entropy(mu, domain.weights) for mu in state.densities]),
        entropy_limits=state.limits,
        numerics=state.kernel.numerics,
        log_scalings=state.log_scalings,
        areas=domain.weights,
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


@dataclass(frozen=True)
class _Problem:
    """The parameters that all levels share."""

    graph: PropagationGraph
    vertices: list[int]
    relief: float
    tolerance: float
    max_iterations: int
    control: Control

    def solved(
        self,
        domain: Domain,
        given: NDArray[np.float64],
        limits: NDArray[np.float64],
        start: NDArray[np.float64] | None,
    ) -> Work[tuple[PropagationIteration, tuple[int, ...]]]:
        """Solve, starting from coarser domains where useful; return the state and the sweeps on every level."""
        counts: tuple[int, ...] = ()
        begin = 0.0
        if start is None and domain.has_fast_propagation and (coarser := domain.coarser()) is not None:
            solving = self.solved(coarser, domain.restrict(given), limits, None)
            coarse, counts = yield from within(solving, 0.0, COARSE_SHARE)
            begin = COARSE_SHARE
            start = coarse.lifted(domain)
            limits = coarse.limits
        state = PropagationIteration(domain, self.graph, dict(zip(self.vertices, given, strict=True)), limits, start)
        iterations = yield from within(self._sweep(state), begin, 1.0)
        return state, (*counts, iterations)

    def _sweep(self, state: PropagationIteration) -> Work[int]:
        """Sweep until the marginals agree, and return the number of sweeps."""
        reports = RoundReports(int(np.prod(state.domain.shape)), self.tolerance)
        sweeps = min(self.max_iterations, 2 * _PATIENCE) if self.relief else self.max_iterations
        for iteration in range(1, sweeps + 1):
            state.sweep(self.tolerance)
            self.control.check()
            yield reports.after(iteration, state.error)
            if state.error < self.tolerance:
                break
            if self.relief and iteration == _PATIENCE:
                state.relieve(self.relief, self.tolerance)
        return iteration
