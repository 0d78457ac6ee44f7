# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that only one of two shapes has, such as the handle of a mug that becomes a bottle, are in both on the way.

If they were in one alone, they would be what remains to be transported, and tear as they become thin.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints
from ...geometry.meshes.mesh import TriangleMesh, joined_meshes
from ...geometry.remeshing.subdivision import Subdivision
from ..motions.motion import Motion, MovedShape, arriving, unmoved, ways_between


@dataclass(frozen=True)
class AddedPart:
    """A part of one shape that is added to another one, which has it only on the way.

    Attributes
    ----------
    owner : int
        The shape that has it.
    vertices : (n,) int64
        Its vertices there.
    is_loose : (n,) bool
        Which of them are not on the seam, where the part begins.
    faces : (2 m, 3) int64
        Its triangles, indices in `vertices`, and what closes it: the same triangles, reversed, where its loose vertices
        end once it has retracted. These follow `vertices`.
    places : ClosestPoints
        Where its vertices are on the receiver's surface then.
    """

    owner: int
    vertices: NDArray[np.int64]
    is_loose: NDArray[np.bool_]
    faces: NDArray[np.int64]
    places: ClosestPoints

    @classmethod
    def of(cls, retracting: Motion, pair: tuple[int, int], count: int, is_loose: NDArray[np.bool_]) -> AddedPart:
        """Add a part of the first one of a pair to the second one, of `count` shapes.

        Parameters
        ----------
        retracting : Motion
            A motion by which the part has retracted where the first shape becomes the second one.
        pair : (int, int)
            The shapes.
        count : int
            Number of shapes.
        is_loose : (v,) bool
            Which vertices of the first shape are on the part.
        """
        retracted = arriving(retracting, count, *pair)
        chosen = retracted.rest.faces[is_loose[retracted.rest.faces].any(axis=1)]
        vertices, faces = np.unique(chosen, return_inverse=True)
        faces, own = faces.reshape(-1, 3), is_loose[vertices]
        ends = np.where(own, len(vertices) + np.cumsum(own) - 1, np.arange(len(vertices)))
        receiver = ClosestPointFinder(unmoved(retracting, count, pair[1]).mesh.corners)
        # Exact distances would take a hundred times as long.
        places = receiver.find_about(retracted.vertices[vertices])
        return cls(pair[0], vertices, own, np.concatenate([faces, ends[faces][:, ::-1]]), places)

    def added(self, receiver: TriangleMesh, owner: MovedShape | None) -> NDArray[np.float64]:
        """Return the vertices of the part on a moved receiver, retracted where the owner has no weight."""
        ends = self.places.interpolated(receiver.corners)
        return np.concatenate([ends if owner is None else owner.vertices[self.vertices], ends[self.is_loose]])


@dataclass(frozen=True)
class MotionWithAddedParts:
    """A motion of shapes with the parts of others; a :class:`.motion.Motion`.

    Attributes
    ----------
    motion : Motion
        The motion of the shapes.
    parts : mapping of int to sequence of AddedPart
        The parts that are added, by their receivers.
    rests : mapping of int to Subdivision
        The receivers at rest, with these parts.
    """

    motion: Motion
    parts: Mapping[int, Sequence[AddedPart]]
    rests: Mapping[int, Subdivision]

    @classmethod
    def of(
        cls,
        motion: Motion,
        retracting: Motion,
        is_loose: Sequence[NDArray[np.bool_]],
        pairs: Sequence[tuple[int, int]],
    ) -> MotionWithAddedParts:
        """Add parts of shapes to those that they occur with.

        Parameters
        ----------
        motion : Motion
            The motion of the shapes.
        retracting : Motion
            As for :meth:`AddedPart.of`.
        is_loose : sequence of (v,) bool
            Which vertices of every shape are on such parts.
        pairs : sequence of (int, int)
            Shapes that occur together in a blend.
        """
        parts: dict[int, list[AddedPart]] = {}
        for owner, receiver in ways_between(pairs):
            if is_loose[owner].any():
                part = AddedPart.of(retracting, (owner, receiver), len(is_loose), is_loose[owner])
                parts.setdefault(receiver, []).append(part)
        rests = {index: _with_parts(unmoved(motion, len(is_loose), index), own) for index, own in parts.items()}
        return cls(motion, parts, rests)

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        shapes = self.motion.moved(weights)
        found = list(shapes)
        for index, parts in self.parts.items():
            own = shapes[index]
            if own is not None:
                added = [part.added(own.mesh, shapes[part.owner]) for part in parts]
                rest = self.rests[index]
                found[index] = MovedShape(rest.mesh, np.concatenate([own.vertices, *added]), rest.parents)
        return found


def _with_parts(shape: MovedShape, parts: Sequence[AddedPart]) -> Subdivision:
    """Return a shape at rest with parts, whose triangles belong to those of the shape that they are on."""
    added = [TriangleMesh(part.added(shape.rest, None), part.faces) for part in parts]
    parents = np.arange(len(shape.rest.faces)) if shape.parents is None else shape.parents
    below = [parents[part.places.triangles[np.tile(part.faces[: len(part.faces) // 2, 0], 2)]] for part in parts]
    return Subdivision(joined_meshes([shape.rest, *added]), np.concatenate([parents, *below]))
