# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The motion of flat shapes whose bodies move as their outlines do, while limbs that others have not retract."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.plane.planar_fill import Boundary
from ..motions.motion import MovedShape, unmoved, ways_between
from .added_parts import MotionWithAddedParts
from .agreeing_motion import AgreeingMotion
from .attached_limbs import AttachedLimb, with_limb
from .moved_sheets import TRIANGLES, MovedSheets, largest_overlap
from .section_motion import share_left
from .sheets import Sheet
from .vanishing_limbs import ShapeBody

# Limbs collide if more of the area than this overlaps besides: from an r to an m, with legs that bend, 0.009 does, and
# for all letters whose limbs retract well at most 0.0001.
_COLLIDING = 0.001


@dataclass(frozen=True)
class LimbMotion:
    """Moves the bodies of flat shapes, and retracts their limbs; a :class:`.motion.Motion`.

    Attributes
    ----------
    bodies : AgreeingMotion
        The motion of the bodies.
    rests : tuple of TriangleMesh
        The shapes at rest; the vertices of their bodies come first.
    limbs : tuple of tuple of AttachedLimb
        Their limbs, whose vertices follow in this order; they are attached to the body or to those before them.
    """

    bodies: AgreeingMotion
    rests: tuple[TriangleMesh, ...]
    limbs: tuple[tuple[AttachedLimb, ...], ...]

    @property
    def way(self) -> float:
        """Fraction of the way towards the others that shapes move, from 0 to 1."""
        return self.bodies.way

    @property
    def is_loose(self) -> list[NDArray[np.bool_]]:
        """Which vertices of every shape are on limbs."""
        return [
            np.arange(len(rest.vertices)) >= len(rest.vertices) - sum(len(limb.coordinates) for limb in own)
            for rest, own in zip(self.rests, self.limbs, strict=True)
        ]

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        found = self.bodies.moved(weights)
        for index, (body, rest, limbs) in enumerate(zip(found, self.rests, self.limbs, strict=True)):
            if body is not None and limbs:
                left = share_left(weights[index], self.way)
                scale, vertices = float(np.sqrt(body.mesh.area / body.rest.area)), body.vertices
                for limb in limbs:
                    vertices = np.concatenate([vertices, limb.moved(vertices, left, scale)])
                found[index] = MovedShape(rest, vertices)
        return found


def with_limbs(
    moved: MovedSheets, parts: Sequence[Boundary], bodies: Sequence[ShapeBody], pairs: Sequence[tuple[int, int]]
) -> MovedSheets | None:
    """Return moved bodies with their limbs, or None if these would collide on the way.

    Parameters
    ----------
    moved : MovedSheets
        The bodies with their motion.
    parts : sequence of Boundary
        The whole shapes.
    bodies : sequence of ShapeBody
        The bodies with the limbs that they lack.
    pairs : sequence of (int, int)
        Shapes that occur together in a blend.
    """
    flat = moved.choice.motion
    rests, limbs = [], []
    for index, body in enumerate(bodies):
        rest, attached = unmoved(flat, len(bodies), index).rest, []
        # What was cut off last is attached first.
        for limb in reversed(body.limbs):
            rest, own = with_limb(rest, limb, TRIANGLES * body.shape.filled.root_area, body.shape.marks)
            attached.append(own)
        rests.append(rest)
        limbs.append(tuple(attached))
    motion = LimbMotion(flat, tuple(rests), tuple(limbs))
    sheets = tuple(Sheet.attached(part, rest) for part, rest in zip(parts, rests, strict=True))
    overlap = max(largest_overlap(sheets, motion, way) for way in ways_between(pairs) if limbs[way[0]])
    if overlap > moved.overlap + _COLLIDING:
        return None
    choice = replace(moved.choice, motion=motion, limbs=sum(map(len, limbs)))
    return replace(moved, sheets=sheets, choice=choice)


def with_added_limbs(moved: MovedSheets, pairs: Sequence[tuple[int, int]]) -> MovedSheets:
    """Return moved sheets with the limbs of those that they occur with, which grow while these retract."""
    motion = moved.choice.motion
    if not isinstance(motion, LimbMotion) or motion.way < 1.0:
        return moved
    adding = MotionWithAddedParts.of(motion, motion, motion.is_loose, pairs)
    sheets = list(moved.sheets)
    for index, parts in adding.parts.items():
        rest = sheets[index].mesh
        # What closes a solid part is not needed.
        added = [TriangleMesh(part.added(rest, None), part.faces[: len(part.faces) // 2]) for part in parts]
        sheets[index] = Sheet.joined([sheets[index], *map(Sheet.of_triangles, added)])
    return replace(moved, sheets=tuple(sheets), choice=replace(moved.choice, motion=adding))
