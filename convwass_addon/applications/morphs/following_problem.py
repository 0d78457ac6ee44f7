# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morphs of animated inputs: every blend uses the shapes as they are at its frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays.bounds import common_bounds
from ...geometry.meshes.centroid import centroid
from ...geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints
from ...geometry.meshes.facing_points import FacingShape
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control
from ..motions.posed_motion import PosedMotion
from .animation import Animation
from .blend_solver import BlendSolver, SolvedBlend
from .blending import HandOver, solve_blends, surfaced_frame
from .demands import Demand
from .layouts import Blend
from .morph_problem import MorphFrame, MorphProblem
from .moved_room import Room
from .moving_problem import MovingProblem
from .part_labels import Matching
from .parts import joined, voxelized_parts
from .spare_threads import at_once

# Margin in cells around the known poses, for those in between.
_SLACK_CELLS = 1


@dataclass(frozen=True)
class PosedBlend:
    """A blend of animated inputs at its time.

    Attributes
    ----------
    blend : Blend
        Its weights.
    time : float
        Its frame.
    shapes : list of TriangleMesh
        All inputs in their poses.
    active : (a,) int64
        Indices of the inputs of positive weight.
    """

    blend: Blend
    time: float
    shapes: list[TriangleMesh]
    active: NDArray[np.int64]


@dataclass(frozen=True)
class FollowingProblem(MovingProblem):
    """The problem shared by all blends of animated inputs.

    Attributes
    ----------
    still : MorphProblem
        The inputs as they were when they were read: `rests`. It determines the spacing of the cells, and the
        connectivity and volumes of inputs that keep their triangles; volumes are scaled with the meshes.
    motion : PosedMotion or None
        How the inputs move towards each other, in any pose; None if they do not.
    animation : Animation
        The inputs at any time.
    rests : tuple of FacingShape
        The inputs as they were when the motion was chosen.
    """

    motion: PosedMotion | None
    animation: Animation
    rests: tuple[FacingShape, ...]

    @classmethod
    def around(
        cls,
        still: MorphProblem,
        motion: PosedMotion | None,
        animation: Animation,
        rests: Sequence[TriangleMesh],
        names: Sequence[str],
        matching: Matching,
    ) -> FollowingProblem:
        """Lay out a grid that holds the inputs at all times, relative to their current centers; see the attributes."""
        bounds = common_bounds([mesh.bounds - centroid(mesh) for mesh in animation.meshes])
        lattice = still.lattice.holding(Room(*bounds, _SLACK_CELLS))
        searched = tuple(FacingShape(rest).ready() for rest in rests)
        return cls(still, motion, lattice, tuple(names), matching, animation, searched)

    def solves_singly(self, _blends: Sequence[Blend]) -> bool:
        """Whether blends are solved by themselves; by transport, each starts from the preceding one."""
        return self.motion is not None

    def preview(self, blend: Blend) -> MorphFrame:
        """Show the input of the largest weight, in its current pose, in place of a blend."""
        time, largest = self.animation.time_of(blend.weights), int(np.argmax(blend.weights))
        mesh = self.animation.shapes[largest].at(time)
        return MorphFrame(blend, mesh, {"weights": blend.weights, "volume": mesh.volume})

    def frame(self, blend: Blend, control: Control) -> MorphFrame:
        """Solve one blend; an input with a weight of one is shown unchanged."""
        if blend.source is not None:
            return solve_blends(self.still, [blend], control)[0]
        if self.motion is None:
            return self.frames([blend], control)[0]
        return self._moved(blend, self._posed(blend), control)

    def frames(
        self, run: Sequence[Blend], control: Control = UNINTERRUPTED, hand_over: HandOver = at_once
    ) -> list[MorphFrame]:
        """Solve a run of blends; by transport, each starts from the preceding one."""
        if self.motion is not None:
            return super().frames(run, control, hand_over)
        frames = [hand_over(frame) for _, frame in self._transported_run(run, {}, control)]
        return [frame() for frame in frames]

    def frames_again(
        self, run: Sequence[Blend], asked: Mapping[Blend, Demand], control: Control = UNINTERRUPTED
    ) -> list[MorphFrame]:
        """Compute some blends of a run again, with a demand on each, from the same barycenters."""
        if self.motion is not None:
            return super().frames_again(run, asked, control)
        last = max(place for place, blend in enumerate(run) if blend in asked)
        frames = self._transported_run(run[: last + 1], asked, control)
        return [frame() for blend, frame in frames if blend in asked]

    def _posed(self, blend: Blend) -> PosedBlend:
        time = self.animation.time_of(blend.weights)
        shapes = [shape.at(time) for shape in self.animation.shapes]
        return PosedBlend(blend, time, shapes, np.flatnonzero(blend.weights))

    def _moved(self, blend: Blend, posed: PosedBlend, control: Control) -> MorphFrame:
        """Solve a blend of inputs that move towards each other, starting from their current poses."""
        shapes = posed.shapes
        motion = self.motion.at(shapes, posed.active.tolist(), control)
        growth = [_volume_ratio(shape, rest.mesh) for shape, rest in zip(shapes, self.rests, strict=True)]
        parts = tuple(replace(part, volumes=part.volumes * growth) for part in self.still.transport.parts)
        lattice = replace(self.lattice, centers=np.stack([centroid(shape) for shape in shapes]))
        still = replace(self.still, transport=replace(self.still.transport, parts=parts, lattice=lattice))
        problem = MovingProblem.of(still, motion, [blend], self.names, self.matching, control)
        frame = replace(problem, kept=self.kept).frame(blend, control)
        if frame.origins is None:
            return frame
        places = {index: self.rests[index].finder.find_closest(frame.origins[index]) for index in posed.active.tolist()}
        return replace(frame, tangents=self._tangents(frame, places, posed.time))

    def _transported_run(
        self, run: Sequence[Blend], asked: Mapping[Blend, Demand], control: Control
    ) -> Iterator[tuple[Blend, Callable[[], MorphFrame]]]:
        """Solve blends by transport between current poses, each from the preceding one; yield what extracts frames."""
        earlier = None
        for blend in run:
            if blend.source is not None:
                yield blend, partial(self.frame, blend, control)
                continue
            posed = self._posed(blend)
            problem = self._problem_at(posed, control)
            alone = Blend(tuple(blend.weights[i] for i in posed.active))
            solver = BlendSolver(problem.transport, control)
            if earlier is not None and np.array_equal(earlier[0], posed.active):
                solver.start_from(earlier[1])
            solved = solver.solve(alone, problem.transport.blend_volumes(alone))
            earlier = posed.active, solved
            own = problem.demanding(asked[blend]) if blend in asked else problem
            yield blend, partial(self._transported, own, solved, posed, control)

    def _transported(
        self, problem: MorphProblem, solved: SolvedBlend, posed: PosedBlend, control: Control
    ) -> MorphFrame:
        """Extract the frame of a blend that was solved between current poses."""
        blend, active, shapes = posed.blend, posed.active, posed.shapes
        own = surfaced_frame(problem, solved, control=control)
        frame = replace(own, blend=blend, record={**own.record, "weights": blend.weights})
        if own.origins is None:
            return frame
        origins = np.tile(frame.mesh.vertices.astype(np.float32), (len(shapes), 1, 1))
        origins[active] = own.origins
        if not self.animation.keeps_topology:
            return replace(frame, origins=origins, triangles=None)
        tangents, places = origins.copy(), {}
        for index, origin in zip(active.tolist(), own.origins, strict=True):
            places[index] = ClosestPointFinder(shapes[index].corners).find_about(origin)
            origins[index] = places[index].interpolated(self.rests[index].mesh.corners)
        triangles = _of_all(own.triangles, active, shapes)
        placed = replace(frame, origins=origins, tangents=tangents, triangles=triangles)
        return replace(placed, tangents=self._tangents(placed, places, posed.time))

    def _problem_at(self, posed: PosedBlend, control: Control) -> MorphProblem:
        """Return the problem of the inputs of one blend in their current poses."""
        active, shapes = posed.active, [posed.shapes[i] for i in posed.active]
        settings = self.still.settings
        lattice = replace(self.lattice, centers=np.stack([centroid(shape) for shape in shapes]))
        faces = self.matching.faces
        matching = replace(self.matching, faces=tuple(faces[i] for i in active))
        volumes = [
            voxelized_parts(shape, self.names[i], place, lattice, settings.thickness, matching, control)
            for place, (i, shape) in enumerate(zip(active, shapes, strict=True))
        ]
        problem = MorphProblem.for_sketches(joined(matching, volumes), lattice, settings, shapes)
        problem = replace(problem, motion=self.still.motion).with_detail_of(shapes)
        if not self.animation.keeps_topology:
            return problem.with_connectivity(control=control)
        return replace(problem, connectivity=tuple(self.still.connectivity[i] for i in active), meshes=())

    def _tangents(self, frame: MorphFrame, places: Mapping[int, ClosestPoints], time: float) -> NDArray[np.float32]:
        """Add the inputs' own motion to the points that determine velocities; see :func:`.origins.velocities`.

        The places are those of the vertices on the inputs that have a weight.

        On a path, the weight of the second input grows by `rate` per frame while the other falls, so whatever is added
        to its tangents counts `rate` times.
        """
        weights = frame.blend.weights
        animated = np.zeros(frame.mesh.vertices.shape)
        for index, there in places.items():
            velocity = self.animation.shapes[index].velocity(time)
            animated += weights[index] * there.interpolated(velocity[self.rests[index].mesh.faces])
        first, last = np.flatnonzero(weights)[[0, -1]]
        rate = 1.0 / (self.animation.stations[last] - self.animation.stations[first])
        tangents = frame.velocity_points.copy()
        tangents[last] += (animated / rate).astype(np.float32)
        return tangents


def _of_all(
    triangles: NDArray[np.int32] | None, active: NDArray[np.int64], shapes: Sequence[TriangleMesh]
) -> NDArray[np.int32] | None:
    """Expand triangle indices of some inputs to all inputs, (k, m); -1 for the others."""
    if triangles is None:
        return None
    found = np.full((len(shapes), triangles.shape[1]), -1, np.int32)
    found[active] = triangles
    return found


def _volume_ratio(shape: TriangleMesh, rest: TriangleMesh) -> float:
    """Return the volume of a pose relative to the rest mesh; 1 for open meshes that enclose almost nothing."""
    least = 1e-3 * rest.area**1.5
    return abs(shape.volume) / abs(rest.volume) if min(abs(rest.volume), abs(shape.volume)) > least else 1.0
