# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morphs whose inputs move towards each other: each blend transports only the remaining difference."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays.bounds import common_bounds
from ...geometry.level_sets.connectivity import Connectivity
from ...geometry.meshes.closest_points import ClosestPoints
from ...geometry.meshes.facing_points import FacingShape
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.thin_spans import ThinSpans
from ...progress import UNINTERRUPTED, Control
from ..motions.growing_motion import GrowingMotion
from ..motions.motion import Motion, MovedShape, unmoved
from ..motions.standing_motion import standing_motion
from ..workers import side_by_side
from .blend_solver import ALONE, BlendSolver
from .blend_store import BlendStore
from .blending import HandOver, solve_blends, surfaced_frame
from .coinciding_solids import CoincidingSolids
from .demands import Demand
from .detail import Starts, detailed_blend, reliability_of, starts_on_readings
from .extraction import extract_coinciding
from .interpolated_volumes import interpolated_volumes
from .layouts import Blend, pairs_of
from .morph_problem import MorphFrame, MorphProblem
from .moved_blend import MovedBlend
from .moved_origins import moved_origins, moved_tangents
from .moved_room import Room, room_of_moved
from .part_labels import Matching
from .parts import SplitShapes, joined, voxelized_parts
from .spare_threads import at_once
from .thickened_parts import WIDTH
from .transport_problem import TransportProblem
from .volumes import Lattice

Made = TypeVar("Made", covariant=True)

# Number of blends at which the extent of moved shapes is measured for the common grid.
_SAMPLED_BLENDS = 5
# The moved shapes of these blends are kept with at most this many bytes of vertices.
_MOST_SAMPLED = 1 << 25
# Parts of inputs that are at most so many times as wide at rest as the thinnest that the grid shows may become too thin
# for it: a large ear that becomes a small one.
_AT_REST = 2.0


@dataclass(frozen=True)
class MovingProblem:
    """The problem shared by all blends of moving inputs; see :class:`.BlendProblem`.

    Attributes
    ----------
    still : MorphProblem
        The inputs at rest: blends get their volumes and connectivity.
    motion : Motion
        The inputs' positions in every blend.
    lattice : Lattice
        The grid of `still`, enlarged for the moved inputs at a sample of blends. Every blend takes the cells that it
        needs.
    names : tuple of str
        Names of the inputs, for messages.
    matching : Matching
        The triangles that travel together.
    kept : BlendStore of MovedBlend, or None
        Where moved blends are kept, to compute them again under a demand.
    sampled : BlendStore of list of MovedShape, or None
        Where the moved inputs of some blends are kept.
    spans : sequence of ThinSpans
        Across the parts of every input that the grid may not show; empty if blends carry no detail, which makes
        thickened parts as thin as they are.
    """

    still: MorphProblem
    motion: Motion
    lattice: Lattice
    names: tuple[str, ...]
    matching: Matching
    kept: BlendStore[MovedBlend] | None = field(default=None, kw_only=True)
    sampled: BlendStore[list[MovedShape | None]] | None = field(default=None, kw_only=True)
    spans: Sequence[ThinSpans] = field(default=(), kw_only=True)

    @classmethod
    def of(
        cls,
        still: MorphProblem,
        motion: Motion,
        blends: Sequence[Blend],
        names: Sequence[str],
        matching: Matching,
        control: Control,
        pairs: Sequence[tuple[int, int]] | None = None,
    ) -> MovingProblem:
        """Lay out a grid that holds the moved inputs.

        Parameters
        ----------
        still : MorphProblem
            The inputs at rest, with their connectivity.
        motion : Motion
            The motion, which interpolates lengths. Blends are scaled if volumes are to be interpolated instead, see
            :class:`.growing_motion.GrowingMotion`, and kept on the floor if the settings say so, see
            :func:`.standing_motion.standing_motion`.
        blends : sequence of Blend
            All blends of the morph, including those computed elsewhere.
        names, matching
            As for the attributes.
        control : Control
            Stops the work.
        pairs : sequence of (int, int), optional
            Pairs of inputs that the motion suits, as for :func:`.morph.morph`; they determine the floor.
        """
        if still.settings.growth == "volume":
            motion = GrowingMotion(motion, still.transport.volumes, still.lattice.centers)
        if still.settings.on_floor:
            motion = standing_motion(motion, len(names), pairs_of(blends) if pairs is None else pairs)

        sampled: BlendStore[list[MovedShape | None]] = BlendStore(_MOST_SAMPLED)

        def bounds(weights: Sequence[float]) -> list[NDArray[np.float64]]:
            moved = motion.moved(weights)
            active = [shape for shape in moved if shape is not None]
            sampled.keep(Blend(tuple(weights)), moved, sum(shape.vertices.nbytes for shape in active))
            return [shape.mesh.bounds for shape in active]

        room = room_of_moved(bounds, still.lattice.centers, blends, _SAMPLED_BLENDS, control)
        thickens = still.settings.thin_parts and still.settings.carried_detail > 0
        spans = _thin_spans(motion, len(names), still.lattice.spacing) if thickens else ()
        lattice = still.lattice.holding(room)
        return cls(still, motion, lattice, tuple(names), matching, sampled=sampled, spans=spans)

    def solves_singly(self, _blends: Sequence[Blend]) -> bool:
        """Whether blends are solved by themselves, not from the preceding one of their run."""
        return True

    def demanding(self, demand: Demand) -> MovingProblem:
        """Return the problem with a demand on its blends, which overrides the connectivity of the inputs."""
        return replace(self, still=self.still.demanding(demand))

    def effort(self, blend: Blend) -> float:
        """Estimate the relative time that a blend takes."""
        return 0.0 if blend.source is not None else 1.0

    def preview(self, blend: Blend) -> MorphFrame:
        """Show the moved input of the largest weight in place of a blend."""
        shape = self.motion.moved(blend.weights)[int(np.argmax(blend.weights))]
        return MorphFrame(blend, shape.mesh, {"weights": blend.weights, "volume": shape.mesh.volume})

    def frame(self, blend: Blend, control: Control) -> MorphFrame:
        """Solve one blend; an input with a weight of one is shown unchanged."""
        if blend.source is not None:
            return self._unmoved_frame(blend, control)
        moved = self.moved_blend(blend, control)
        problem, shapes, active = moved.problem, moved.shapes, moved.active
        if moved.coincides:
            solved = self._coinciding(moved, control)
        else:
            solver = BlendSolver(problem.transport, control, ALONE)
            transported = solver.solve(moved.blend, problem.transport.blend_volumes(moved.blend))
            solved = surfaced_frame(problem, transported, moved.solids, control)
        about = {"weights": blend.weights, "rest": moved.solids.disagreement, "motion": dict(self.still.motion)}
        if self._is_of_no_use(solved):
            return MorphFrame(blend, solved.mesh, {**solved.record, **about, "volume": solved.mesh.volume})
        occupancies = moved.occupancies
        starts = starts_on_readings(problem, solved, moved.solids) if problem.settings.carried_detail > 0 else None
        # On fine grids, the others take most of the memory.
        del moved
        surface = self._placed(problem, solved, shapes, occupancies, starts, control)
        mesh, places = surface.mesh, surface.places
        record = {**solved.record, **about, "volume": mesh.volume}
        if not self.still.settings.carry:
            return MorphFrame(blend, mesh, record)
        origins = moved_origins(places, shapes, active, mesh.vertices, len(blend.weights))
        tangents = moved_tangents(places, shapes, self.motion, blend.weights, mesh.vertices)
        triangles = None if surface.triangles is None else self._of_inputs(surface.triangles, shapes, active)
        return MorphFrame(blend, mesh, record, origins=origins, tangents=tangents, triangles=triangles)

    def _unmoved_frame(self, blend: Blend, control: Control) -> MorphFrame:
        """Return the frame of an input alone. What the grid misses of it is of no interest if blends keep it."""
        found = solve_blends(self.still, [blend], control)[0]
        if not self.spans:
            return found
        return replace(found, record={name: value for name, value in found.record.items() if name != "thin"})

    def frames(
        self, run: Sequence[Blend], control: Control = UNINTERRUPTED, hand_over: HandOver = at_once
    ) -> list[MorphFrame]:
        """Solve a run of blends; parameters as for :func:`.blending.solve_blends`."""
        return solve_moving_blends(self, run, control, hand_over)

    def frames_again(
        self, run: Sequence[Blend], asked: Mapping[Blend, Demand], control: Control = UNINTERRUPTED
    ) -> list[MorphFrame]:
        """Compute some blends of a run again, with a demand on each, from the same barycenters."""
        return [self.demanding(asked[blend]).frame(blend, control) for blend in run if blend in asked]

    def moved_blend(self, blend: Blend, control: Control) -> MovedBlend:
        """Move the inputs of one blend that have weight, and voxelize them, unless that is kept."""
        known = None if self.kept is None else self.kept.get(blend)
        if known is not None:
            return replace(known, problem=self._demanded(known.problem.transport, known.active))
        moved = self._moved(blend.weights)
        control.check()
        active = np.flatnonzero(blend.weights)
        shapes = [moved[i] for i in active]
        alone = Blend(tuple(blend.weights[i] for i in active))
        lattice = self._lattice_around(shapes, np.asarray(blend.weights))
        split = self._split(shapes, active, lattice, control)
        occupancies = [sum(own[1:], start=own[0]) for own in zip(*split.densities, strict=True)]
        volume = float(interpolated_volumes(alone.weights, split.volumes, self.still.settings.growth).sum())
        solids = CoincidingSolids.of(occupancies, alone.weights, volume, self._middles(shapes, active, lattice))
        transport = TransportProblem((), lattice, self.still.settings)
        if not solids.coincide:
            transport = TransportProblem.of(split, lattice, self.still.settings)
        found = MovedBlend(alone, self._demanded(transport, active), shapes, active, occupancies, solids, volume)
        if self.kept is not None:
            self.kept.keep(blend, found, found.bytes)
        return found

    def _moved(self, weights: tuple[float, ...]) -> list[MovedShape | None]:
        """Return the moved inputs of a blend."""
        known = None if self.sampled is None else self.sampled.get(Blend(weights))
        if known is None:
            return self.motion.moved(weights)
        # What is found out about copies is not kept.
        return [None if shape is None else replace(shape) for shape in known]

    def _middles(
        self, shapes: Sequence[MovedShape], active: NDArray[np.int64], lattice: Lattice
    ) -> list[NDArray[np.float64]] | None:
        """Return points in the middle of the thin parts of moved inputs, (m, 3) each, in cells."""
        if not self.spans:
            return None
        found = zip(shapes, active, lattice.centers, strict=True)
        width = WIDTH * lattice.spacing
        return [
            (self.spans[index].middles(shape.mesh, width) - center - lattice.origin) / lattice.spacing
            for shape, index, center in found
        ]

    def _demanded(self, transport: TransportProblem, active: NDArray[np.int64]) -> MorphProblem:
        """Return the problem of moved inputs under the demand of this problem; connectivity is that at rest."""
        return MorphProblem(transport, tuple(self.still.connectivity[i] for i in active), demand=self.still.demand)

    def _is_of_no_use(self, solved: MorphFrame) -> bool:
        """Whether a frame without detail misses the demand on it, so that it replaces no other."""
        demand = self.still.demand
        return demand is not None and demand.is_missed_by(Connectivity(**solved.record["found"]))

    def _of_inputs(
        self, triangles: Sequence[NDArray[np.int64]], shapes: Sequence[MovedShape], active: NDArray[np.int64]
    ) -> NDArray[np.int32]:
        """Expand triangle indices of moved inputs to all inputs, (k, m); -1 for inputs without weight."""
        found = np.full((len(self.names), len(triangles[0])), -1, np.int32)
        for index, own, shape in zip(active, triangles, shapes, strict=True):
            found[index] = own if shape.parents is None else shape.parents[own]
        return found

    def _coinciding(self, moved: MovedBlend, control: Control) -> MorphFrame:
        """Return the frame of shapes that coincide, without transport."""
        problem, blend, solids, volume = moved.problem, moved.blend, moved.solids, moved.volume
        constraint = problem.constraint(blend.weights)
        extracted = extract_coinciding(solids, volume, problem.connectivity, problem.settings, constraint, control)
        mesh = problem.lattice.to_scene(extracted.surface.mesh, np.array(blend.weights))
        record = {
            "cells": problem.lattice.shape,
            "level": extracted.surface.level,
            "volume_wanted": volume * problem.lattice.spacing**3,
            "converged": True,
            **extracted.record,
        }
        return MorphFrame(blend, mesh, record)

    def _placed(
        self,
        problem: MorphProblem,
        solved: MorphFrame,
        shapes: Sequence[MovedShape],
        occupancies: Sequence[NDArray[np.float32]],
        starts: Starts | None,
        control: Control,
    ) -> _PlacedSurface:
        """Return the surface of a frame with the detail that the settings demand, and its points on the shapes."""
        mesh, searched = solved.mesh, [FacingShape(shape.mesh) for shape in shapes]
        if starts is not None:
            sound = [reliability_of(shape) for shape in shapes]
            detailed = detailed_blend(problem, solved, searched, occupancies, starts, control, sound)
            return _PlacedSurface(detailed.mesh, detailed.places, detailed.triangles)
        if not problem.settings.carry:
            return _PlacedSurface(mesh, [])
        if solved.origins is not None:
            found = zip(shapes, solved.origins, strict=True)
            return _PlacedSurface(mesh, [shape.finder.find_about(own) for shape, own in found])
        normals = mesh.vertex_normals
        return _PlacedSurface(mesh, [own.finder.find(mesh.vertices, normals, control) for own in searched])

    def _lattice_around(self, shapes: Sequence[MovedShape], weights: NDArray[np.float64]) -> Lattice:
        """Return the cells that the moved inputs of one blend need; all of them have the same center."""
        center = weights @ self.lattice.centers
        bounds = common_bounds([shape.mesh.bounds for shape in shapes]) - center
        lattice = self.lattice.only_holding(Room(*bounds))
        return replace(lattice, centers=np.tile(center, (len(shapes), 1)))

    def _split(
        self, shapes: Sequence[MovedShape], active: NDArray[np.int64], lattice: Lattice, control: Control
    ) -> SplitShapes:
        """Voxelize the parts of the moved inputs of one blend; their volumes are those at rest."""
        matching = replace(
            self.matching,
            faces=tuple(_of_parents(self.matching.faces[i], shape) for i, shape in zip(active, shapes, strict=True)),
        )
        thickness = self.still.settings.thickness
        filled = [
            voxelized_parts(shape.mesh, self.names[index], place, lattice, thickness, matching, control)
            for place, (index, shape) in enumerate(zip(active, shapes, strict=True))
        ]
        split = joined(matching, filled)
        known = {part.name: part.volumes[active] for part in self.still.transport.parts}
        volumes = [known.get(name, own) for name, own in zip(split.names, split.volumes, strict=True)]
        return replace(split, volumes=np.stack(volumes))


@dataclass(frozen=True)
class _PlacedSurface:
    """The surface of a frame, and the points (and triangles, for detail) of every moved shape that it lies on."""

    mesh: TriangleMesh
    places: list[ClosestPoints]
    triangles: list[NDArray[np.int64]] | None = None


def _thin_spans(motion: Motion, count: int, spacing: float) -> list[ThinSpans]:
    """Return the spans across the parts of all inputs that a grid may not show."""
    rests = [unmoved(motion, count, index).mesh for index in range(count)]
    return side_by_side(lambda index: ThinSpans.of(rests[index], _AT_REST * WIDTH * spacing), count)


def _of_parents(labels: NDArray[np.int64], shape: MovedShape) -> NDArray[np.int64]:
    """Return labels of a moved shape's triangles from those of the input; a single label may be an empty array."""
    return labels if shape.parents is None or not len(labels) else labels[shape.parents]


class FrameMaker(Protocol[Made]):
    """Computes the frames of a morph one by one."""

    def frame(self, blend: Blend, control: Control) -> Made:
        """Compute the frame of one blend."""
        ...


def solve_moving_blends(
    problem: FrameMaker[Made],
    blends: Sequence[Blend],
    control: Control = UNINTERRUPTED,
    hand_over: HandOver = at_once,
) -> list[Made]:
    """Solve blends of moving inputs, in space or in a plane; parameters as for :func:`.blending.solve_blends`."""
    frames = [hand_over(partial(problem.frame, blend, control)) for blend in blends]
    return [frame() for frame in frames]
