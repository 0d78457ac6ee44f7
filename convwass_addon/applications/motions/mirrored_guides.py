# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guides on symmetric shapes, completed by their mirror images.

A user who marks the left hands of two people means that the right hands belong together, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import is_level
from ...geometry.mirror_planes import MirrorPlane, mirror_planes
from ...geometry.point_tree import point_tree
from ...geometry.upright_turns import rotation_about_z
from .carriers import Carrier
from .mirrored_sides import MirroredSides

# In sizes of the surface: points that are farther than the first distance from a plane are beside it, mirror images
# that are farther than the second one from all vertices are not on the shape, and those nearer than the third one to
# a guide are at the same place.
_BESIDE, _ON_SHAPE, _SAME = 0.05, 0.08, 0.1
# Planes of the same direction, as far as mirror planes are known.
_SMALL = np.radians(10.0)


@dataclass(frozen=True)
class MirroredGuides:
    """Guides on two shapes, with their mirror images.

    Attributes
    ----------
    pairs : (k, 2) int64
        Corresponding vertices of the meshes of both shapes.
    turn : (3, 3) float64 or None
        The rotation about the z axis after which the mirror planes of both shapes are parallel, and guides on the same
        side. None if that is so as the shapes stand, or if no guides are beside mirror planes.
    are_askew : bool
        Whether mirror planes are not parallel as the shapes stand, and no guides contradict each other about the turn,
        so that it is beyond doubt.
    """

    pairs: NDArray[np.int64]
    turn: NDArray[np.float64] | None = None
    are_askew: bool = False

    @classmethod
    def of(cls, one: Carrier, other: Carrier, pairs: NDArray[np.int64]) -> MirroredGuides:
        """Add the mirror images of guides that are beside both planes, unless there is a guide near one of their ends.

        The shapes may face different ways. Of several planes, those are taken that add most images, or else those that
        are most nearly parallel. Flat shapes get no images.

        Parameters
        ----------
        one, other : Carrier
            The two shapes.
        pairs : (k, 2) int64
            Corresponding vertices of their meshes.
        """
        # In their plane, flat shapes do not face any way.
        if not len(pairs) or (is_level(one.mesh.vertices) and is_level(other.mesh.vertices)):
            return cls(pairs)
        best, images, parallel = None, pairs[:0], 0.0
        for planes in product(mirror_planes(one.mesh), mirror_planes(other.mesh)):
            own, cosine = _images((one, other), planes, pairs), abs(planes[0].normal @ planes[1].normal)
            if (len(own), cosine) > (len(images), parallel):
                best, images, parallel = planes, own, cosine
        if not len(images):
            return cls(pairs)
        here, there = (_beside(*own) for own in zip((one, other), best, pairs.T, strict=True))
        same = here * there
        turn = _turn_between(best[0].normal, best[1].normal * (1.0 if same.sum() >= 0.0 else -1.0))
        are_sure = parallel < np.cos(_SMALL) and not same.min() < 0.0 < same.max()
        return cls(np.concatenate([pairs, images]), turn, bool(are_sure))


def agreeing_sides(one: Carrier, other: Carrier, pairs: NDArray[np.int64]) -> MirroredSides | None:
    """Return the left and right sides of two shapes as they stand, unless guides, (k, 2), contradict them."""
    sides = MirroredSides.of(one.mesh, other.mesh)
    if sides is None:
        return None
    here, there = (_beside(*own) for own in zip((one, other), sides.planes, pairs.T, strict=True))
    return None if (here != there).any() else sides


def _turn_between(normal: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return the rotation about the z axis from one horizontal direction to another, unless it is small."""
    angle = np.arctan2(normal[0] * other[1] - normal[1] * other[0], normal @ other)
    return rotation_about_z(angle) if abs(angle) > _SMALL else None


def _beside(shape: Carrier, plane: MirrorPlane, vertices: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return on which side of a plane vertices are, (k,): -1, 0 or 1."""
    heights = plane.heights(shape.mesh.vertices[vertices]) / shape.size
    return np.sign(heights) * (np.abs(heights) > _BESIDE)


def _images(
    shapes: tuple[Carrier, Carrier], planes: tuple[MirrorPlane, MirrorPlane], pairs: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the mirror images of pairs, as far as there are no pairs near them, (m, 2)."""
    chosen, images = np.ones(len(pairs), bool), np.empty_like(pairs)
    for k, (shape, plane) in enumerate(zip(shapes, planes, strict=True)):
        points, used = shape.mesh.vertices[pairs[:, k]], np.unique(shape.mesh.faces)
        mirrored = plane.mirrored(points)
        away, nearest = point_tree(shape.mesh.vertices[used]).query(mirrored)
        images[:, k] = used[nearest]
        apart = np.linalg.norm(mirrored[:, None] - points, axis=2).min(axis=1)
        chosen &= (away < _ON_SHAPE * shape.size) & (apart > _SAME * shape.size)
    return images[chosen]
