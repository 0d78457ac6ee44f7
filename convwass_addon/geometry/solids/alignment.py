# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Align shapes: translate, rotate and scale them so that a morph between them only changes their form."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..meshes.mesh import TriangleMesh
from .orientation import orient_outward
from .solid_volume import solid_volume

Alignment = Literal["PLACED", "CENTERED", "PRINCIPAL_AXES"]
Scaling = Literal["PLACED", "EQUAL_VOLUME"]

# If the spreads along two axes differ by less than this fraction, the axes are interchangeable.
_EQUAL = 0.02
# Rotations whose match of the third moments is within this fraction of the range count as equally good as the best one,
# unless that one misses a perfect match by less.
_EQUALLY_GOOD = 0.05
# A mesh has a volume if it encloses more than this fraction of its area to the power of 3/2.
_CLEAR = 1e-5
# A shape has an inside if the directed area of its holes, which is the sum over the directed areas of its faces, is at
# most this fraction of the total area. An open hemisphere has 0.5.
_OPEN = 0.4
_SIGNS = np.array([signs for signs in itertools.product((1.0, -1.0), repeat=3)])


@dataclass(frozen=True)
class RigidMove:
    """A rotation and scaling about a point, followed by a translation of that point.

    Attributes
    ----------
    rotation : (3, 3) float64
        Rotation matrix, without reflection.
    scale : float
        Positive.
    center : (3,) float64
        The fixed point, in the space of the shape.
    target : (3,) float64
        Where the fixed point is moved to.
    """

    rotation: NDArray[np.float64]
    scale: float
    center: NDArray[np.float64]
    target: NDArray[np.float64]

    @property
    def matrix(self) -> NDArray[np.float64]:
        """The transformation as a (4, 4) matrix for column vectors."""
        result = np.eye(4)
        result[:3, :3] = self.scale * self.rotation
        result[:3, 3] = self.target - result[:3, :3] @ self.center
        return result

    def moved(self, mesh: TriangleMesh) -> TriangleMesh:
        """Return the transformed mesh."""
        return TriangleMesh(
            (mesh.vertices - self.center) @ (self.scale * self.rotation).T + self.target,
            mesh.faces,
        )


def aligned(
    meshes: Sequence[TriangleMesh],
    alignment: Alignment,
    scaling: Scaling,
    names: Sequence[str] = (),
) -> tuple[RigidMove, ...]:
    """Align shapes to the first one, which stays unchanged.

    Parameters
    ----------
    meshes : sequence of TriangleMesh
        In one space. The enclosed solids are compared, or the surfaces of meshes that enclose nothing.
    alignment : "PLACED", "CENTERED" or "PRINCIPAL_AXES"
        Leave all shapes where they are; move the centers of mass together; or also rotate the axes of inertia onto
        those of the first shape. The third moments determine the directions of the axes, such that longer tails point
        the same way. Where shapes are symmetric and several rotations are equally good, the smallest one is taken.
        Shapes are never mirrored.
    scaling : "PLACED" or "EQUAL_VOLUME"
        Leave the sizes, or give all shapes the volume of the first, as measured by :func:`.solid_volume.solid_volume`.
    names : sequence of str
        Names of the shapes for messages.

    Returns
    -------
    tuple of RigidMove
        One per shape.

    Raises
    ------
    InputError
        A shape has no area, or no volume although equal volumes are requested.
    """
    for index, mesh in enumerate(meshes):
        if not mesh.area > 0.0:
            raise InputError(
                "'{name}' has no area, so it cannot be aligned: all of its faces are lines or points. Give it faces "
                "with an area.",
                name=_name(names, index),
            )
    outward = [orient_outward(mesh) for mesh in meshes]
    solids = [SolidMoments.of(mesh) for mesh in outward]
    first = solids[0]
    scales = _equal_volume_scales(outward, solids, names) if scaling == "EQUAL_VOLUME" else [1.0] * len(solids)
    moves = []
    for index, (solid, scale) in enumerate(zip(solids, scales, strict=True)):
        turns = alignment == "PRINCIPAL_AXES" and index > 0
        rotation = _rotation_onto(solid, first) if turns else np.eye(3)
        target = solid.center if alignment == "PLACED" else first.center
        moves.append(RigidMove(rotation, scale, solid.center, target))
    return tuple(moves)


@dataclass(frozen=True)
class AlignedMeshes:
    """Shapes aligned with the first one.

    Attributes
    ----------
    meshes : list of TriangleMesh
        The aligned shapes.
    moves : tuple of RigidMove or None
        The transformations; None if no shape was moved.
    """

    meshes: list[TriangleMesh]
    moves: tuple[RigidMove, ...] | None


def aligned_meshes(
    meshes: Sequence[TriangleMesh], alignment: Alignment, scaling: Scaling, names: Sequence[str] = ()
) -> AlignedMeshes:
    """Align shapes with the first one; see :func:`aligned`."""
    if (alignment, scaling) == ("PLACED", "PLACED"):
        return AlignedMeshes(list(meshes), None)
    moves = aligned(meshes, alignment, scaling, names)
    return AlignedMeshes([move.moved(mesh) for move, mesh in zip(moves, meshes, strict=True)], moves)


@dataclass(frozen=True)
class SolidMoments:
    """Moments of a shape about its center: of its volume, or of its surface if it has no volume.

    The second and third moments, (3, 3) and (3, 3, 3), are normalized to mass 1.
    """

    has_volume: bool
    center: NDArray[np.float64]
    second: NDArray[np.float64]
    third: NDArray[np.float64]

    @classmethod
    def of(cls, outward: TriangleMesh) -> SolidMoments:
        """Compute the moments of a mesh whose faces point outward."""
        corners = outward.corners
        directed = _directed_areas(corners)
        areas = np.linalg.norm(directed, axis=1)
        # Relative to the center of the surface, the volume of an open shape does not depend on its orientation.
        middle = areas @ corners.mean(axis=1) / areas.sum()
        corners = corners - middle
        volumes = np.einsum("mi,mi->m", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
        volume = abs(float(volumes.sum()))
        hole = float(np.linalg.norm(directed.sum(axis=0)))
        if volume > _CLEAR * areas.sum() ** 1.5 and hole < _OPEN * areas.sum():
            tetrahedra = np.concatenate([corners, np.zeros((len(corners), 1, 3))], axis=1)
            solid = cls._of_simplices(tetrahedra, volumes / volumes.sum(), True, middle)
            if np.linalg.eigvalsh(solid.second)[0] > 0.0:
                return solid
        return cls._of_simplices(corners, areas / areas.sum(), False, middle)

    @classmethod
    def _of_simplices(
        cls, simplices: NDArray[np.float64], sizes: NDArray[np.float64], has_volume: bool, origin: NDArray[np.float64]
    ) -> SolidMoments:
        center = np.einsum("m,mi->i", sizes, simplices.mean(axis=1))
        second, third = _moments(simplices - center, sizes)
        return cls(has_volume, center + origin, second, third)


def _directed_areas(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the normals of triangles, (m, 3), with their areas as lengths."""
    a, b, c = np.moveaxis(corners, 1, 0)
    return 0.5 * np.cross(b - a, c - a)


def _moments(
    simplices: NDArray[np.float64], sizes: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the second and third moments about the origin of simplices, (m, corners, 3), of signed sizes (m,).

    The mean of a monomial over a simplex follows from the complete homogeneous polynomials of its corners.
    """
    corners = simplices.shape[1]
    total = simplices.sum(axis=1)
    squares = np.einsum("mvi,mvj->mij", simplices, simplices)
    second = np.einsum("m,mi,mj->ij", sizes, total, total) + np.einsum("m,mij->ij", sizes, squares)
    mixed = np.einsum("m,mi,mjk->ijk", sizes, total, squares)
    third = np.einsum("m,mi,mj,mk->ijk", sizes, total, total, total, optimize=True)
    third += mixed + mixed.transpose(1, 0, 2) + mixed.transpose(1, 2, 0)
    third += 2.0 * np.einsum("m,mvi,mvj,mvk->ijk", sizes, simplices, simplices, simplices, optimize=True)
    return second / (corners * (corners + 1)), third / (corners * (corners + 1) * (corners + 2))


def _equal_volume_scales(
    outward: Sequence[TriangleMesh], solids: Sequence[SolidMoments], names: Sequence[str]
) -> list[float]:
    for index, solid in enumerate(solids):
        if not solid.has_volume:
            raise InputError(
                "'{name}' encloses no volume, so it cannot be scaled to that of the others. Give it thickness, or "
                "set the scale to as placed.",
                name=_name(names, index),
            )
    volumes = [solid_volume(mesh) for mesh in outward]
    return [float(np.cbrt(volumes[0] / volume)) for volume in volumes]


def _name(names: Sequence[str], index: int) -> str:
    return names[index] if names else f"Shape {index + 1}"


def _rotation_onto(solid: SolidMoments, first: SolidMoments) -> NDArray[np.float64]:
    """Return the rotation, (3, 3), of the axes of one solid onto those of another."""
    own, goal = _axes(solid.second), _axes(first.second)
    goal_axes = _resolved_axes(goal, own.directions)
    own_axes = _resolved_axes(own, goal_axes)
    turns = np.array([(goal_axes * signs) @ own_axes.T for signs in _SIGNS])
    turns = turns[np.linalg.det(turns) > 0.0]
    moved = np.einsum("tai,tbj,tck,ijk->tabc", turns, turns, turns, solid.third, optimize=True)
    size = np.linalg.norm(solid.third) * np.linalg.norm(first.third)
    match = np.einsum("tabc,abc->t", moved, first.third) / max(size, np.finfo(float).tiny)
    # Of copies, the horse upside down matches with 0.92, and the man back to front with 0.97.
    worse = min(_EQUALLY_GOOD * np.ptp(match), max(1.0 - match.max(), 0.0))
    as_good = match >= match.max() - worse - _negligible(solid, first)
    angles = np.einsum("taa->t", turns)
    return turns[np.argmax(np.where(as_good, angles, -np.inf))]


def _negligible(solid: SolidMoments, first: SolidMoments) -> float:
    """Difference of matches that is insignificant: any difference if a shape is symmetric about its center."""
    skews = [np.linalg.norm(one.third) / np.trace(one.second) ** 1.5 for one in (solid, first)]
    return np.inf if min(skews) < 1e-4 else 1e-9


@dataclass(frozen=True)
class _Axes:
    """Principal directions as columns, (3, 3), by decreasing spread, in groups of nearly equal spread."""

    directions: NDArray[np.float64]
    groups: tuple[tuple[int, ...], ...]


def _axes(second: NDArray[np.float64]) -> _Axes:
    values, vectors = np.linalg.eigh(second)
    spreads, directions = np.sqrt(np.maximum(values[::-1], 0.0)), vectors[:, ::-1]
    groups: list[list[int]] = [[0]]
    for index in (1, 2):
        if spreads[index - 1] - spreads[index] <= _EQUAL * spreads[0]:
            groups[-1].append(index)
        else:
            groups.append([index])
    return _Axes(directions, tuple(map(tuple, groups)))


def _resolved_axes(axes: _Axes, near: NDArray[np.float64]) -> NDArray[np.float64]:
    """Choose the directions within groups of equal spread that are closest to the columns of `near`."""
    directions = axes.directions.copy()
    for group in axes.groups:
        if len(group) > 1:
            own, wanted = directions[:, group], near[:, group]
            u, _, vt = np.linalg.svd(own.T @ wanted)
            directions[:, group] = own @ u @ vt
    return directions
