# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The left and right sides of two shapes that are nearly symmetric in a common plane, and whether a map keeps them.

Surfaces look the same on both sides, so a map may send a left leg to a right one, two legs to one, or the head to a
wing. Animals, people and most things are symmetric, and a map that suits their kind commutes with the reflections.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays.steps import linear_step
from ...geometry.meshes.closest_points import ClosestPoints
from ...geometry.meshes.facing_points import FacingPointFinder
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.mirror_planes import MirrorPlanes, common_mirror_planes

# A map commutes with the reflections where both ways lead to points that are this close, in sizes of the surface.
_CLOSE = 0.12
# A place is symmetric if its mirror image is this close to the surface, in sizes of it, and is not from the second
# distance on. A leg that is ahead of the other one is not symmetric.
_SYMMETRIC, _ASYMMETRIC = 0.025, 0.05
# Weight of heights relative to sides. Without, a cactus becomes a child that stands on its head. With half, it stays
# upright, as does a chair that becomes a man; from 0.7 on, a dog no longer becomes a bird symmetrically.
_UPRIGHT = 0.5

Groups = dict[str, NDArray[np.float64]]
"""Weights of the vertices of a mesh, (n,), by the name of the group."""


def relative_heights(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return how far up the vertices of a shape are, from 0 to 1, (n,)."""
    low, high = mesh.bounds[:, 2]
    # Vertices without triangles may be anywhere.
    return np.clip((mesh.vertices[:, 2] - low) / max(high - low, np.finfo(float).tiny), 0.0, 1.0)


def height_groups(mesh: TriangleMesh) -> Groups:
    """Return how far up the vertices of a shape are, from 0 to 0.5, as group weights."""
    return {"up": _UPRIGHT * relative_heights(mesh)}


@dataclass(frozen=True)
class MirroredSides:
    """Parallel planes in which two shapes are nearly symmetric.

    Attributes
    ----------
    meshes : (TriangleMesh, TriangleMesh)
        The shapes.
    planes : (MirrorPlane, MirrorPlane)
        Their planes.
    """

    meshes: tuple[TriangleMesh, TriangleMesh]
    planes: MirrorPlanes

    @classmethod
    def of(cls, first: TriangleMesh, second: TriangleMesh) -> MirroredSides | None:
        """Return the sides of two shapes as they stand; None if they are not symmetric in a common plane."""
        planes = common_mirror_planes(first, second)
        return None if planes is None else cls((first, second), planes)

    def groups(self, k: int) -> Groups:
        """Return how far to the left, to the right and up the vertices of shape k are, as group weights."""
        mesh = self.meshes[k]
        beside = self.planes[k].heights(mesh.vertices)
        # Vertices without triangles may be anywhere.
        farthest = max(np.abs(beside[mesh.is_used]).max(), np.finfo(float).tiny)
        beside = np.clip(beside / farthest, -1.0, 1.0)
        return {"left": np.maximum(beside, 0.0), "right": np.maximum(-beside, 0.0), **height_groups(mesh)}

    @property
    def swapped(self) -> MirroredSides:
        """The sides of the same two shapes in the other order."""
        return MirroredSides(self.meshes[::-1], self.planes[::-1])

    @property
    def both_groups(self) -> tuple[Groups, Groups]:
        """The groups of both shapes."""
        return self.groups(0), self.groups(1)

    @cached_property
    def _finders(self) -> list[FacingPointFinder]:
        """Finders of points on both shapes."""
        return [FacingPointFinder(mesh) for mesh in self.meshes]

    @cached_property
    def _images(self) -> list[ClosestPoints]:
        """The mirror images of the vertices of both shapes, on the shapes: of an ear, on the same side of the other."""
        found = []
        for finder, mesh, plane in zip(self._finders, self.meshes, self.planes, strict=True):
            images, normals = plane.mirrored(mesh.vertices), plane.mirrored_directions(mesh.vertex_normals)
            found.append(finder.find(images, normals))
        return found

    @cached_property
    def _asymmetries(self) -> list[NDArray[np.float64]]:
        """Distances of the mirror images of the vertices of both shapes from the shapes, (n,), in sizes."""
        return [images.distances / mesh.root_area for images, mesh in zip(self._images, self.meshes, strict=True)]

    def mirrored(self, k: int, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return values at the vertices of shape k, (n, ...), at the mirror images of the vertices instead."""
        corners = values.reshape(len(values), -1)[self.meshes[k].faces]
        return self._images[k].interpolated(corners).reshape(values.shape)

    def mirrored_map(self, k: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what a map of shape k, given by points for its vertices, (n, 3), is in the mirror."""
        return self.planes[1 - k].mirrored(self.mirrored(k, points))

    def apart(self, k: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distances of a map from what it is in the mirror, (n,), in sizes of the surface mapped to."""
        return self._sizes_between(k, points, self.mirrored_map(k, points))

    def _sizes_between(self, k: int, points: NDArray[np.float64], images: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distances of two maps of shape k, (n,), in sizes of the surface mapped to."""
        return np.linalg.norm(points - images, axis=1) / self.meshes[1 - k].root_area

    def evened_map(self, k: int, points: NDArray[np.float64], costs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return a map of shape k that is its own mirror image where both shapes are.

        Parameters
        ----------
        k : int
            The shape that is mapped.
        points : (n, 3) float64
            Points on or near the other one, for the vertices of this one.
        costs : (n,) float64
            Costs of these points.

        Returns
        -------
        (n, 3) float64
            The mean of the map and its mirror image; where they are apart, the one of lower cost.
        """
        image, elsewhere = self.mirrored_map(k, points), self.mirrored(k, costs)
        best = np.where((elsewhere < costs)[:, None], image, points)
        even = np.where((self._sizes_between(k, points, image) <= _CLOSE)[:, None], 0.5 * (points + image), best)
        return points + self._symmetric(k, points)[:, None] * (even - points)

    def _symmetric(self, k: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where both shapes are symmetric, from 0 to 1: the vertices of shape k, and the points mapped to."""
        there = self._finders[1 - k].find_closest(points)
        corners = self._asymmetries[1 - k][self.meshes[1 - k].faces]
        larger = np.maximum(self._asymmetries[k], there.interpolated(corners[..., None])[:, 0])
        return linear_step(larger, _ASYMMETRIC, _SYMMETRIC)

    def kept(self, maps: Sequence[NDArray[np.float64]]) -> float:
        """Return the share of the surface where maps are close to what they are in the mirror.

        Parameters
        ----------
        maps : two (n, 3) float64
            For the vertices of each shape, points on or near the other one.

        Returns
        -------
        float
            From 0 to 1, the smaller one of both directions.
        """
        return min(
            float(mesh.vertex_areas @ (self.apart(k, points) <= _CLOSE) / mesh.area)
            for k, (mesh, points) in enumerate(zip(self.meshes, maps, strict=True))
        )
