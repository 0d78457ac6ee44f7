# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A triangle mesh as two arrays, with its basic measures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...one_line import one_line
from .normals import cross_coordinates, triangle_normals, vertex_normals

# Relative height of points that lie in a plane.
_LEVEL = 1e-9


@dataclass(frozen=True)
class TriangleMesh:
    """Vertices and triangles.

    Arrays of other types of numbers are converted.

    Attributes
    ----------
    vertices : (n, 3) float64
        Positions; the creator of the mesh defines the space.
    faces : (m, 3) int64
        Vertex indices; counter-clockwise seen from outside.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]

    __repr__ = one_line("vertices", "faces")

    def __post_init__(self) -> None:
        """Convert arrays: measures in single precision are too inexact for samples and systems of equations."""
        object.__setattr__(self, "vertices", np.asarray(self.vertices, np.float64))
        object.__setattr__(self, "faces", np.asarray(self.faces, np.int64))

    @classmethod
    def from_arrays(cls, vertices: ArrayLike, faces: ArrayLike) -> TriangleMesh:
        """Validate and convert arrays to a mesh.

        Raises
        ------
        InputError
            Coordinates that are not finite, indices out of range, or arrays that are not (n, 3) and (m, 3).
        """
        points = np.ascontiguousarray(vertices, dtype=np.float64)
        corners = np.ascontiguousarray(faces, dtype=np.int64)
        if points.ndim != 2 or points.shape[1] != 3 or corners.ndim != 2 or corners.shape[1] != 3:
            raise InputError("A mesh needs vertices of shape (n, 3) and triangles of shape (m, 3).")
        if not np.isfinite(points).all():
            bad = int((~np.isfinite(points)).any(axis=1).sum())
            raise InputError(
                "{bad} of {count} vertices have coordinates that are not numbers (NaN or infinite).",
                bad=bad,
                count=len(points),
            )
        if corners.size and (corners.min() < 0 or corners.max() >= len(points)):
            raise InputError("The triangles refer to vertices that do not exist.")
        return cls(points, corners)

    @cached_property
    def corners(self) -> NDArray[np.float64]:
        """Corner positions of every triangle, (m, 3, 3)."""
        # Three to four times as fast as indexing with an array.
        return self.vertices.take(self.faces, axis=0)

    @property
    def is_used(self) -> NDArray[np.bool_]:
        """Which vertices faces use, (n,)."""
        # NumPy's unique takes seconds for millions of corners.
        found = np.zeros(len(self.vertices), bool)
        found[self.faces] = True
        return found

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """Smallest and largest coordinates over the vertices that faces use, (2, 3)."""
        # NumPy takes several times as long for extremes of rows of three.
        used = np.ascontiguousarray(self.vertices.compress(self.is_used, axis=0).T)
        return np.stack([used.min(axis=1), used.max(axis=1)])

    @property
    def longest_side(self) -> float:
        """Longest side of the bounds."""
        return float(np.ptp(self.bounds, axis=0).max())

    @property
    def diagonal(self) -> float:
        """Diagonal of the bounds."""
        return float(np.linalg.norm(np.ptp(self.bounds, axis=0)))

    @cached_property
    def area(self) -> float:
        """Surface area."""
        return float(self.face_areas.sum())

    @property
    def root_area(self) -> float:
        """Square root of the surface area: a size that does not depend on the pose."""
        return float(np.sqrt(self.area))

    @property
    def area_center(self) -> NDArray[np.float64]:
        """Center of the surface, (3,)."""
        return self.vertex_areas @ self.vertices / self.area

    @cached_property
    def vertex_areas(self) -> NDArray[np.float64]:
        """A third of the area of the triangles around every vertex, (n,)."""
        return np.bincount(self.faces.ravel(), np.repeat(self.face_areas / 3.0, 3), len(self.vertices))

    @property
    def face_areas(self) -> NDArray[np.float64]:
        """Areas of the triangles, (m,)."""
        # Coordinate by coordinate takes a third of the time of np.cross and np.linalg.norm.
        a, b, c = self._corners_by_coordinate(self.vertices)
        x, y, z = cross_coordinates(b - a, c - a)
        return 0.5 * np.sqrt(x * x + y * y + z * z)

    @property
    def vertex_normals(self) -> NDArray[np.float64]:
        """Area-weighted unit normals of the vertices, (n, 3); zero for vertices without triangles."""
        return vertex_normals(self.vertices, self.faces)

    @property
    def face_normals(self) -> NDArray[np.float64]:
        """Unit normals of the triangles, (m, 3); zero for triangles without area."""
        return triangle_normals(self.corners)

    def _corners_by_coordinate(self, vertices: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        """First, second and third corners of the triangles, (3, m) each."""
        points = np.ascontiguousarray(vertices.T)
        return [points.take(corner, axis=1) for corner in np.ascontiguousarray(self.faces.T)]

    @cached_property
    def face_volumes(self) -> NDArray[np.float64]:
        """Signed volumes of the tetrahedra between the triangles and the center of the bounds, (m,)."""
        # Coordinate by coordinate takes half the time of np.cross.
        corners = self._corners_by_coordinate(self.vertices - self.bounds.mean(axis=0))
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners
        return (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0

    @cached_property
    def volume(self) -> float:
        """Signed enclosed volume; positive if the faces point outward."""
        return float(self.face_volumes.sum())

    def moved(self, offset: ArrayLike) -> TriangleMesh:
        """Return the mesh translated by `offset`, (3,)."""
        return TriangleMesh(self.vertices + np.asarray(offset, dtype=np.float64), self.faces)

    def flipped(self) -> TriangleMesh:
        """Return the mesh with the orientation of every face reversed."""
        return TriangleMesh(self.vertices, np.ascontiguousarray(self.faces[:, ::-1]))


def joined_meshes(meshes: Sequence[TriangleMesh]) -> TriangleMesh:
    """Return several meshes as one; vertices and triangles keep their order."""
    counts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + first for mesh, first in zip(meshes, counts[:-1], strict=True)]
    return TriangleMesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def is_level(points: NDArray[np.float64]) -> bool:
    """Return whether points, (n, 3), lie in a plane z = constant, as those of flat shapes do."""
    # Registrations ask in every round; one coordinate after the other takes a tenth of the time.
    x, y, z = (np.ptp(own) for own in points.T)
    return bool(z <= _LEVEL * max(x, y, z))
