# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recognize solids of revolution, such as cups, bottles and chess pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from .common_axes import found_for_all, normal_axes
from .coverage import overlap
from .line_cuts import beyond_line
from .mesh import TriangleMesh
from .normals import triangle_normals, unit_vectors
from .planar_fill import Boundary
from .plane_section import plane_section
from .ring_nesting import without_slivers

# Normals of solids of revolution lie in planes through the axis up to this root mean square. Where vertices are not in
# a few planes through the axis, the centers of triangles are in the middle of the sides only approximately.
_ASIDE = 0.08
# Solids of at least and at most so many sides count as revolved, such as a glass in a game; a box does not. Angles of
# vertices about the axis are equal within the last number, in radians.
_FEWEST_SIDES, _MOST_SIDES, _EQUAL = 6, 128, 2e-3
# Vertices nearer to the axis than this share of the largest distance have no angle.
_ON_AXIS = 1e-3
# The volume differs from that of the revolved section by at most this share.
_DIFFERENT = 0.05
# Regions of sections with a smaller share of the area come from rounding: vertices lie slightly beside the plane.
_SLIVER = 1e-5
# Sections on both sides of the axis overlap by at least this fraction of their union, on a grid with so many cells
# along the longest side. Springs of nine turns and more, whose normals are nearly in such planes, have 0.04.
_SAME, _CELLS = 0.7, 96


@dataclass(frozen=True)
class Sides:
    """The sides of a solid whose sections across an axis are regular polygons about it.

    Attributes
    ----------
    count : int
        Number of sides.
    angle : float
        Angle of an edge about the axis, in radians.
    """

    count: int
    angle: float

    @classmethod
    def of(cls, points: NDArray[np.float64]) -> Sides | None:
        """Find the sides about the second coordinate axis from vertices, (n, 3); None if there are none."""
        radii = np.hypot(points[:, 0], points[:, 2])
        away = points[radii > _ON_AXIS * radii.max(initial=0.0)]
        angles = np.sort(np.arctan2(away[:, 2], away[:, 0]))
        if len(angles) < _FEWEST_SIDES:
            return None
        gaps = np.diff(angles, append=angles[0] + 2.0 * np.pi)
        edges = gaps > _EQUAL
        count = int(np.count_nonzero(edges))
        if not _FEWEST_SIDES <= count <= _MOST_SIDES:
            return None
        if np.abs(np.diff(angles[edges], append=angles[edges][0] + 2.0 * np.pi) - 2.0 * np.pi / count).max() > _EQUAL:
            return None
        return cls(count, float(angles[edges][0]))

    @property
    def rotation(self) -> NDArray[np.float64]:
        """The rotation, (3, 3), after which an edge is in the direction of the first coordinate axis."""
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        return np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])

    @property
    def filled(self) -> float:
        """Area of a polygon relative to that of the circle around it."""
        return float(np.sin(self._step) / self._step)

    @property
    def opposite(self) -> float:
        """Distance of what is opposite an edge from the axis, relative to that of the edge."""
        return 1.0 if self.count % 2 == 0 else float(np.cos(0.5 * self._step))

    @property
    def _step(self) -> float:
        return 2.0 * np.pi / self.count

    def radii(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the radii of the circles around the polygons that points, (n, 3), are on."""
        return (points * self.middles(points)).sum(axis=1) / np.cos(0.5 * self._step)

    def middles(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the directions of the middles of the sides that points are on, (n, 3)."""
        turns = np.floor((np.arctan2(points[:, 2], points[:, 0]) - self.angle) / self._step) + 0.5
        angles = self.angle + turns * self._step
        return np.column_stack([np.cos(angles), np.zeros(len(angles)), np.sin(angles)])


@dataclass(frozen=True)
class Revolution:
    """A solid that is nearly a flat area, revolved about an axis.

    Attributes
    ----------
    section : Boundary
        The area on both sides of the axis, mirror-symmetric: the distance from the axis, and the place along it.
    center : (3,) float64
        A point of the axis, the origin of the section.
    sides : Sides or None
        Its sides, about the second direction of the frame that it was found in, if it has some.
    """

    section: Boundary
    center: NDArray[np.float64]
    sides: Sides | None = None

    def radii(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distances of edges from the axis that are on the same place of the section as points, (n, 3)."""
        return np.hypot(points[:, 0], points[:, 2]) if self.sides is None else self.sides.radii(points)


def common_revolutions(meshes: Sequence[TriangleMesh]) -> tuple[NDArray[np.float64], list[Revolution]] | None:
    """Return solids of revolution about parallel axes, if all meshes are some.

    Parameters
    ----------
    meshes : sequence of TriangleMesh
        Closed meshes, oriented outward.

    Returns
    -------
    (3, 3) float64
        A direction across the axes, the axes, and the direction across both, as rows, orthonormal and right-handed.
    list of Revolution
        One for each mesh.
    """
    surfaces = [_Surface(mesh, triangle_normals(mesh.corners)) for mesh in meshes]
    # The vertical one first.
    axes = [np.array([0.0, 0.0, 1.0])]
    for own in surfaces:
        axes.extend(normal_axes(own.normals, own.mesh.face_areas))
    for axis in axes:
        across = np.eye(3)[int(np.abs(axis).argmin())]
        across = unit_vectors((across - (across @ axis) * axis)[None])[0]
        frame = np.stack([across, axis, np.cross(across, axis)])
        found = found_for_all(partial(_revolution, frame=frame), surfaces)
        if found is not None:
            return frame, found
    return None


@dataclass(frozen=True)
class _Surface:
    """A mesh and the unit normals of its triangles, (m, 3), which are needed for every axis."""

    mesh: TriangleMesh
    normals: NDArray[np.float64]


def _revolution(surface: _Surface, frame: NDArray[np.float64]) -> Revolution | None:
    """Return a mesh as a solid of revolution about the second direction of a frame, or None if it is none."""
    mesh, center = surface.mesh, surface.mesh.area_center
    sides = Sides.of((mesh.vertices - center) @ frame.T)
    toward = mesh.corners.mean(axis=1) - center
    filled = opposite_share = 1.0
    if sides is not None:
        toward = sides.middles(toward @ frame.T) @ frame
        # The plane of the section meets edges, not the middle of sides.
        frame = sides.rotation @ frame
        filled, opposite_share = sides.filled, sides.opposite
    around = unit_vectors(np.cross(frame[1], toward))
    aside = np.square((surface.normals * around).sum(axis=1))
    if mesh.face_areas @ aside > _ASIDE**2 * mesh.area:
        return None
    section = plane_section((mesh.corners - center) @ frame.T, 0.0)
    half, opposite = (beyond_line(section, np.array([side, 0.0]), 0.0) for side in (1.0, -1.0))
    # Pappus: the volume is the area times the way of its center.
    volume = filled * 2.0 * np.pi * half.area * half.center[0] if half.area > 0.0 else 0.0
    if abs(mesh.volume - volume) > _DIFFERENT * volume or volume == 0.0:
        return None
    if not len(opposite.starts) or overlap(opposite, _mirrored(half, opposite_share), _CELLS) < _SAME:
        return None
    return Revolution(without_slivers(half.united([_mirrored(half)]), _SLIVER), center, sides)


def _mirrored(half: Boundary, share: float = 1.0) -> Boundary:
    """Return the part of a section on one side of the axis on the other side, at a share of its distances."""
    return Boundary(half.ends * (-share, 1.0), half.starts * (-share, 1.0))
