# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solve single blends and compute their level fields: for shapes at rest, for moving shapes, and on a coarse grid."""

from __future__ import annotations

import functools
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...geometry.grids.grid_resampling import resampled
from ...geometry.level_sets.isosurface import level_enclosing, surface_enclosing
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control
from ..morphs.blend_solver import ALONE, BlendSolver, SolvedBlend
from ..morphs.extraction import LevelDensity, estimated_level_density, level_density
from ..morphs.layouts import Blend
from ..morphs.morph_problem import MorphProblem
from ..morphs.morph_settings import MorphSettings
from ..morphs.moved_blend import MovedBlend
from ..morphs.moving_problem import MovingProblem
from ..morphs.origins import blend_origins, part_transports
from ..morphs.transport_problem import TransportProblem
from ..morphs.volumes import Lattice
from .color_fields import ColorField, centers_of, places_about
from .level_fields import OUTSIDE, FieldBox, LevelField
from .shape_colors import ShapeColors

# Margin in cells around shapes for their blends: the distance that blurs reach.
_MARGIN = 3
# Number of solved blends kept as starts for others: enough for the boundary of the filled region.
_KEPT = 8


class FieldSource(Protocol):
    """Computes level fields of blends on the common grid."""

    def field(self, weights: Sequence[float], control: Control = UNINTERRUPTED) -> LevelField:
        """Solve the blend with these weights, which sum to 1."""
        ...


def box_of_shapes(shapes: Sequence[TriangleMesh], lattice: Lattice) -> FieldBox:
    """Return the cells of a lattice that hold all blends of shapes at rest."""
    boxes = [box_of_blend(shapes, lattice, weights) for weights in np.eye(len(shapes))]
    return functools.reduce(FieldBox.union, boxes)


def box_of_blend(shapes: Sequence[TriangleMesh], lattice: Lattice, weights: Sequence[float]) -> FieldBox:
    """Return the cells of a lattice that hold the blend of shapes at rest with these weights, (k,).

    A barycenter lies within the weighted mean of the bounds of its shapes, each relative to its center.
    """
    about = [shape.bounds - center for shape, center in zip(shapes, lattice.centers, strict=True)]
    low, high = (np.tensordot(weights, about, 1) - lattice.origin) / lattice.spacing
    begin, end = np.floor(low).astype(np.int64) - _MARGIN, np.ceil(high).astype(np.int64) + _MARGIN
    return FieldBox.between(np.maximum(begin, 0), np.minimum(end, lattice.shape))


def estimated_field_bytes(shapes: Sequence[TriangleMesh], lattice: Lattice, blends: Sequence[Sequence[float]]) -> float:
    """Estimate the mean memory in bytes of the level fields of blends of shapes at rest, given by their weights.

    Blurs may reach a little beyond :func:`box_of_blend`: within 15 % (tests/applications/live/test_live_blends.py).
    """
    return float(np.mean([box_of_blend(shapes, lattice, weights).field_bytes for weights in blends]))


@dataclass(frozen=True)
class TransportBlend:
    """A blend of shapes at rest.

    Attributes
    ----------
    blend : Blend
        Its weights.
    level : LevelDensity
        Its density.
    solved : SolvedBlend or None
        The solution, from which origins are computed; None for an unblended shape.
    """

    blend: Blend
    level: LevelDensity
    solved: SolvedBlend | None

    def origins(self, points: NDArray[np.float64], transport: TransportProblem) -> NDArray[np.floating]:
        """Return the origins of the matter at points, (n, 3) in cells, on every shape, (k, n, 3) in scene space."""
        lattice = transport.lattice
        if self.solved is None:
            return points * lattice.spacing + (lattice.origin + lattice.centers)[:, None]
        return blend_origins(points, part_transports(self.solved, transport), lattice, self.blend.weights)


class TransportSource:
    """Blends by transport alone, each started from the nearest recent one.

    Parameters
    ----------
    problem : MorphProblem
        The shapes; their connectivity is not used.
    box : FieldBox
        Box of the fields.
    control : Control
        Cancels a solve.
    read : callable
        Finds the level of a density: :func:`.extraction.level_density` or :func:`.extraction.estimated_level_density`.
    colors : sequence of ShapeColors
        One per shape, or none.
    """

    def __init__(
        self,
        problem: MorphProblem,
        box: FieldBox,
        control: Control = UNINTERRUPTED,
        read: Callable[[NDArray[np.floating], float, MorphSettings], LevelDensity] = level_density,
        colors: Sequence[ShapeColors] = (),
    ) -> None:
        self._problem, self._box, self._read, self._colors = problem, box, read, tuple(colors)
        self._cold = BlendSolver(problem.transport, control)
        self._warm: deque[tuple[NDArray[np.float64], BlendSolver]] = deque(maxlen=_KEPT)

    def field(self, weights: Sequence[float], control: Control = UNINTERRUPTED) -> LevelField:
        """Solve the blend with these weights; an unblended shape is represented by its occupancy."""
        control.check()
        found = self.blended(weights)
        field = LevelField.of(found.level.density, found.level.low, found.level.level, found.level.volume, self._box)
        transport = self._problem.transport
        return _colored(field, weights, self._colors, lambda points: found.origins(points, transport))

    def blended(self, weights: Sequence[float]) -> TransportBlend:
        """Solve a blend."""
        transport, blend = self._problem.transport, Blend(tuple(float(weight) for weight in weights))
        if blend.source is not None:
            occupancy = transport.occupancy(blend.source)
            level = self._read(occupancy, float(occupancy.sum()), self._problem.settings)
            return TransportBlend(blend, level, None)
        weights = np.array(blend.weights)
        solver = self._nearest(weights).branched()
        solved = solver.solve(blend, transport.blend_volumes(blend))
        self._warm.append((weights, solver))
        merged = solved.merged()
        return TransportBlend(blend, self._read(merged.density, merged.volume, self._problem.settings), solved)

    def _nearest(self, weights: NDArray[np.float64]) -> BlendSolver:
        """Return the solver whose last blend is nearest, among those with weight on the same shapes."""
        active = weights > 0
        known = [(np.abs(own - weights).sum(), solver) for own, solver in self._warm if np.array_equal(own > 0, active)]
        return min(known, key=lambda one: one[0])[1] if known else self._cold


class MovingSource:
    """Blends of shapes that move towards each other.

    Parameters
    ----------
    problem : MovingProblem
        The shapes and their motion.
    colors : sequence of ShapeColors
        One per shape, or none.
    """

    def __init__(self, problem: MovingProblem, colors: Sequence[ShapeColors] = ()) -> None:
        self._problem, self._colors = problem, tuple(colors)
        self.box = FieldBox(self._first_cell(problem.lattice) + 1, tuple(n - 2 for n in problem.lattice.shape))

    def field(self, weights: Sequence[float], control: Control = UNINTERRUPTED) -> LevelField:
        """Move the shapes, and transport the remaining difference."""
        blend = Blend(tuple(float(weight) for weight in weights))
        moved = self._problem.moved_blend(blend, control)
        found = self._density(moved, control)
        low = found.low + self._first_cell(moved.problem.lattice)
        field = LevelField.of(found.density, low, found.level, found.volume, self.box)
        if not self._colors:
            return field
        colors = [self._colors[index].moved(shape) for index, shape in zip(moved.active, moved.shapes, strict=True)]
        still = self._problem.still.lattice
        place = still.origin + np.array(blend.weights) @ still.centers
        return _colored(
            field, moved.blend.weights, colors, lambda points: [points * still.spacing + place] * len(colors)
        )

    def _first_cell(self, lattice: Lattice) -> NDArray[np.int64]:
        """Return the first cell of a lattice, in cells of the lattice of the shapes at rest, (3,)."""
        still = self._problem.still.lattice
        return np.rint((lattice.origin - still.origin) / still.spacing).astype(np.int64)

    def _density(self, moved: MovedBlend, control: Control) -> LevelDensity:
        if moved.coincides:
            volume = moved.volume + moved.solids.surplus
            surface = surface_enclosing(moved.solids.density, volume)
            return LevelDensity(moved.solids.density, np.zeros(3, np.int64), surface.level, volume)
        transport = moved.problem.transport
        volumes = transport.blend_volumes(moved.blend)
        merged = BlendSolver(transport, control, ALONE).solve(moved.blend, volumes).merged()
        return level_density(merged.density, merged.volume, self._problem.still.settings, moved.solids)


class StandInSource:
    """Blends on a coarser grid, resampled to a finer one, as substitutes until the latter are solved.

    Parameters
    ----------
    problem : MorphProblem
        The shapes on the coarser grid.
    lattice : Lattice
        The finer grid.
    box : FieldBox
        Box of the fields.
    colors : sequence of ShapeColors
        One per shape, or none.
    """

    def __init__(
        self, problem: MorphProblem, lattice: Lattice, box: FieldBox, colors: Sequence[ShapeColors] = ()
    ) -> None:
        self._coarse = TransportSource(problem, box, read=estimated_level_density)
        self._lattice, self._box, self._colors, self._transport = lattice, box, tuple(colors), problem.transport
        self._own = problem.lattice

    def field(self, weights: Sequence[float], control: Control = UNINTERRUPTED) -> LevelField:
        """Solve the blend with these weights on the coarser grid."""
        control.check()
        blended = self._coarse.blended(weights)
        found = blended.level
        ratio = self._lattice.spacing / self._own.spacing
        first = self._first_center(found.low)
        density, volume = resampled(found.density, first, ratio, self._box.shape), found.volume / ratio**3
        # Interpolation lowers the density of convex parts, by several percent of the volume at the coarse level.
        level = level_enclosing(density, volume)
        field = LevelField.of_values(density / np.float32(level) + np.float32(OUTSIDE), volume, self._box)
        return _colored(
            field, weights, self._colors, lambda points: blended.origins(self._in_own_cells(points), self._transport)
        )

    def _first_center(self, low: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the position of the box's first cell center in samples of a coarse density, (3,)."""
        return self._in_own_cells(self._box.low + 0.5) - 0.5 - low

    def _in_own_cells(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert points from cells of the finer lattice to cells of the coarser one."""
        return (points * self._lattice.spacing + self._lattice.origin - self._own.origin) / self._own.spacing


def _colored(
    field: LevelField,
    weights: Sequence[float],
    colors: Sequence[ShapeColors],
    origins: Callable[[NDArray[np.float64]], Sequence[NDArray[np.floating]]],
) -> LevelField:
    """Return a field with the colors of its blend, if shapes have any.

    Parameters
    ----------
    field : LevelField
        The field, without colors.
    weights : sequence of float
        Weights of the blend, (k,).
    colors : sequence of ShapeColors
        One per shape, or none.
    origins : callable
        Returns the origins on each shape, (k, n, 3), for points, (n, 3) in cells of the common grid.
    """
    if not colors:
        return field
    places = places_about(field.reach, field.box.low)
    shares = zip(weights, colors, origins(centers_of(places)), strict=True)
    mean = sum(weight * own.near(points) for weight, own, points in shares if weight > 0.0)
    return replace(field, colors=ColorField(places, mean.astype(np.float16)))
