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

from ...geometry.closest_points import ClosestPointFinder, ClosestPoints
from ...geometry.mesh import TriangleMesh
from ..motions.motion import Motion, MovedShape, arriving, unmoved


@dataclass(frozen=True)
class LentPart:
    """A part of one shape that is added to another one, which has it only on the way.

    Attributes
    ----------
    lender : int
        The shape that has it.
    vertices : (n,) int64
        Its vertices there.
    is_loose : (n,) bool
        Which of them are not on the seam, where the part begins.
    faces : (2 m, 3) int64
        Its triangles, indices in `vertices`, and what closes it: the same triangles, reversed, where its loose vertices
        end once it has retracted. These follow `vertices`.
    places : ClosestPoints
        Where its vertices are on the borrower's surface then.
    """

    lender: int
    vertices: NDArray[np.int64]
    is_loose: NDArray[np.bool_]
    faces: NDArray[np.int64]
    places: ClosestPoints

    @classmethod
    def of(cls, motion: Motion, pair: tuple[int, int], count: int, is_loose: NDArray[np.bool_]) -> LentPart:
        """Lend a part of the first one of a pair to the second one, of `count` shapes.

        Parameters
        ----------
        motion : Motion
            Retracts the part where the first shape becomes the second one.
        pair : (int, int)
            The shapes.
        count : int
            Number of shapes.
        is_loose : (v,) bool
            Which vertices of the first shape are on the part.
        """
        retracted = arriving(motion, count, *pair)
        chosen = retracted.rest.faces[is_loose[retracted.rest.faces].any(axis=1)]
        vertices, faces = np.unique(chosen, return_inverse=True)
        faces, own = faces.reshape(-1, 3), is_loose[vertices]
        ends = np.where(own, len(vertices) + np.cumsum(own) - 1, np.arange(len(vertices)))
        places = ClosestPointFinder(unmoved(motion, count, pair[1]).mesh.corners).find(retracted.vertices[vertices])
        return cls(pair[0], vertices, own, np.concatenate([faces, ends[faces][:, ::-1]]), places)

    def added(self, borrower: TriangleMesh, lender: MovedShape | None) -> NDArray[np.float64]:
        """Return the vertices of the part on a moved borrower, retracted where the lender has no weight."""
        ends = self.places.interpolated(borrower.corners)
        return np.concatenate([ends if lender is None else lender.vertices[self.vertices], ends[self.is_loose]])


@dataclass(frozen=True)
class LendingMotion:
    """A motion of shapes with the parts of others; a :class:`.motion.Motion`.

    Attributes
    ----------
    motion : Motion
        The motion of the shapes.
    parts : mapping of int to LentPart
        Parts that are added, by their borrowers.
    """

    motion: Motion
    parts: Mapping[int, Sequence[LentPart]]

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        shapes = self.motion.moved(weights)
        return [
            own if own is None else _with_parts(own, self.parts.get(index, ()), shapes)
            for index, own in enumerate(shapes)
        ]


def _with_parts(shape: MovedShape, parts: Sequence[LentPart], shapes: Sequence[MovedShape | None]) -> MovedShape:
    """Add parts to a moved shape."""
    rest, vertices, faces = [shape.rest.vertices], [shape.vertices], [shape.rest.faces]
    parents = [np.arange(len(shape.rest.faces)) if shape.parents is None else shape.parents]
    for part in parts:
        rest.append(part.added(shape.rest, None))
        faces.append(part.faces + sum(map(len, vertices)))
        vertices.append(part.added(shape.mesh, shapes[part.lender]))
        parents.append(parents[0][part.places.triangles[part.faces[: len(part.faces) // 2, 0]]])
        parents.append(parents[-1])
    return MovedShape(
        TriangleMesh(np.concatenate(rest), np.concatenate(faces)), np.concatenate(vertices), np.concatenate(parents)
    )
