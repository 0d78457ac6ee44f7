# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of shapes that consist of overlapping bodies: their outer surfaces move, and the shapes follow these.

Surfaces are mapped, and those of overlapping bodies lead inside: the top of a chair's leg lies within the seat.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from scipy.spatial import cKDTree

from ...geometry.deformation.attachment import Attachment
from ...geometry.meshes.edges import component_areas
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.remeshing.subdivision import Subdivision, bendable
from ...geometry.solids.outer_skin import outer_skin
from ...progress import Control
from .motion import Motion, MovedShape, unmoved
from .motion_request import MotionRequest

# A body prevails with this share of the area of all: the head of Suzanne has 0.94, the top of a table 0.69.
_PREVAILING = 0.9


@dataclass(frozen=True)
class Follower:
    """A shape that follows its outer surface.

    Attributes
    ----------
    divided : Subdivision
        The shape in scene space, with long edges divided.
    attachment : Attachment
        Its vertices, attached to the outer surface.
    """

    divided: Subdivision
    attachment: Attachment

    @classmethod
    def of(cls, shape: TriangleMesh, skin: TriangleMesh) -> Follower:
        """Attach a shape to its outer surface."""
        divided = bendable(shape)
        return cls(divided, Attachment.of(divided.mesh.vertices, skin))

    def moved(self, skin: MovedShape) -> MovedShape:
        """Return the shape for its moved outer surface."""
        return MovedShape(self.divided.mesh, self.attachment.followed(skin.vertices), self.divided.parents)


@dataclass(frozen=True)
class SkinnedMotion:
    """A motion of outer surfaces that shapes follow; a :class:`.motion.Motion`.

    Attributes
    ----------
    motion : Motion
        The motion, in which some shapes are replaced by their outer surfaces.
    followers : mapping of int to Follower
        These shapes.
    """

    motion: Motion
    followers: Mapping[int, Follower]

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        found = self.motion.moved(weights)
        for index, follower in self.followers.items():
            if found[index] is not None:
                found[index] = follower.moved(found[index])
        return found


def with_skins(request: MotionRequest, control: Control) -> MotionRequest:
    """Return the request with the outer surfaces of shapes whose bodies overlap; itself if there are none."""
    found = {index: outer_skin(shape, control) for index, shape in enumerate(request.shapes)}
    skins = {index: skin for index, skin in found.items() if skin is not None}
    if not skins:
        return request
    trees = {index: cKDTree(skin.vertices) for index, skin in skins.items()}

    def place(index: int, vertex: int) -> int:
        """Return the vertex of the outer surface that is nearest to a vertex of a shape."""
        if index not in trees:
            return vertex
        return int(trees[index].query(request.shapes[index].vertices[vertex])[1])

    guides = [{index: place(index, vertex) for index, vertex in guide.items()} for guide in request.guides]
    shapes = [skins.get(index, shape) for index, shape in enumerate(request.shapes)]
    return replace(request, shapes=shapes, guides=guides)


def one_body_prevails(shape: TriangleMesh) -> bool:
    """Return whether a connected component has nearly all of the area, so that the others are details of it."""
    areas = component_areas(shape)
    return bool(areas.max(initial=0.0) >= _PREVAILING * areas.sum())


def following(motion: Motion, shapes: Sequence[TriangleMesh], skins: Sequence[TriangleMesh]) -> Motion:
    """Return the motion of shapes whose outer surfaces move.

    Parameters
    ----------
    motion : Motion
        The motion of the outer surfaces.
    shapes : sequence of TriangleMesh
        The shapes.
    skins : sequence of TriangleMesh
        Their outer surfaces, or the same shapes.
    """
    followers = {}
    for index, (shape, skin) in enumerate(zip(shapes, skins, strict=True)):
        if skin is not shape:
            followers[index] = Follower.of(shape, unmoved(motion, len(shapes), index).rest)
    return SkinnedMotion(motion, followers) if followers else motion
