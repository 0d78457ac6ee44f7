# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recognize solids of revolution, such as cups, bottles and chess pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray

from .line_cuts import beyond_line
from .mesh import TriangleMesh
from .normals import triangle_normals, unit_vectors
from .planar_fill import Boundary
from .plane_section import plane_section

# Normals of solids of revolution lie in planes through the axis up to this root mean square. Cylinders of 16 sides have
# 0.07, because the centers of triangles are not in the middle of the sides.
_ASIDE = 0.08
# The volume differs from that of the revolved section by at most this share.
_DIFFERENT = 0.05


@dataclass(frozen=True)
class Revolution:
    """A solid that is nearly a flat area, revolved about an axis.

    Attributes
    ----------
    section : Boundary
        The area on both sides of the axis, mirror-symmetric: the distance from the axis, and the place along it.
    center : (3,) float64
        A point of the axis, the origin of the section.
    """

    section: Boundary
    center: NDArray[np.float64]


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
    for axis in _axes(meshes):
        across = np.eye(3)[int(np.abs(axis).argmin())]
        across = unit_vectors((across - (across @ axis) * axis)[None])[0]
        frame = np.stack([across, axis, np.cross(across, axis)])
        found = list(takewhile(lambda own: own is not None, (_revolution(mesh, frame) for mesh in meshes)))
        if len(found) == len(meshes):
            return frame, found
    return None


def _axes(meshes: Sequence[TriangleMesh]) -> list[NDArray[np.float64]]:
    """Return directions that axes may have: the vertical first, then eigenvectors of the sums of n n^T."""
    found = [np.array([0.0, 0.0, 1.0])]
    for mesh in meshes:
        normals = triangle_normals(mesh.corners)
        found.extend(np.linalg.eigh(np.einsum("m,mi,mj->ij", mesh.face_areas, normals, normals))[1].T)
    return found


def _revolution(mesh: TriangleMesh, frame: NDArray[np.float64]) -> Revolution | None:
    """Return a mesh as a solid of revolution about the second direction of a frame, or None if it is none."""
    center = mesh.area_center
    corners = (mesh.corners - center) @ frame.T
    around = unit_vectors(np.cross((0.0, 1.0, 0.0), corners.mean(axis=1)))
    aside = np.square((triangle_normals(corners) * around).sum(axis=1))
    if mesh.face_areas @ aside > _ASIDE**2 * mesh.area:
        return None
    half = beyond_line(plane_section(corners, 0.0), np.array([1.0, 0.0]), 0.0)
    # Pappus: the volume is the area times the way of its center.
    volume = 2.0 * np.pi * half.area * half.center[0] if half.area > 0.0 else 0.0
    if abs(mesh.volume - volume) > _DIFFERENT * volume or volume == 0.0:
        return None
    mirrored = Boundary(half.ends * (-1.0, 1.0), half.starts * (-1.0, 1.0))
    return Revolution(half.united([mirrored]), center)
