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

from ...geometry.deformation.upright_turns import rotation_about_z
from ...geometry.meshes.mesh import is_level
from ...geometry.meshes.mirror_planes import MirrorPlane, mirror_planes
from ...geometry.meshes.point_tree import point_tree
from ...geometry.plane.plane_angles import signed_angles
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

        The shapes may face different ways. Of several planes, those are taken that most guides agree with, or else
        those that are most nearly parallel. Flat shapes get no images.

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
        tried = product(mirror_planes(one.mesh), mirror_planes(other.mesh))
        found = [_Reflection.of((one, other), planes, pairs) for planes in tried]
        best = max(found, key=lambda own: (own.agrees.sum(), own.parallel), default=None)
        if best is None or not best.agrees.any():
            return cls(pairs)
        sides = best.sides[best.agrees]
        normal, other_normal = (plane.normal for plane in best.planes)
        turn = _turn_between(normal, other_normal * (1.0 if sides.sum() >= 0.0 else -1.0))
        are_sure = best.parallel < np.cos(_SMALL) and not sides.min() < 0.0 < sides.max()
        return cls(np.concatenate([pairs, best.added]), turn, bool(are_sure))


@dataclass(frozen=True)
class _Reflection:
    """Guides on two shapes, reflected in a plane of each.

    Attributes
    ----------
    planes : (MirrorPlane, MirrorPlane)
        The planes.
    sides : (k,) float64
        1 for guides whose ends are on the same sides of both planes, as their normals tell, -1 for opposite sides, and
        0 if an end is not beside its plane.
    agrees : (k,) bool
        Whether guides are beside both planes, and their images are other guides, or apart from all.
    added : (m, 2) int64
        The images that are apart from all guides.
    """

    planes: tuple[MirrorPlane, MirrorPlane]
    sides: NDArray[np.float64]
    agrees: NDArray[np.bool_]
    added: NDArray[np.int64]

    @classmethod
    def of(
        cls, shapes: tuple[Carrier, Carrier], planes: tuple[MirrorPlane, MirrorPlane], pairs: NDArray[np.int64]
    ) -> _Reflection:
        """Reflect guides, (k, 2)."""
        sides, is_there, images, same = np.ones(len(pairs)), np.ones(len(pairs), bool), np.empty_like(pairs), []
        for k, (shape, plane) in enumerate(zip(shapes, planes, strict=True)):
            points, used = shape.mesh.vertices[pairs[:, k]], np.flatnonzero(shape.mesh.is_used)
            mirrored = plane.mirrored(points)
            away, nearest = point_tree(shape.mesh.vertices[used]).query(mirrored)
            images[:, k] = used[nearest]
            is_there &= away < _ON_SHAPE * shape.mesh.root_area
            same.append(np.linalg.norm(mirrored[:, None] - points, axis=2) < _SAME * shape.mesh.root_area)
            sides *= _beside(shape, plane, pairs[:, k])
        are_new = (sides != 0.0) & is_there & ~(same[0] | same[1]).any(axis=1)
        are_known = (sides != 0.0) & (same[0] & same[1]).any(axis=1)
        return cls(planes, sides, are_new | are_known, images[are_new])

    @property
    def parallel(self) -> float:
        """How nearly parallel the planes are as the shapes stand, from 0 to 1."""
        return float(abs(self.planes[0].normal @ self.planes[1].normal))


def agreeing_sides(one: Carrier, other: Carrier, pairs: NDArray[np.int64]) -> MirroredSides | None:
    """Return the left and right sides of two shapes as they stand, unless guides, (k, 2), contradict them."""
    sides = MirroredSides.of(one.mesh, other.mesh)
    if sides is None:
        return None
    here, there = (_beside(*own) for own in zip((one, other), sides.planes, pairs.T, strict=True))
    return None if (here != there).any() else sides


def _turn_between(normal: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return the rotation about the z axis from one horizontal direction to another, unless it is small."""
    angle = signed_angles(normal[:2], other[:2])
    return rotation_about_z(angle) if abs(angle) > _SMALL else None


def _beside(shape: Carrier, plane: MirrorPlane, vertices: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return on which side of a plane vertices are, (k,): -1, 0 or 1."""
    heights = plane.heights(shape.mesh.vertices[vertices]) / shape.mesh.root_area
    return np.sign(heights) * (np.abs(heights) > _BESIDE)
