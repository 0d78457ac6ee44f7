# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse-to-fine solution of soft maps between two surfaces, in one direction or in both together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from ..errors import InputError
from ..geometry.meshes.mirror_planes import MirrorPlanes
from ..geometry.remeshing.coarsening import Coarsening, coarsened
from ..progress import UNINTERRUPTED, Control
from .checks import check_solver
from .soft_map import GAMMA_PER_SQUARED_EDGE, SoftMap, soft_map_domain
from .soft_map_problem import SoftMapProblem, SourceEdges, check_pairs
from .surface import Surface

# Fraction of the vertices that the coarse meshes keep. A map between them takes a thirtieth of the time, since a sweep
# is a matrix product (0.3^3 = 1/37), and is as accurate (docs/performance, "Soft maps").
_SHARE = 0.3
# Coarsening smaller meshes takes as long as solving on them. Chosen by eye: a sweep's cost grows with the cube of the
# vertices.
_FEWEST_VERTICES = 250
# Densities below exp(-20) of the largest are equal when one direction is compared with the other.
_DEPTH = np.float32(20.0)
# Weight of the mirrored map in every distribution (docs/performance, "Left and right").
_MIRRORED = 0.5


@dataclass(frozen=True)
class SymmetricSoftMap:
    """The maps of both directions, which agree to the extent requested.

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
    """Parameters for solving a soft map between two surfaces.

    Attributes
    ----------
    tau : float
        Weight of the compatibility. 10 to 100 give nearly the same.
    sharpness : float
        0 for the paper's map, to which every edge adds the blur of a kernel; 1 for the debiased one.
    gamma_scale : float
        gamma over the squared mean edge length of the target mesh.
    coarse : int
        Largest number of sweeps on every coarse level. The coarsest level adds this to its own limit, and so do the
        given meshes if there are no coarser ones.
    fine : int
        Largest number of sweeps between the given meshes. More mainly make the distributions sharper.
    tolerance : float
        A level ends when the mean mass moved by a sweep is below this.
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
    mirrors: MirrorPlanes | None = None,
    sweeps: SoftMapSweeps | None = None,
    control: Control = UNINTERRUPTED,
) -> SoftMap:
    """Find the soft map between two surfaces from coarse to fine, which needs fewer sweeps than `soft_map`.

    Parameters
    ----------
    compatibility : (n0, n1)
        c(x, y), any finite numbers: small where the source at x looks like the target at y.
    source, target : Surface
        Their kernels are ignored.
    pairs : (k, 2) int
        Corresponding vertices of the source and the target.
    mirrors : (MirrorPlane, MirrorPlane), optional
        Planes in which the source and the target are nearly symmetric. Every distribution is attracted to the mirror
        image of the one at the mirrored vertex, as if by one more edge, so that the map keeps left and right.
    sweeps : SoftMapSweeps, optional
        Parameters of the solve.
    control : Control
        Ends the solve when cancelled.

    Returns
    -------
    SoftMap

    Raises
    ------
    ValueError
        Shapes that do not match or invalid parameters; the message names the argument.
    """
    if mirrors is not None and len(mirrors) != 2:
        raise ValueError(f"mirrors must be the two planes of the source and the target, got {len(mirrors)}")
    direction = replace(_Direction.of(compatibility, source, target, pairs), mirrors=mirrors)
    sweeps = sweeps or SoftMapSweeps()
    return _solved([direction], sweeps, sweeps.fine, 0.0, control)[0]


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

    Every distribution is attracted to what the other direction says about its vertex, as if by one more edge.

    Parameters
    ----------
    compatibility, source, target, pairs, sweeps, control
        As in :func:`soft_map_between`.
    agreement : float
        The weight of the other direction in every distribution, at least 0 and below 1.

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
    direction = _Direction.of(compatibility, source, target, pairs)
    # A vertex without area can be mapped, but cannot be a target.
    pairs_back = direction.pairs[source.weights[direction.pairs[:, 0]] > 0][:, ::-1]
    back = _Direction(target, source, np.ascontiguousarray(direction.costs.T), pairs_back)
    sweeps = sweeps or SoftMapSweeps()
    return SymmetricSoftMap(*_solved([direction, back], sweeps, sweeps.fine, agreement, control))


@dataclass(frozen=True)
class _Direction:
    """One direction on one level."""

    source: Surface
    target: Surface
    costs: NDArray[np.float32]
    pairs: NDArray[np.int64]
    mirrors: MirrorPlanes | None = None

    @classmethod
    def of(cls, compatibility: ArrayLike, source: Surface, target: Surface, pairs: ArrayLike) -> _Direction:
        costs = np.asarray(compatibility, dtype=np.float32)
        if costs.shape != (*source.shape, *target.shape):
            raise ValueError(f"compatibility must have the shape {(*source.shape, *target.shape)}, got {costs.shape}")
        return cls(source, target, costs, check_pairs(pairs, len(source.weights), target.weights))

    @cached_property
    def _images(self) -> list[NDArray[np.int64]]:
        """The vertices of the source and of the target nearest to the mirror images of all, (n0,) and (n1,)."""
        return [
            cKDTree(surface.mesh.vertices).query(plane.mirrored(surface.mesh.vertices))[1]
            for surface, plane in zip((self.source, self.target), self.mirrors, strict=True)
        ]

    def mirrored(self, densities: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return what densities, (n0, n1), are in the mirror: at mirrored vertices, and mirrored."""
        return densities[np.ix_(*self._images)]

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
            # Only degenerate triangles are left.
            return None

    def means(self, rows: NDArray[np.float32]) -> NDArray[np.float64]:
        """Return the means over every cluster, (k, c), of values at the vertices, (k, n)."""
        masses = self.coarsening.sums(self.fine.weights[None])
        return self.coarsening.sums(rows * self.fine.weights) / masses


def _solved(
    directions: Sequence[_Direction], sweeps: SoftMapSweeps, count: int, agreement: float, control: Control
) -> list[SoftMap]:
    """Solve in `count` sweeps, after solving on coarser meshes if there are any."""
    for number in (sweeps.coarse, count):
        check_solver(sweeps.tolerance, number, "sweeps")
    sides = [_CoarseSide.of(surface) for surface in (directions[0].source, directions[0].target)]
    if None in sides:
        return _run_sweeps(directions, [None] * len(directions), sweeps, sweeps.coarse + count, agreement, control)
    ends = list(zip(sides, sides[::-1], strict=True))[: len(directions)]
    coarse = [_coarse_direction(direction, *two) for direction, two in zip(directions, ends, strict=True)]
    maps = _solved(coarse, sweeps, sweeps.coarse, agreement, control)
    starts = [_prolonged(found.densities, *two) for found, two in zip(maps, ends, strict=True)]
    counts = (*maps[0].coarse_iterations, maps[0].iterations)
    return _run_sweeps(directions, starts, sweeps, count, agreement, control, counts)


def _coarse_direction(direction: _Direction, source: _CoarseSide, target: _CoarseSide) -> _Direction:
    places = [
        side.coarsening.clusters[column] for side, column in zip((source, target), direction.pairs.T, strict=True)
    ]
    pairs = np.stack(places, axis=1)
    costs = source.means(target.means(direction.costs).T).T
    pairs = pairs[(pairs >= 0).all(axis=1)]
    return _Direction(source.surface, target.surface, costs.astype(np.float32), pairs, direction.mirrors)


def _prolonged(densities: NDArray[np.float32], source: _CoarseSide, target: _CoarseSide) -> NDArray[np.float32]:
    across = (target.coarsening.prolongation @ densities.T).T
    return np.asarray(source.coarsening.prolongation @ across, dtype=np.float32)


def _run_sweeps(
    directions: Sequence[_Direction],
    starts: Sequence[NDArray[np.float32] | None],
    sweeps: SoftMapSweeps,
    count: int,
    agreement: float,
    control: Control,
    coarse_iterations: tuple[int, ...] = (),
) -> list[SoftMap]:
    """Solve one level, alternating between the directions."""
    problems = [direction.problem(sweeps) for direction in directions]
    iterations = [problem.iteration(start) for problem, start in zip(problems, starts, strict=True)]
    changes: list[list[float]] = []
    while len(changes) < count and not (changes and max(changes[-1]) < sweeps.tolerance):
        moved = []
        for index, (problem, iteration) in enumerate(zip(problems, iterations, strict=True)):
            # Without a start, the very first sweep has no other direction to agree with, and nothing to mirror.
            if agreement and (changes or index or starts[0] is not None):
                other = problems[1 - index].whole(iterations[1 - index].densities)
                iteration.attract(_log_depth(other.T[np.ix_(problem.sources, problem.targets)]), agreement)
            elif directions[index].mirrors is not None and (changes or starts[0] is not None):
                other = directions[index].mirrored(problem.whole(iteration.densities))
                iteration.attract(_log_depth(other[np.ix_(problem.sources, problem.targets)]), _MIRRORED)
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
    """Return the logarithms of rows over their maximum, with a floor; constant for rows without mass."""
    top = np.maximum(densities.max(axis=1, keepdims=True), np.float32(1e-20))
    logs = np.log(np.maximum(densities / top, np.exp(-_DEPTH)))
    return np.ascontiguousarray(logs, np.float32)
