# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids of revolution whose vertices follow the outlines of their sections, and what is attached to these solids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.closest_points import ClosestPointFinder
from ...geometry.mesh import TriangleMesh
from ...geometry.planar_fill import Boundary
from ...geometry.revolution import Revolution
from ...geometry.subdivision import Subdivision, bendable
from ..motions.motion import MovedShape
from .attached_parts import AttachedParts
from .sheets import AttachedPoints

# Least and largest distance of a chord from the axis, relative to that of its ends; for six sides, it is 0.87.
_SAG = 0.8, 1.0
# The mirror image of a section about the axis.
_MIRROR = (-1.0, 1.0)


@dataclass(frozen=True)
class RevolvedShape:
    """A solid of revolution, whose vertices follow both sides of its section.

    Attributes
    ----------
    divided : Subdivision
        The shape in scene space, with long edges divided.
    distances : (n,) float64
        Distances of its vertices from the axis.
    sides : AttachedPoints
        The places on the outline of the section nearest to the vertices, and then their mirror images.
    shares : (n,) float64
        Distances of the vertices from the axis, relative to those of these places. Edges around the axis are chords,
        whose sag would grow where a thin wall becomes thick.
    offsets : (n, 2) float64
        The rest of their differences from these places: away from the axis, and along it.
    attached : AttachedParts
        What is attached to the solid.
    directions : (n, 3) float64
        Unit vectors from the axis to the vertices.
    axis : (3,) float64
        Direction of the axis.
    """

    divided: Subdivision
    distances: NDArray[np.float64]
    sides: AttachedPoints
    shares: NDArray[np.float64]
    offsets: NDArray[np.float64]
    attached: AttachedParts
    directions: NDArray[np.float64]
    axis: NDArray[np.float64]

    @classmethod
    def of(
        cls, mesh: TriangleMesh, found: Revolution, frame: NDArray[np.float64], section: TriangleMesh
    ) -> RevolvedShape:
        """Attach an input to the triangles of its section."""
        divided = bendable(mesh)
        points = (divided.mesh.vertices - found.center) @ frame.T
        radii = np.hypot(points[:, 0], points[:, 2])
        away = np.divide(points, radii[:, None], out=np.zeros_like(points), where=radii[:, None] > 0.0)
        profile = np.column_stack([found.across.radii(points), points[:, 1]])
        places = _on_outline(found.section, profile)
        both = np.concatenate([places, places * _MIRROR])
        sides = AttachedPoints.of(both, section, ClosestPointFinder(section.corners))
        shares = np.divide(radii, places[:, 0], out=np.ones_like(radii), where=places[:, 0] > 0.0).clip(*_SAG)
        offsets = np.column_stack([radii, points[:, 1]]) - places * np.column_stack([shares, np.ones_like(shares)])
        directions, axis = (away * (1.0, 0.0, 1.0)) @ frame, frame[1]
        attached = AttachedParts.none(len(points))
        if not found.is_whole:
            attached = AttachedParts.of(divided.mesh, np.linalg.norm(offsets, axis=1), directions, axis)
        return cls(divided, radii, sides, shares, offsets, attached, directions, axis)

    def moved(self, section: TriangleMesh, place: NDArray[np.float64], left: float) -> MovedShape:
        """Return the shape for its moved section, about a point; see :class:`.section_motion.SectionShape`."""
        right, mirrored = self._sides(section)
        away, along = 0.5 * (right + mirrored).T
        offsets = self.attached.retracted(self.offsets, left)
        away, along = self.shares * away + offsets[:, 0], along + offsets[:, 1]
        ratios = np.divide(self.distances, away, out=np.ones_like(away), where=away > 0.0)
        turns = self.attached.turns(ratios)[:, None]
        directions = np.cos(turns) * self.directions + np.sin(turns) * np.cross(self.axis, self.directions)
        vertices = place + away[:, None] * directions + along[:, None] * self.axis
        return MovedShape(self.divided.mesh, vertices, self.divided.parents)

    def asymmetry(self, moved: TriangleMesh) -> float:
        """Return the largest distance between a point of a moved section and the mirror image of its counterpart."""
        right, mirrored = self._sides(moved)
        return float(np.linalg.norm(right - mirrored, axis=1).max())

    def _sides(self, moved: TriangleMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        right, left = np.split(self.sides.on(moved), 2)
        return right, left * _MIRROR


def _on_outline(section: Boundary, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points of an outline nearest to others, (n, 2), on the side of the axis that these are on."""
    edges = np.pad(np.stack([section.starts, section.ends, section.ends], axis=1), ((0, 0), (0, 0), (0, 1)))
    found = ClosestPointFinder(edges).find(np.pad(points, ((0, 0), (0, 1))))
    return np.maximum(found.interpolated(edges)[:, :2], (0.0, -np.inf))
