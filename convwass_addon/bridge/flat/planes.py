# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The planes that flat shapes lie in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from mathutils import Matrix, Quaternion
from numpy.typing import NDArray

# Points may leave their plane by this share of their extent.
FLATNESS = 1e-3
# Normals that differ by less, as the sine of the angle, are the same.
_PARALLEL = 1e-3


@dataclass(frozen=True)
class Plane:
    """A plane with its own coordinates.

    Attributes
    ----------
    origin : (3,) float64
        World space.
    axes : (3, 3) float64
        Columns: the directions of X and Y in the plane, and the normal; of length 1 and right-handed.
    """

    origin: NDArray[np.float64]
    axes: NDArray[np.float64]

    def coordinates(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Bring points, (n, 3) in world space, into the plane, (n, 2)."""
        return (points - self.origin) @ self.axes[:, :2]

    @property
    def matrix(self) -> NDArray[np.float64]:
        """What brings coordinates of the plane, with heights above it, to world space, (4, 4)."""
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = self.axes, self.origin
        return found


def plane_of(points: NDArray[np.float64], matrix: NDArray[np.float64]) -> Plane | None:
    """Find the plane of points, (n, 3) in world space, with axes like those of their object.

    Parameters
    ----------
    points : (n, 3) float64
        At least one.
    matrix : (4, 4)
        The object's, to world space; it may be squashed.

    Returns
    -------
    Plane or None
        About the middle of the points; None where they leave it by more than a thousandth of their extent.
    """
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    about = points - middle
    extent = float(np.abs(about).max())
    own = _frame(matrix[:3, 0], matrix[:3, 1])
    if own is None or np.abs(about @ own[:, 2]).max() > FLATNESS * extent:
        # Of long lists of points some tell the plane as well as all.
        _, _, directions = np.linalg.svd(about[:: 1 + len(about) // 20_000], full_matrices=False)
        normal = directions[2] if len(directions) > 2 else np.cross(directions[0], directions[-1])
        if normal @ matrix[:3, 2] < 0:
            normal = -normal
        own = _upright(normal, matrix)
    if own is None or np.abs(about @ own[:, 2]).max() > FLATNESS * extent:
        return None
    return Plane(middle, own)


def common_planes(planes: Sequence[Plane]) -> list[Plane]:
    """Give parallel planes the axes of the first one, and origins above each other.

    What stands apart in them stands apart by as much in their coordinates then. Others stay as they are.
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
    """Place a plane between others: the mean of their origins, and of their turns as quaternions."""
    origin = np.asarray(weights) @ np.stack([plane.origin for plane in planes])
    turns = [Matrix(plane.axes.tolist()).to_quaternion() for plane in planes]
    total = Quaternion((0.0, 0.0, 0.0, 0.0))
    for turn, weight in zip(turns, weights, strict=True):
        # Two quaternions of opposite signs are the same turn.
        total += turn * (weight if turn.dot(turns[0]) >= 0 else -weight)
    if total.magnitude < 1e-6:
        total = turns[int(np.argmax(weights))]
    return Plane(origin, np.array(total.normalized().to_matrix(), dtype=np.float64))


def _upright(normal: NDArray[np.float64], matrix: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Axes about a normal whose X and Y are near to those of an object."""
    along = [matrix[:3, axis] - (matrix[:3, axis] @ normal) * normal for axis in range(3)]
    lengths = [np.linalg.norm(one) for one in along]
    if lengths[0] >= 0.1 * max(lengths):
        return _frame(along[0], np.cross(normal, along[0]))
    # The object's X stands upright: its Y becomes the plane's.
    chosen = along[1] if lengths[1] >= lengths[2] else along[2]
    return _frame(np.cross(chosen, normal), chosen)


def _frame(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Orthonormal right-handed axes from two directions; None where these are none."""
    normal = np.cross(x, y)
    sizes = np.linalg.norm(x), np.linalg.norm(normal)
    if min(sizes) <= 0 or not np.isfinite(sizes).all():
        return None
    first, third = x / sizes[0], normal / sizes[1]
    return np.stack([first, np.cross(third, first), third], axis=1)
