# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface of an extruded shape over the triangles of its section."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.barycentric import barycentric_coordinates
from ...geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints
from ...geometry.meshes.edges import edge_ends, edge_use
from ...geometry.meshes.facing_points import FacingPointFinder
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import triangle_normals
from ...geometry.recognition.extrusion import Extrusion
from ...geometry.remeshing.subdivision import with_edges_halved
from ...geometry.solids.hidden_bodies import visible_triangles
from ...geometry.solids.prism import prism
from ..motions.motion import MovedShape

# Triangles whose normals have at least this component along the axis belong to an end of the shape.
_FACING = 0.02
# Edges are halved, up to so many times, where ends are uneven by more than the first number, unless they are shorter
# than the second one; both relative to the square root of the section's area.
_ROUNDS, _UNEVEN, _SHORT = 3, 0.002, 0.006


@dataclass(frozen=True)
class ExtrudedShape:
    """The surface of an extruded shape: the triangles of its section at both ends, and walls between them.

    Attributes
    ----------
    rest : TriangleMesh
        The surface in scene space.
    parents : (m,) int64
        The nearest triangle of the input that faces the same way, for every triangle.
    places : ClosestPoints
        The points of the section's triangles that its vertices lie above.
    heights : (n,) float64
        Places of its vertices along the axis, from 0 to 1.
    frame : (3, 3) float64
        Two directions of the plane and the axis, as rows.
    """

    rest: TriangleMesh
    parents: NDArray[np.int64]
    places: ClosestPoints
    heights: NDArray[np.float64]
    frame: NDArray[np.float64]

    @classmethod
    def of(
        cls, mesh: TriangleMesh, extrusion: Extrusion, frame: NDArray[np.float64], section: TriangleMesh
    ) -> ExtrudedShape:
        """Build the surface.

        Parameters
        ----------
        mesh : TriangleMesh
            The input.
        extrusion : Extrusion
            The extrusion that it nearly is.
        frame : (3, 3)
            Two directions of the plane and the axis, as rows.
        section : TriangleMesh
            Triangles that fill the section, in the plane z = 0, facing up.
        """
        corners = mesh.corners[visible_triangles(mesh)] @ frame.T
        ends = [_End.of(corners, side) for side in (-1.0, 1.0)]
        fine, triangles, heights = _followed(section, ends, extrusion.section.root_area)
        solid = prism(fine, heights)
        rest = TriangleMesh(solid.vertices @ frame, solid.faces)
        parents = FacingPointFinder(mesh).find(rest.corners.mean(axis=1), rest.face_normals).triangles
        shares = barycentric_coordinates(section.corners[triangles], fine.vertices[:, None])[:, 0]
        places = ClosestPoints(np.tile(triangles, 2), np.tile(shares, (2, 1)), np.zeros(len(rest.vertices)))
        relative = (solid.vertices[:, 2] - extrusion.low) / (extrusion.high - extrusion.low)
        return cls(rest, parents, places, relative, frame)

    def moved(self, section: TriangleMesh, place: NDArray[np.float64], left: float) -> MovedShape:
        """Return the shape for its moved section, between two ends; see :class:`.section_motion.SectionShape`."""
        low, high = place
        heights = low + (high - low) * self.heights
        points = np.column_stack([self.places.interpolated(section.corners)[:, :2], heights])
        return MovedShape(self.rest, points @ self.frame, self.parents)


@dataclass(frozen=True)
class _End:
    """One end of an extruded shape as heights above the plane.

    Attributes
    ----------
    finder : ClosestPointFinder
        Finds its triangles, projected onto the plane z = 0.
    corners : (m, 3, 1) float64
        Heights of their corners.
    """

    finder: ClosestPointFinder
    corners: NDArray[np.float64]

    @classmethod
    def of(cls, corners: NDArray[np.float64], side: float) -> _End:
        """Find the triangles, (m, 3, 3), that face along the axis z or, with a side of -1, against it."""
        own = corners[side * triangle_normals(corners)[:, 2] > _FACING]
        return cls(ClosestPointFinder(own * (1.0, 1.0, 0.0)), own[..., 2:])

    def heights(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the heights at points of the plane, (n,)."""
        return self.finder.find_about(points).interpolated(self.corners)[:, 0]


def _followed(
    section: TriangleMesh, ends: list[_End], size: float
) -> tuple[TriangleMesh, NDArray[np.int64], NDArray[np.float64]]:
    """Subdivide the triangles of a section where the ends of a shape are not plane, such as at bevels.

    Returns
    -------
    TriangleMesh
        The finer triangles.
    (n,) int64
        A triangle of the section that contains each vertex.
    (n, 2) float64
        Heights of both ends at the vertices.
    """
    fine, parents, heights = section, np.arange(len(section.faces)), _heights(ends, section.vertices)
    for _ in range(_ROUNDS):
        use = edge_use(fine.faces)
        edges = edge_ends(fine.faces, use)
        corners = fine.vertices[edges]
        between = _heights(ends, corners.mean(axis=1))
        uneven = np.abs(between - heights[edges].mean(axis=1)).max(axis=1) > _UNEVEN * size
        uneven &= np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1) > _SHORT * size
        if not uneven.any():
            break
        halved = with_edges_halved(fine, use, uneven)
        fine, parents = halved.mesh, parents[halved.parents]
        heights = np.concatenate([heights, between[uneven]])
    triangles = np.zeros(len(fine.vertices), np.int64)
    triangles[fine.faces.ravel()] = np.repeat(parents, 3)
    return fine, triangles, heights


def _heights(ends: list[_End], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the heights of both ends at points of the plane, (n, 2)."""
    return np.stack([end.heights(points) for end in ends], axis=1)
