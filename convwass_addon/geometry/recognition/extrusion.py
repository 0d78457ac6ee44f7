# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recognize extrusions: solids that are nearly a flat area, moved along an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..meshes.mesh import TriangleMesh
from ..meshes.plane_section import all_cross, plane_section
from ..plane.coverage import overlap
from ..plane.planar_fill import Boundary
from .common_axes import face_directions, found_for_all, normal_axes

# Fractions of the height at which sections are compared with the one halfway, unevenly spaced: sections of a spring of
# three turns are nearly the same at 0.2, 0.5 and 0.8.
_HEIGHTS = (0.2, 0.8, 0.36, 0.57, 0.69)
# An extrusion fills at least this fraction of the cylinder over its section, and its sections overlap by at least this
# fraction of their union, on a grid with so many cells along the longest side. Solid text with round bevels of a tenth
# of its thickness fills 0.98.
_FILLED, _SAME, _CELLS = 0.85, 0.85, 96
# Rounding may make the volume larger than that.
_ROUNDING = 1e-3
# Axes that differ by less than this angle are the same.
_ALIKE = np.cos(np.radians(1.0))
# So many directions in which triangles face are tried as axes.
_DIRECTIONS = 6


@dataclass(frozen=True)
class Extrusion:
    """A solid that is nearly a flat area, moved along an axis.

    Attributes
    ----------
    section : Boundary
        The area halfway along the axis, in coordinates of the first two directions.
    low, high : float
        Where the solid begins and ends along the axis.
    """

    section: Boundary
    low: float
    high: float


def common_extrusions(meshes: Sequence[TriangleMesh]) -> tuple[NDArray[np.float64], list[Extrusion]] | None:
    """Return extrusions along a common axis, if all meshes are some.

    Of several possible axes, as for boxes, the one along which the meshes are thinnest is chosen.

    Parameters
    ----------
    meshes : sequence of TriangleMesh
        Closed meshes, oriented outward.

    Returns
    -------
    (3, 3) float64
        Two directions of the plane and the axis, as rows, orthonormal and right-handed.
    list of Extrusion
        One for each mesh.
    """
    best, thinnest = None, np.inf
    for axis in _axes(meshes):
        frame = _frame(axis)
        found = found_for_all(partial(_extrusion, frame=frame), meshes)
        if found is not None:
            thickness = sum((own.high - own.low) / own.section.root_area for own in found)
            if thickness < (1.0 - _ROUNDING) * thinnest:
                best, thinnest = (frame, found), thickness
    return best


def _axes(meshes: Sequence[TriangleMesh]) -> list[NDArray[np.float64]]:
    """Return directions along which one of the meshes, and so all, may be extruded.

    The axis is the normal of a large part of the surface, or an eigenvector of the sum of n n^T over the surface.
    """
    mesh = min(meshes, key=lambda own: len(own.faces))
    normals, areas = mesh.face_normals, mesh.face_areas
    candidates = [*face_directions(normals, areas, _DIRECTIONS)[0], *normal_axes(normals, areas)]
    found: list[NDArray[np.float64]] = []
    for axis in candidates:
        if axis.any() and not any(abs(axis @ other) > _ALIKE for other in found):
            found.append(axis)
    return found


def _frame(axis: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return two directions of the plane and the axis, as rows; the second one points upward if it can."""
    nearest = int(np.abs(axis).argmax())
    if abs(axis[nearest]) > _ALIKE:
        axis = np.eye(3)[nearest]
    up = np.array([0.0, 1.0, 0.0]) if nearest == 2 else np.array([0.0, 0.0, 1.0])
    second = up - (up @ axis) * axis
    second /= np.linalg.norm(second)
    return np.stack([np.cross(second, axis), second, axis])


def _extrusion(mesh: TriangleMesh, frame: NDArray[np.float64]) -> Extrusion | None:
    """Return a mesh as an extrusion along the last direction of a frame, or None if it is none."""
    vertices = mesh.vertices @ frame.T
    heights = vertices[:, 2][mesh.faces]
    low, high = float(heights.min()), float(heights.max())
    middle = 0.5 * (low + high)
    section = plane_section(vertices, mesh.faces, middle)
    cylinder = section.area * (high - low)
    if cylinder <= 0.0 or not _FILLED <= mesh.volume / cylinder <= 1.0 + _ROUNDING:
        return None
    for height in _HEIGHTS:
        other = plane_section(vertices, mesh.faces, low + height * (high - low))
        if not len(other.starts) or overlap(section, other, _CELLS) < _SAME:
            return None
    if not all_cross(mesh, vertices[:, 2] - middle):
        return None
    return Extrusion(section.resolved(), low, high)
