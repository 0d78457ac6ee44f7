# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes as triangulated sheets, which move like surfaces and carry their boundaries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.closest_points import ClosestPointFinder
from ...geometry.meshes.edges import edge_ends, edge_use
from ...geometry.meshes.mesh import TriangleMesh, joined_meshes
from ...geometry.plane.planar_fill import Boundary
from ...geometry.remeshing.planar_mesh import planar_mesh
from ..motions.motion import MovedShape

# Edge lengths of the triangles and of carried boundaries, as fractions of the square root of the area: strokes whose
# width is a tenth of the letter's height have three triangles across.
_TRIANGLES, _BOUNDARY = 0.08, 0.02


@dataclass(frozen=True)
class Sheet:
    """The area of a part of a flat shape, as a mesh in the plane z = 0.

    Attributes
    ----------
    mesh : TriangleMesh
        The triangles.
    boundary : Boundary
        The boundary, with short edges.
    starts, ends : AttachedPoints
        The ends of the boundary's edges, attached to the triangles.
    """

    mesh: TriangleMesh
    boundary: Boundary
    starts: AttachedPoints
    ends: AttachedPoints

    @classmethod
    def of(cls, boundary: Boundary) -> Sheet:
        """Triangulate the interior of a boundary, which must have an area."""
        size = boundary.root_area
        return cls.attached(boundary, planar_mesh(boundary, _TRIANGLES * size))

    @classmethod
    def attached(cls, boundary: Boundary, mesh: TriangleMesh) -> Sheet:
        """Attach a boundary to triangles that approximately fill it."""
        fine = boundary.divided(_BOUNDARY * boundary.root_area)
        finder = ClosestPointFinder(mesh.corners)
        attached = (AttachedPoints.of(points, mesh, finder) for points in (fine.starts, fine.ends))
        return cls(mesh, fine, *attached)

    @classmethod
    def of_triangles(cls, mesh: TriangleMesh) -> Sheet:
        """Return triangles, which may have no area, as a sheet that their own edges bound."""
        use = edge_use(mesh.faces)
        is_rim = use.count == 1
        owners, rim = use.face[use.start][is_rim], edge_ends(mesh.faces, use)[is_rim]
        starts, ends = (AttachedPoints.corners(mesh, owners, own) for own in rim.T)
        return cls(mesh, Boundary(starts.on(mesh), ends.on(mesh)), starts, ends)

    @classmethod
    def joined(cls, sheets: Sequence[Sheet]) -> Sheet:
        """Return several sheets, which may overlap, as one."""
        firsts = np.cumsum([0, *(len(own.mesh.faces) for own in sheets)])
        boundary = Boundary.joined([own.boundary for own in sheets])
        starts, ends = (
            AttachedPoints(
                np.concatenate([points.triangles + first for points, first in zip(each, firsts, strict=False)]),
                np.concatenate([points.shares for points in each]),
            )
            for each in ([own.starts for own in sheets], [own.ends for own in sheets])
        )
        return cls(joined_meshes([own.mesh for own in sheets]), boundary, starts, ends)

    def moved(self, shape: MovedShape) -> Boundary:
        """Return the boundary of the moved sheet."""
        moved = TriangleMesh(shape.vertices[: len(self.mesh.vertices)], self.mesh.faces)
        return Boundary(self.starts.on(moved), self.ends.on(moved))


@dataclass(frozen=True)
class AttachedPoints:
    """Points of the plane that move with nearby triangles.

    Attributes
    ----------
    triangles : (n,) int64
        The closest triangle of each point.
    shares : (n, 3) float64
        Barycentric coordinates in it, of sum 1; negative ones outside.
    """

    triangles: NDArray[np.int64]
    shares: NDArray[np.float64]

    @classmethod
    def of(cls, points: NDArray[np.float64], mesh: TriangleMesh, finder: ClosestPointFinder) -> AttachedPoints:
        """Attach points, (n, 2), to the triangles of a mesh in the plane; `finder` finds points on it."""
        triangles = finder.find(np.column_stack([points, np.zeros(len(points))])).triangles
        corners = mesh.corners[triangles][..., :2]
        # Columns are the edges from the first corner; for a degenerate triangle, its center is used.
        sides = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
        flat = np.abs(np.linalg.det(sides)) <= 1e-9 * np.square(sides).sum(axis=(1, 2))
        sides[flat] = np.eye(2)
        others = np.linalg.solve(sides, (points - corners[:, 0])[:, :, None])[:, :, 0]
        others[flat] = 1.0 / 3.0
        return cls(triangles, np.column_stack([1.0 - others.sum(axis=1), others]))

    @classmethod
    def corners(cls, mesh: TriangleMesh, triangles: NDArray[np.int64], vertices: NDArray[np.int64]) -> AttachedPoints:
        """Attach vertices, (n,), of a mesh to triangles, (n,), of which they are corners."""
        return cls(triangles, (mesh.faces[triangles] == vertices[:, None]).astype(np.float64))

    def on(self, moved: TriangleMesh) -> NDArray[np.float64]:
        """Return the points, (n, 2), on the moved mesh."""
        return np.einsum("nc,ncd->nd", self.shares, moved.corners[self.triangles][..., :2])
