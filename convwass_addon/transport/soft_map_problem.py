# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The optimization problem of a soft map, eq. (18), validated and prepared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..geometry.meshes.laplacian import Laplacian
from .checks import check_distribution, check_sharpness
from .dense_kernel import dense_kernel
from .graph import PropagationGraph, checked_edge_weights
from .soft_map_sweeps import SoftMapIteration, SweepOrder
from .surface import Surface

# A pair fixes its source vertex to a blurred point of its target: the kernel of this fraction of gamma, in this many
# steps.
_SHARE_OF_GAMMA_IN_A_POINT, _STEPS_OF_A_POINT = 1.0 / 10.0, 5
# Lower limit of edge weights: with the small weights next to obtuse angles, neighbors would drift apart.
_LEAST_WEIGHT = 0.05


@dataclass(frozen=True)
class SourceEdges:
    """The graph of a source.

    Attributes
    ----------
    edges : (e, 2) int64
        Pairs of vertices.
    weights : (e,) float64
        Cost of a difference between the distributions of each pair.
    """

    edges: NDArray[np.int64]
    weights: NDArray[np.float64]

    @classmethod
    def of(cls, laplacian: Laplacian) -> SourceEdges:
        """Return the edges of a Laplacian with their cotangent weights, which do not depend on the resolution."""
        entries = laplacian.matrix.tocoo()
        rows, columns = entries.coords
        once = rows < columns
        weights = np.maximum(-entries.data[once], _LEAST_WEIGHT)
        return cls(np.stack([rows[once], columns[once]], axis=1).astype(np.int64), weights)


@dataclass(frozen=True)
class SoftMapProblem:
    """Eq. (18), restricted to source vertices that have edges and target vertices that have area.

    Attributes
    ----------
    domain : Surface
        The target.
    size : int
        Number of all vertices of the source.
    sources, targets : (n0,), (n1,) int64
        The vertices of the problem.
    order : SweepOrder
        The graph of these sources.
    log_prior : (n0, n1) float32
        The compatibility as it is added to the logarithms of the densities.
    given : dict from vertex of the source to (all targets,) float64
        Fixed densities, of mass 1.
    sharpness : float
        As in :func:`soft_map`.
    """

    domain: Surface
    size: int
    sources: NDArray[np.int64]
    targets: NDArray[np.int64]
    order: SweepOrder
    log_prior: NDArray[np.float32]
    given: dict[int, NDArray[np.float64]]
    sharpness: float

    @classmethod
    def of(
        cls,
        compatibility: ArrayLike,
        edges: ArrayLike,
        edge_weights: ArrayLike | float,
        source_areas: ArrayLike,
        domain: Surface,
        *,
        pairs: ArrayLike,
        fixed: Mapping[int, ArrayLike] | None,
        tau: float,
        sharpness: float,
    ) -> SoftMapProblem:
        """Validate and convert the arguments of :func:`soft_map`.

        Raises
        ------
        ValueError
            As for :func:`soft_map`.
        """
        costs = np.asarray(compatibility, dtype=np.float32)
        areas = _areas(source_areas)
        size = len(areas)
        if costs.shape != (size, *domain.shape):
            raise ValueError(f"compatibility must have the shape {(size, *domain.shape)}, got {costs.shape}")
        if not np.isfinite(costs).all():
            raise ValueError("compatibility has values that are not numbers")
        if not (np.isfinite(tau) and tau >= 0):
            raise ValueError(f"tau must be zero or a positive number, got {tau}")
        check_sharpness(sharpness)
        ends, weights = _edges(edges, edge_weights, size)
        sources, ends = np.unique(ends, return_inverse=True)
        graph = PropagationGraph(len(sources), ends.ravel(), np.repeat(weights, 2), np.zeros(len(sources), bool))
        targets = np.flatnonzero(domain.weights > 0)
        factors = tau * areas[sources] / (domain.gamma * np.maximum(graph.total_weights, 1e-300))
        costs = costs[np.ix_(sources, targets)]
        costs -= costs.min(axis=1, keepdims=True, initial=np.inf)
        return cls(
            domain=domain,
            size=size,
            sources=sources,
            targets=targets,
            order=SweepOrder.of(graph),
            log_prior=costs * -factors[:, None].astype(np.float32),
            given=_given_densities(pairs, fixed or {}, size, domain),
            sharpness=sharpness,
        )

    def iteration(self, initial: ArrayLike | None) -> SoftMapIteration:
        """Return the iteration that solves this, started from densities `initial`, (size, all targets), if given."""
        place = {int(source): index for index, source in enumerate(self.sources)}
        iteration = SoftMapIteration(
            self.order,
            dense_kernel(self.domain),
            self.domain.weights[self.targets].astype(np.float32),
            self.log_prior,
            {place[v]: density[self.targets] for v, density in self.given.items() if v in place},
            self.sharpness,
        )
        if initial is not None:
            iteration.start(self.part(initial))
        return iteration

    def whole(self, densities: NDArray[np.float32]) -> NDArray[np.float32]:
        """Expand densities of the problem's vertices, (n0, n1), to (size, all targets)."""
        found = np.zeros((self.size, len(self.domain.weights)), np.float32)
        found[:, self.targets] = 1.0
        for vertex, density in self.given.items():
            found[vertex] = density
        found[np.ix_(self.sources, self.targets)] = densities
        return found

    def part(self, initial: ArrayLike) -> NDArray[np.float32]:
        """Return the rows and columns of densities, (size, all targets), that belong to the problem, each of mass 1.

        Raises
        ------
        ValueError
            A wrong shape, negative values or rows without mass.
        """
        shape = (self.size, len(self.domain.weights))
        densities = np.asarray(initial, dtype=np.float32)
        if densities.shape != shape:
            raise ValueError(f"initial must have the shape {shape}, got {densities.shape}")
        part = densities[np.ix_(self.sources, self.targets)]
        masses = part @ self.domain.weights[self.targets].astype(np.float32)
        if not (np.isfinite(part).all() and (part >= 0).all() and (masses > 0).all()):
            raise ValueError("initial must hold densities: numbers that are not negative, with some mass in every row")
        return part / masses[:, None]


def _areas(source_areas: ArrayLike) -> NDArray[np.float64]:
    """Area weights of sum 1."""
    areas = np.asarray(source_areas, dtype=np.float64)
    if areas.ndim != 1 or not np.isfinite(areas).all() or (areas < 0).any() or not areas.sum() > 0:
        raise ValueError("source_areas must be one number for each vertex, not negative, and not all zero")
    return areas / areas.sum()


def _edges(
    edges: ArrayLike, edge_weights: ArrayLike | float, size: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Validate edges and weights."""
    pairs = np.asarray(edges)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or pairs.dtype.kind not in "iu" or not len(pairs):
        raise ValueError(f"edges must be pairs of vertices, (e, 2), got {pairs.dtype} of shape {pairs.shape}")
    if pairs.min() < 0 or pairs.max() >= size:
        raise ValueError(f"edges must name vertices between 0 and {size - 1}")
    if (pairs[:, 0] == pairs[:, 1]).any():
        raise ValueError("edges must not run from a vertex to itself")
    return pairs.astype(np.int64), checked_edge_weights(edge_weights, len(pairs))


def check_pairs(pairs: ArrayLike, size: int, areas: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return validated pairs of a source and a target vertex, (k, 2).

    Parameters
    ----------
    pairs : (k, 2)
        The pairs.
    size : int
        Number of vertices of the source.
    areas : (n1,)
        Area weights of the target.

    Raises
    ------
    ValueError
        A wrong shape, vertices out of range, or vertices of the target without area.
    """
    known = np.asarray(pairs if np.size(pairs) else np.empty((0, 2), int))
    if known.ndim != 2 or known.shape[1] != 2 or known.dtype.kind not in "iu":
        raise ValueError(f"pairs must hold two vertices each, (k, 2), got {known.dtype} of shape {known.shape}")
    for column, count, side in ((known[:, 0], size, "source"), (known[:, 1], len(areas), "target")):
        if column.min(initial=0) < 0 or column.max(initial=0) >= count:
            raise ValueError(f"pairs must name vertices of the {side} between 0 and {count - 1}")
    empty = known[areas[known[:, 1]] == 0, 1]
    if len(empty):
        raise ValueError(f"pairs must name vertices of the target with some area; vertex {empty[0]} has none")
    return known.astype(np.int64)


def _given_densities(
    pairs: ArrayLike, fixed: Mapping[int, ArrayLike], size: int, domain: Surface
) -> dict[int, NDArray[np.float64]]:
    """Return the densities of all source vertices for which they are given."""
    sources, targets = check_pairs(pairs, size, domain.weights).T
    if min(fixed, default=0) < 0 or max(fixed, default=0) >= size:
        raise ValueError(f"fixed must name vertices of the source between 0 and {size - 1}")
    given = {int(vertex): check_distribution(density, domain, f"fixed[{vertex}]") for vertex, density in fixed.items()}
    if not len(sources):
        return given
    points = np.zeros((len(targets), len(domain.weights)))
    points[np.arange(len(targets)), targets] = 1.0 / domain.weights[targets]
    blurred = domain.with_kernel(_SHARE_OF_GAMMA_IN_A_POINT * domain.gamma, _STEPS_OF_A_POINT).apply(points)
    for source in np.unique(sources):
        if int(source) in given:
            raise ValueError(f"pairs and fixed must not both name vertex {source} of the source")
        shared = blurred[sources == source].mean(axis=0)
        given[int(source)] = check_distribution(shared, domain, f"the pairs of vertex {source}")
    return given
