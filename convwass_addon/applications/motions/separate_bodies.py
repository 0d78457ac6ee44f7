# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes of several bodies that lie apart, such as two people: each body moves by itself to the one in its place.

As one surface, they would be mapped together, and a body that turns or swings would draw on the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from ...geometry.arrays.bounds import bounds_of, common_bounds
from ...geometry.arrays.components import component_labels
from ...geometry.meshes.edges import used_part, vertex_components
from ...geometry.meshes.mesh import TriangleMesh, joined_meshes
from .motion import Motion, MovedShape, unmoved
from .motion_choice import MotionChoice, reason_of_stand_ins
from .motion_request import MotionRequest

# Bodies are apart if their bounding boxes are at least this far from each other, relative to the diagonal of all.
_GAP = 0.01
# Shapes of more connected components are not divided, nor those of more bodies.
_MOST_COMPONENTS, _MOST_BODIES = 64, 6
# Bodies belong to something larger if they have less than this share of the size of the largest one: a hand that
# floats beside a figure follows its motion.
_COMPARABLE = 0.5
# Reasons for a guided motion, the most certain one first.
_REASONS = ("VERTICES", "OUTLINES", "TUBES", "FITS", "PARTLY")


@dataclass(frozen=True)
class Body:
    """A body of a shape.

    Attributes
    ----------
    mesh : TriangleMesh
        Its surface in scene space.
    triangles : (m,) int64
        The triangles of the shape that it consists of.
    """

    mesh: TriangleMesh
    triangles: NDArray[np.int64]

    @classmethod
    def of(cls, shape: TriangleMesh, triangles: NDArray[np.int64]) -> Body:
        """Return the body of some triangles of a shape."""
        used, faces = used_part(shape.faces[triangles], len(shape.vertices))
        return cls(TriangleMesh(shape.vertices[used], faces), triangles)


@dataclass(frozen=True)
class BodiesMotion:
    """A motion of shapes whose bodies move by themselves; a :class:`.motion.Motion`.

    Attributes
    ----------
    motions : tuple of Motion
        The motion of every body.
    still : tuple of MovedShape
        The shapes at rest, with the triangles that the motions give their bodies.
    """

    motions: tuple[Motion, ...]
    still: tuple[MovedShape, ...]

    @classmethod
    def of(cls, motions: Sequence[Motion], bodies: Sequence[Sequence[Body]]) -> BodiesMotion:
        """Return the motion of shapes for those of their bodies, by place and by shape."""
        count = len(bodies[0])
        still = tuple(
            _joined([unmoved(motion, count, index) for motion in motions], [own[index] for own in bodies])
            for index in range(count)
        )
        return cls(tuple(motions), still)

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        by_shape = zip(*(motion.moved(weights) for motion in self.motions), strict=True)
        return [
            None if bodies[0] is None else replace(still, vertices=np.concatenate([body.vertices for body in bodies]))
            for still, bodies in zip(self.still, by_shape, strict=True)
        ]


@dataclass(frozen=True)
class SeparateBodies:
    """Shapes of equally many bodies that lie apart.

    Attributes
    ----------
    bodies : tuple of tuple of Body
        By place, and by shape.
    requests : tuple of MotionRequest
        What is asked for the bodies in every place.
    """

    bodies: tuple[tuple[Body, ...], ...]
    requests: tuple[MotionRequest, ...]

    @classmethod
    def of(cls, request: MotionRequest) -> SeparateBodies | None:
        """Divide shapes; None if they do not consist of the same number of bodies of comparable size, at least two.

        Bodies belong together that are near each other, relative to the centers of their shapes, and similar in size.
        """
        divided = [_bodies(shape) for shape in request.shapes]
        if len({len(bodies) for bodies in divided}) > 1 or not 2 <= len(divided[0]) <= _MOST_BODIES:
            return None
        first = _places(divided[0])
        ordered = [divided[0]]
        for bodies in divided[1:]:
            away = np.square(first[:, None] - _places(bodies)).sum(axis=2)
            ordered.append([bodies[place] for place in linear_sum_assignment(away)[1]])
        by_place = tuple(zip(*ordered, strict=True))
        requests = tuple(replace(request, shapes=[body.mesh for body in bodies]) for bodies in by_place)
        return cls(by_place, requests)

    def joined(self, found: Sequence[MotionChoice]) -> MotionChoice:
        """Return the choice for the shapes for those of guided motions of all bodies."""
        scores, detours, left = (
            [figure for figure in figures if figure is not None]
            for figures in zip(*((own.score, own.detour, own.left) for own in found), strict=True)
        )
        return MotionChoice(
            "guided",
            reason_of_stand_ins(max((own.reason for own in found), key=_REASONS.index)),
            BodiesMotion.of([own.motion for own in found], self.bodies),
            score=min(scores, default=None),
            turned=max(own.turned for own in found),
            detour=max(detours, default=None),
            left=max(left, default=None),
            bodies=len(found),
            limbs=sum(own.limbs for own in found),
        )


def _joined(shapes: Sequence[MovedShape], bodies: Sequence[Body]) -> MovedShape:
    """Return the bodies of a shape as one."""
    rest = joined_meshes([shape.rest for shape in shapes])
    triangles = [
        body.triangles if shape.parents is None else body.triangles[shape.parents]
        for shape, body in zip(shapes, bodies, strict=True)
    ]
    return MovedShape(rest, np.concatenate([shape.vertices for shape in shapes]), np.concatenate(triangles))


def _bodies(shape: TriangleMesh) -> list[Body]:
    """Return the bodies of a shape that lie apart; none if they differ much in size, or if there are very many."""
    components = vertex_components(shape)
    count, labels = int(components.max(initial=-1)) + 1, components[shape.faces[:, 0]]
    # Triangles without area belong to no component.
    if not 2 <= count <= _MOST_COMPONENTS or (labels < 0).any():
        return []
    boxes = np.stack([bounds_of(shape.vertices[components == own]) for own in range(count)])
    groups = _groups(boxes, _GAP * shape.diagonal)[labels]
    found = [Body.of(shape, np.flatnonzero(groups == group)) for group in range(int(groups.max()) + 1)]
    sizes = np.sqrt([body.mesh.area for body in found])
    return found if sizes.min() >= _COMPARABLE * sizes.max() else []


def _groups(boxes: NDArray[np.float64], gap: float) -> NDArray[np.int64]:
    """Return labels of boxes, (n, 2, 3), equal where boxes around those of equal labels are closer than a gap, (n,)."""
    groups = np.arange(len(boxes))
    while True:
        members = [common_bounds(boxes[groups == group]) for group in range(int(groups.max()) + 1)]
        low, high = np.stack(members, axis=1)
        apart = (low[:, None] - high > gap).any(axis=2)
        joined = component_labels(*np.nonzero(~(apart | apart.T)), len(members))
        if joined.max() + 1 == len(members):
            return groups
        groups = joined[groups]


def _places(bodies: Sequence[Body]) -> NDArray[np.float64]:
    """Return the centers and sizes of bodies, relative to all of them, (n, 4)."""
    centers, sizes = np.array([body.mesh.area_center for body in bodies]), np.sqrt([body.mesh.area for body in bodies])
    return np.column_stack([centers - centers.mean(axis=0), sizes]) / np.linalg.norm(sizes)
