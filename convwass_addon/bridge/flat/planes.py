# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Planes of flat shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from mathutils import Matrix, Quaternion
from numpy.typing import NDArray

# Largest distance of points from their plane, relative to their extent.
FLATNESS = 1e-3
# Normals are parallel if the sine of their angle is below this.
_PARALLEL = 1e-3


@dataclass(frozen=True)
class Plane:
    """A plane with its own coordinates.

    Attributes
    ----------
    origin : (3,) float64
        World space.
    axes : (3, 3) float64
        Columns: X and Y direction in the plane, and the normal; orthonormal and right-handed.
    """

    origin: NDArray[np.float64]
    axes: NDArray[np.float64]

    def coordinates(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert points in world space, (n, 3), to plane coordinates, (n, 2)."""
        return (points - self.origin) @ self.axes[:, :2]

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Transform from plane coordinates and height to world space, (4, 4)."""
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = self.axes, self.origin
        return found


def plane_of(points: NDArray[np.float64], matrix: NDArray[np.float64]) -> Plane | None:
    """Find the plane of points, (n, 3) in world space, with axes close to those of their object.

    Parameters
    ----------
    points : (n, 3) float64
        At least one point.
    matrix : (4, 4)
        World matrix of the object, possibly singular.

    Returns
    -------
    Plane or None
        Its origin is in the middle of the points; None if these deviate by more than a thousandth of their extent.
    """
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    about = points - middle
    extent = float(np.abs(about).max())
    own = _frame(matrix[:3, 0], matrix[:3, 1])
    if own is None or not _is_level(about @ own[:, 2], extent):
        # A subset of a long list is enough to determine the plane.
        _, _, directions = np.linalg.svd((about - about.mean(axis=0))[:: 1 + len(about) // 20_000], full_matrices=False)
        normal = directions[2] if len(directions) > 2 else np.cross(directions[0], directions[-1])
        if normal @ matrix[:3, 2] < 0:
            normal = -normal
        own = _upright(normal, matrix)
    if own is None or not _is_level(about @ own[:, 2], extent):
        return None
    # The middle of the bounds of a tilted shape is not in its plane.
    heights = about @ own[:, 2]
    return Plane(middle + 0.5 * (heights.min() + heights.max()) * own[:, 2], own)


def common_planes(planes: Sequence[Plane]) -> list[Plane]:
    """Give parallel planes the axes of the first plane, and origins on its normal.

    Positions of shapes relative to each other are then preserved in plane coordinates. Other planes are not changed.
    """
    first = planes[0]
    found = []
    for plane in planes:
        if np.linalg.norm(np.cross(plane.axes[:, 2], first.axes[:, 2])) > _PARALLEL:
            found.append(plane)
            continue
        height = (plane.origin - first.origin) @ first.axes[:, 2]
        found.append(Plane(first.origin + height * first.axes[:, 2], first.axes))
    return found


def blended_plane(planes: Sequence[Plane], weights: Sequence[float]) -> Plane:
    """Interpolate planes: the weighted mean of origins, and of rotations as quaternions."""
    origin = np.asarray(weights) @ np.stack([plane.origin for plane in planes])
    turns = [Matrix(plane.axes.tolist()).to_quaternion() for plane in planes]
    total = Quaternion((0.0, 0.0, 0.0, 0.0))
    for turn, weight in zip(turns, weights, strict=True):
        # Quaternions of opposite sign are the same rotation.
        total += turn * (weight if turn.dot(turns[0]) >= 0 else -weight)
    if total.magnitude < 1e-6:
        total = turns[int(np.argmax(weights))]
    return Plane(origin, np.array(total.normalized().to_matrix(), dtype=np.float64))


def _is_level(heights: NDArray[np.float64], extent: float) -> bool:
    """Return whether points are in one plane, by their heights above a parallel one."""
    return bool(0.5 * np.ptp(heights) <= FLATNESS * extent)


def _upright(normal: NDArray[np.float64], matrix: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Axes for a given normal, with X and Y close to those of an object."""
    along = [matrix[:3, axis] - (matrix[:3, axis] @ normal) * normal for axis in range(3)]
    lengths = [np.linalg.norm(one) for one in along]
    if lengths[0] >= 0.1 * max(lengths):
        return _frame(along[0], np.cross(normal, along[0]))
    # The object's X axis is normal to the plane; use its Y axis instead.
    chosen = along[1] if lengths[1] >= lengths[2] else along[2]
    return _frame(np.cross(chosen, normal), chosen)


def _frame(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Orthonormal right-handed axes from two directions, or None if they are degenerate."""
    normal = np.cross(x, y)
    sizes = np.linalg.norm(x), np.linalg.norm(normal)
    if min(sizes) <= 0 or not np.isfinite(sizes).all():
        return None
    first, third = x / sizes[0], normal / sizes[1]
    return np.stack([first, np.cross(third, first), third], axis=1)
