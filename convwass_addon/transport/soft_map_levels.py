# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft maps between two surfaces, from coarse meshes to fine ones, in one direction or in both together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..geometry.coarsening import Coarsening, coarsened
from ..progress import UNINTERRUPTED, Control
from .checks import check_solver
from .soft_map import GAMMA_PER_SQUARED_EDGE, SoftMap, soft_map_domain
from .soft_map_problem import SoftMapProblem, SourceEdges, check_pairs
from .surface import Surface

# The coarse meshes have this share of the vertices: a map between them takes a thirtieth of the time, since a
# sweep is a product of matrices (0.3^3 = 1/37), and is as right (docs/performance.md, "Soft maps").
_SHARE = 0.3
# Between smaller meshes maps are solved as fast as coarser ones are made. Chosen by eye: a sweep grows with the cube of
# the vertices.
_FEWEST_VERTICES = 250
# What one direction is told of the other reaches down to exp(-20) of the largest density.
_DEPTH = np.float32(20.0)


@dataclass(frozen=True)
class SymmetricSoftMap:
    """Both directions, which agree as far as they were asked to.

    Attributes
    ----------
    forward : SoftMap
        From the source to the target.
    backward : SoftMap
        From the target to the source.
    """

    forward: SoftMap
    backward: SoftMap


@dataclass(frozen=True)
class SoftMapSweeps:
    """How a soft map between two surfaces is solved.

    Attributes
    ----------
    tau : float
        Weight of the compatibility. 10 to 100 give nearly the same.
    sharpness : float
        0 for the paper's map, where every edge adds the blur of a kernel; 1 for the debiased one.
    gamma_scale : float
        gamma over the squared mean edge length of the mesh that is mapped to.
    coarse : int
        Largest number of sweeps between coarse meshes, on every level of them. The coarsest take as many more, and so
        do the given meshes where there are no coarser ones.
    fine : int
        Largest number of sweeps between the given meshes. More only make the distributions sharper.
    tolerance : float
        Mean mass moved by a sweep, below which a level ends.
    """

    tau: float = 30.0
    sharpness: float = 1.0
    gamma_scale: float = GAMMA_PER_SQUARED_EDGE
    coarse: int = 24
    fine: int = 2
    tolerance: float = 1e-2


def soft_map_between(
    compatibility: ArrayLike,
    source: Surface,
    target: Surface,
    *,
    pairs: ArrayLike = (),
    sweeps: SoftMapSweeps | None = None,
    control: Control = UNINTERRUPTED,
) -> SoftMap:
    """Find the soft map from one surface to another; see :func:`.soft_map.soft_map`, whose sweeps this saves.

    Parameters
    ----------
    compatibility : (n0, n1)
        c(x, y), any numbers: small where the source at x looks like the target at y.
    source, target : Surface
        Their kernels do not matter.
    pairs : (k, 2) int
        A vertex of the source and one of the target that belong together.
    sweeps : SoftMapSweeps, optional
        How.
    control : Control
        Ends the solve when cancelled.

    Returns
    -------
    SoftMap

    Raises
    ------
    ValueError
        Arrays that do not fit together, or parameters that make no sense; the message names the argument.
    """
    way = _Way.of(compatibility, source, target, pairs)
    sweeps = sweeps or SoftMapSweeps()
    return _solved([way], sweeps, sweeps.fine, 0.0, control)[0]


def symmetric_soft_map(
    compatibility: ArrayLike,
    source: Surface,
    target: Surface,
    *,
    pairs: ArrayLike = (),
    agreement: float = 0.25,
    sweeps: SoftMapSweeps | None = None,
    control: Control = UNINTERRUPTED,
) -> SymmetricSoftMap:
    """Find the soft maps of both directions together.

    Every distribution is drawn to what the other direction says of its vertex, as if by one more edge.

    Parameters
    ----------
    compatibility, source, target, pairs, sweeps, control
        As in :func:`soft_map_between`.
    agreement : float
        The share that the other direction has in every distribution, at least 0 and below 1.

    Returns
    -------
    SymmetricSoftMap

    Raises
    ------
    ValueError
        As :func:`soft_map_between`.
    """
    if not 0.0 <= agreement < 1.0:
        raise ValueError(f"agreement must be at least 0 and below 1, got {agreement}")
    way = _Way.of(compatibility, source, target, pairs)
    # A vertex without area can be mapped, but nothing can be mapped to it.
    pairs_back = way.pairs[source.weights[way.pairs[:, 0]] > 0][:, ::-1]
    back = _Way(target, source, np.ascontiguousarray(way.costs.T), pairs_back)
    sweeps = sweeps or SoftMapSweeps()
    return SymmetricSoftMap(*_solved([way, back], sweeps, sweeps.fine, agreement, control))


@dataclass(frozen=True)
class _Way:
    """One direction on one level."""

    source: Surface
    target: Surface
    costs: NDArray[np.float32]
    pairs: NDArray[np.int64]

    @classmethod
    def of(cls, compatibility: ArrayLike, source: Surface, target: Surface, pairs: ArrayLike) -> _Way:
        costs = np.asarray(compatibility, dtype=np.float32)
        if costs.shape != (*source.shape, *target.shape):
            raise ValueError(f"compatibility must have the shape {(*source.shape, *target.shape)}, got {costs.shape}")
        return cls(source, target, costs, check_pairs(pairs, len(source.weights), target.weights))

    def problem(self, sweeps: SoftMapSweeps) -> SoftMapProblem:
        graph = SourceEdges.of(self.source.laplacian)
        return SoftMapProblem.of(
            self.costs,
            graph.edges,
            graph.weights,
            self.source.weights,
            soft_map_domain(self.target, sweeps.gamma_scale),
            pairs=self.pairs,
            fixed=None,
            tau=sweeps.tau,
            sharpness=sweeps.sharpness,
        )


@dataclass(frozen=True)
class _CoarseSide:
    """A coarser mesh of one surface."""

    coarsening: Coarsening
    fine: Surface
    surface: Surface

    @classmethod
    def of(cls, surface: Surface) -> _CoarseSide | None:
        used = np.count_nonzero(surface.weights)
        if used < _FEWEST_VERTICES:
            return None
        coarsening = coarsened(surface.mesh, surface.laplacian.areas, round(_SHARE * used))
        if coarsening is None:
            return None
        try:
            return cls(coarsening, surface, Surface(coarsening.mesh.vertices, coarsening.mesh.faces))
        except InputError:
            # Nothing but needles is left.
            return None

    def means(self, rows: NDArray[np.float32]) -> NDArray[np.float64]:
        """Return the means over every cluster of vertices, (k, c), of values at the vertices, (k, n)."""
        masses = self.coarsening.sums(self.fine.weights[None])
        return self.coarsening.sums(rows * self.fine.weights) / masses


def _solved(
    ways: Sequence[_Way], sweeps: SoftMapSweeps, count: int, agreement: float, control: Control
) -> list[SoftMap]:
    """Solve in `count` sweeps, after coarser meshes where there are any."""
    for number in (sweeps.coarse, count):
        check_solver(sweeps.tolerance, number, "sweeps")
    sides = [_CoarseSide.of(surface) for surface in (ways[0].source, ways[0].target)]
    if None in sides:
        return _swept(ways, [None] * len(ways), sweeps, sweeps.coarse + count, agreement, control)
    ends = list(zip(sides, sides[::-1], strict=True))[: len(ways)]
    coarse = [_coarse_way(way, *two) for way, two in zip(ways, ends, strict=True)]
    maps = _solved(coarse, sweeps, sweeps.coarse, agreement, control)
    starts = [_prolonged(found.densities, *two) for found, two in zip(maps, ends, strict=True)]
    counts = (*maps[0].coarse_iterations, maps[0].iterations)
    return _swept(ways, starts, sweeps, count, agreement, control, counts)


def _coarse_way(way: _Way, source: _CoarseSide, target: _CoarseSide) -> _Way:
    places = [side.coarsening.clusters[column] for side, column in zip((source, target), way.pairs.T, strict=True)]
    pairs = np.stack(places, axis=1)
    costs = source.means(target.means(way.costs).T).T
    return _Way(source.surface, target.surface, costs.astype(np.float32), pairs[(pairs >= 0).all(axis=1)])


def _prolonged(densities: NDArray[np.float32], source: _CoarseSide, target: _CoarseSide) -> NDArray[np.float32]:
    across = (target.coarsening.prolongation @ densities.T).T
    return np.asarray(source.coarsening.prolongation @ across, dtype=np.float32)


def _swept(
    ways: Sequence[_Way],
    starts: Sequence[NDArray[np.float32] | None],
    sweeps: SoftMapSweeps,
    count: int,
    agreement: float,
    control: Control,
    coarse_iterations: tuple[int, ...] = (),
) -> list[SoftMap]:
    """Solve one level, all directions in turn."""
    problems = [way.problem(sweeps) for way in ways]
    iterations = [problem.iteration(start) for problem, start in zip(problems, starts, strict=True)]
    changes: list[list[float]] = []
    while len(changes) < count and not (changes and max(changes[-1]) < sweeps.tolerance):
        moved = []
        for index, (problem, iteration) in enumerate(zip(problems, iterations, strict=True)):
            # Where nothing was there to start from, the first sweep of all has no other direction to agree with.
            if agreement and (changes or index or starts[0] is not None):
                other = problems[1 - index].whole(iterations[1 - index].densities)
                iteration.attract(_log_depth(other.T[np.ix_(problem.sources, problem.targets)]), agreement)
            moved.append(iteration.sweep())
        changes.append(moved)
        control.check()
    found = []
    for problem, iteration, moved in zip(problems, iterations, np.array(changes).T, strict=True):
        densities, areas = problem.whole(iteration.densities), problem.domain.weights
        converged = bool(moved[-1] < sweeps.tolerance)
        found.append(SoftMap(densities, areas, moved, converged, coarse_iterations))
    return found


def _log_depth(densities: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the logarithms of rows over their largest value, down to a floor; all the same in rows of nothing."""
    top = np.maximum(densities.max(axis=1, keepdims=True), np.float32(1e-20))
    logs = np.log(np.maximum(densities / top, np.exp(-_DEPTH)))
    return np.ascontiguousarray(logs, np.float32)
