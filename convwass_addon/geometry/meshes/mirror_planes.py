# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertical planes in which upright shapes are nearly their own mirror images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..arrays.chunks import chunks
from .closest_points import TriangleSamples
from .mesh import TriangleMesh
from .point_tree import point_tree

# Number of planes tried, number of points of a shape that are mirrored, and the largest distance that is measured.
_PLANES, _SAMPLES, _FARTHEST = 24, 500, 0.15
# Length in sizes of the surface that the difference of unit normals counts as.
_NORMALS = 0.2
# A shape is nearly its own mirror image if the images are on average this close to it, in sizes of the surface.
# Animals, furniture and people with hanging arms have 0.005 to 0.035 in their planes, and most have 0.07 to 0.15 in
# others. It is clearly so up to the second number; an octopus with arms in any poses has 0.039.
_NEARLY, _CLEARLY = 0.045, 0.03
# Of several such planes, only those count in which the images are at most this factor and this distance farther away
# than in the best one: people are nearly symmetric from front to back, too. A shape that looks alike from all sides has
# more than so many planes, which say nothing.
_FACTOR, _SLACK, _MOST = 1.1, 3e-3, 8
# Points mirrored together: in most planes, half of all points say that a shape is not nearly symmetric.
_AT_ONCE = 50


@dataclass(frozen=True)
class MirrorPlane:
    """A plane.

    Attributes
    ----------
    point : (3,) float64
        Any point of it.
    normal : (3,) float64
        Of unit length.
    """

    point: NDArray[np.float64]
    normal: NDArray[np.float64]

    def heights(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the signed distances of points, (n, 3), from the plane, (n,)."""
        return (points - self.point) @ self.normal

    def mirrored(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the mirror images of points, (n, 3)."""
        return points - 2.0 * self.heights(points)[:, None] * self.normal

    def mirrored_directions(self, directions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the mirror images of directions, (n, 3)."""
        return directions - 2.0 * (directions @ self.normal)[:, None] * self.normal


MirrorPlanes = tuple[MirrorPlane, MirrorPlane]
"""The planes of two shapes."""


def common_mirror_planes(first: TriangleMesh, second: TriangleMesh) -> MirrorPlanes | None:
    """Return parallel vertical planes through the centers of two shapes in which both are nearly symmetric.

    Parameters
    ----------
    first, second : TriangleMesh
        Oriented outward.

    Returns
    -------
    (MirrorPlane, MirrorPlane) or None
        With the same normal; None if there is no such direction, or if a shape looks alike from all sides.
    """
    worse = np.maximum(_counted_asymmetries(first), _counted_asymmetries(second))
    best = int(worse.argmin())
    if not np.isfinite(worse[best]):
        return None
    normal = _normals()[best]
    return MirrorPlane(first.area_center, normal), MirrorPlane(second.area_center, normal)


def mirror_planes(mesh: TriangleMesh) -> list[MirrorPlane]:
    """Return the vertical planes through the center of a shape in which it is clearly symmetric.

    Parameters
    ----------
    mesh : TriangleMesh
        Oriented outward.

    Returns
    -------
    list of MirrorPlane
        Of neighboring planes, the best one; none if the shape looks alike from all sides.
    """
    found = _counted_asymmetries(mesh)
    best = (found <= _CLEARLY) & (found <= np.roll(found, 1)) & (found < np.roll(found, -1))
    return [MirrorPlane(mesh.area_center, normal) for normal in _normals()[best]]


def _counted_asymmetries(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return the asymmetries in the planes in which a shape is nearly symmetric; infinite in others, (planes,)."""
    found = _asymmetries(mesh)
    counted = found <= min(_NEARLY, _FACTOR * found.min() + _SLACK)
    return np.where(counted, found, np.inf) if counted.sum() <= _MOST else np.full(_PLANES, np.inf)


def _asymmetries(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return the mean distances of a shape from its mirror images, (planes,), in sizes of the surface.

    Where a shape is not nearly symmetric, they are too short.
    """
    samples, size = TriangleSamples.of(mesh.corners), mesh.root_area
    points = (samples.points - mesh.area_center) / size
    normals = mesh.face_normals[samples.triangles]
    tree = point_tree(np.hstack([points, _NORMALS * normals]))
    # Small triangles have more samples than large ones of the same total area.
    shares = samples.divided(mesh.face_areas) / mesh.area
    chosen = np.random.default_rng(0).choice(len(points), _SAMPLES, p=shares)
    own, facing = points[chosen], normals[chosen]
    return np.array([_mean_distance(tree, own, facing, normal) for normal in _normals()])


def _mean_distance(
    tree: cKDTree, points: NDArray[np.float64], facing: NDArray[np.float64], normal: NDArray[np.float64]
) -> float:
    """Return the mean distance of the mirror images of points with normals, (n, 3) each, from those of a search tree.

    If it is larger than for any shape that is nearly symmetric, return a lower bound that is, too.
    """
    images, turned = (values - 2.0 * (values @ normal)[:, None] * normal for values in (points, facing))
    asked, found, total = np.hstack([images, _NORMALS * turned]), [], 0.0
    for some in chunks(len(points), _AT_ONCE):
        away = tree.query(asked[some], distance_upper_bound=_FARTHEST)[0]
        found.append(np.minimum(away, _FARTHEST))
        total += float(found[-1].sum())
        if total > _NEARLY * len(points):
            return total / len(points)
    return float(np.concatenate(found).mean())


def _normals() -> NDArray[np.float64]:
    """Return the normals of the planes that are tried, (planes, 3)."""
    angles = np.pi * np.arange(_PLANES) / _PLANES
    return np.stack([np.cos(angles), np.sin(angles), np.zeros(_PLANES)], axis=1)
