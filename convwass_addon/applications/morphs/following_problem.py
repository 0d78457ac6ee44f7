# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morphs of animated inputs: every blend uses the shapes as they are at its frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.centroid import centroid
from ...geometry.closest_points import ClosestPointFinder
from ...geometry.mesh import TriangleMesh
from ...progress import Control
from ..motions.posed_motion import PosedMotion
from .animation import Animation
from .blending import solve_blends
from .layouts import Blend
from .morph_problem import MorphFrame, MorphProblem
from .moved_room import Room
from .moving_problem import MovingProblem
from .part_labels import Matching
from .parts import joined, voxelized_parts

# Margin in cells around the known poses, for those in between.
_SLACK_CELLS = 1


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
    rests : tuple of TriangleMesh
        The inputs as they were when the motion was chosen.
    """

    motion: PosedMotion | None
    animation: Animation
    rests: tuple[TriangleMesh, ...]

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
        boxes = np.stack([mesh.bounds - centroid(mesh) for mesh in animation.meshes])
        room = Room(boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0), _SLACK_CELLS)
        lattice = still.lattice.holding(room)
        return cls(still, motion, lattice, tuple(names), matching, animation, tuple(rests))

    def preview(self, blend: Blend) -> MorphFrame:
        """Show the input of the largest weight, in its current pose, in place of a blend."""
        time, largest = self.animation.time_of(blend.weights), int(np.argmax(blend.weights))
        mesh = self.animation.shapes[largest].at(time)
        return MorphFrame(blend, mesh, {"weights": blend.weights, "volume": mesh.volume})

    def frame(self, blend: Blend, control: Control) -> MorphFrame:
        """Solve one blend; an input with a weight of one is shown unchanged."""
        if blend.source is not None:
            return solve_blends(self.still, [blend], control)[0]
        time = self.animation.time_of(blend.weights)
        shapes = [shape.at(time) for shape in self.animation.shapes]
        made = self._transported if self.motion is None else self._moved
        frame = made(blend, time, shapes, control)
        if frame.origins is None or not self.animation.keeps_topology:
            return frame
        return replace(frame, tangents=self._tangents(frame, time))

    def _moved(self, blend: Blend, time: float, shapes: list[TriangleMesh], control: Control) -> MorphFrame:
        """Solve a blend of inputs that move towards each other, starting from their current poses."""
        motion = self.motion.at(shapes, np.flatnonzero(blend.weights).tolist(), control)
        growth = [_volume_ratio(shape, rest) for shape, rest in zip(shapes, self.rests, strict=True)]
        parts = tuple(replace(part, volumes=part.volumes * growth) for part in self.still.transport.parts)
        lattice = replace(self.lattice, centers=np.stack([centroid(shape) for shape in shapes]))
        still = replace(self.still, transport=replace(self.still.transport, parts=parts, lattice=lattice))
        problem = MovingProblem.of(still, motion, [blend], self.names, self.matching, control)
        return problem.frame(blend, control)

    def _transported(self, blend: Blend, time: float, shapes: list[TriangleMesh], control: Control) -> MorphFrame:
        """Solve a blend of inputs by transport between their current poses."""
        active = np.flatnonzero(blend.weights)
        posed = [shapes[i] for i in active]
        problem = self._problem_at(posed, active, control)
        alone = Blend(tuple(blend.weights[i] for i in active))
        solved = solve_blends(problem, [alone], control)[0]
        frame = replace(solved, blend=blend, record={**solved.record, "weights": blend.weights})
        if solved.origins is None:
            return frame
        origins = np.tile(frame.mesh.vertices.astype(np.float32), (len(shapes), 1, 1))
        origins[active] = solved.origins
        if not self.animation.keeps_topology:
            return replace(frame, origins=origins, triangles=None)
        tangents = origins.copy()
        for place, index in enumerate(active):
            there = ClosestPointFinder(posed[place].corners).find_about(solved.origins[place])
            origins[index] = there.interpolated(self.rests[index].corners)
        return replace(frame, origins=origins, tangents=tangents, triangles=_of_all(solved.triangles, active, shapes))

    def _problem_at(self, posed: Sequence[TriangleMesh], active: NDArray[np.int64], control: Control) -> MorphProblem:
        """Return the problem of some inputs in their current poses."""
        settings = self.still.settings
        lattice = replace(self.lattice, centers=np.stack([centroid(shape) for shape in posed]))
        faces = self.matching.faces
        matching = replace(self.matching, faces=tuple(faces[i] for i in active))
        volumes = [
            voxelized_parts(shape, self.names[i], place, lattice, settings.thickness, matching, control)
            for place, (i, shape) in enumerate(zip(active, posed, strict=True))
        ]
        problem = MorphProblem.for_sketches(joined(matching, volumes), lattice, settings, posed)
        problem = replace(problem, motion=self.still.motion).with_detail_of(posed)
        if not self.animation.keeps_topology:
            return problem.with_connectivity()
        return replace(problem, connectivity=tuple(self.still.connectivity[i] for i in active), meshes=())

    def _tangents(self, frame: MorphFrame, time: float) -> NDArray[np.float32]:
        """Add the inputs' own motion to the points that determine velocities; see :func:`.origins.velocities`.

        On a path, the weight of the second input grows by `rate` per frame while the other falls, so whatever is added
        to its tangents counts `rate` times.
        """
        weights = frame.blend.weights
        animated = np.zeros(frame.mesh.vertices.shape)
        for index in np.flatnonzero(weights):
            places = ClosestPointFinder(self.rests[index].corners).find_about(frame.origins[index])
            velocity = self.animation.shapes[index].velocity(time)
            animated += weights[index] * places.interpolated(velocity[self.rests[index].faces])
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
