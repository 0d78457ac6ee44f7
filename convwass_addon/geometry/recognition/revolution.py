# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recognize solids of revolution, such as cups, bottles and chess pieces."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..meshes.mesh import TriangleMesh
from ..meshes.normals import unit_vectors
from ..meshes.plane_section import all_cross, plane_section
from ..plane.coverage import overlap
from ..plane.line_cuts import beyond_line
from ..plane.planar_fill import Boundary
from ..plane.ring_nesting import without_slivers
from .common_axes import found_for_all, normal_axes
from .cross_sections import CrossSection, cross_section_of

# Normals of solids of revolution lie in planes through the axis up to this root mean square. Where vertices are not in
# a few planes through the axis, the centers of triangles are in the middle of the sides only approximately.
_ASIDE = 0.08
# The volume differs from that of the revolved section by at most this share.
_DIFFERENT = 0.05
# Regions of sections with a smaller share of the area come from rounding: vertices lie slightly beside the plane.
_SLIVER = 1e-5
# Normals of about so many triangles tell whether a mesh is revolved.
_ENOUGH = 20_000
# Sections on both sides of the axis overlap by at least this fraction of their union, on a grid with so many cells
# along the longest side. Springs of nine turns and more, whose normals are nearly in such planes, have 0.04.
_SAME, _CELLS = 0.7, 96


@dataclass(frozen=True)
class Revolution:
    """A solid that is nearly a flat area, revolved about an axis.

    Attributes
    ----------
    section : Boundary
        The area on both sides of the axis, mirror-symmetric: the distance from the axis, and the place along it.
    center : (3,) float64
        A point of the axis, the origin of the section.
    across : CrossSection
        What sections across the axis are, in the frame that it was found in.
    is_whole : bool
        Whether nothing is attached to it.
    """

    section: Boundary
    center: NDArray[np.float64]
    across: CrossSection
    is_whole: bool = True

    def profile_of(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the points of the section that points about the center, (n, 3), in the frame are on when revolved."""
        return np.column_stack([self.across.radii(points), points[:, 1]])


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
    surfaces = [BareSurface.of(mesh) for mesh in meshes]
    # The vertical one first.
    axes = [np.array([0.0, 0.0, 1.0])]
    for own in surfaces:
        axes.extend(normal_axes(own.normals, own.areas))
    return found_about(axes, revolution_about, surfaces)


@dataclass(frozen=True)
class BareSurface:
    """A mesh, and what is needed of its triangles for every axis; of dense meshes, only of some of them.

    Attributes
    ----------
    mesh : TriangleMesh
        The mesh.
    centers : (k, 3) float64
        Centers of some triangles.
    normals : (k, 3) float64
        Their unit normals.
    areas : (k,) float64
        Their areas.
    """

    mesh: TriangleMesh
    centers: NDArray[np.float64]
    normals: NDArray[np.float64]
    areas: NDArray[np.float64]

    @classmethod
    def of(cls, mesh: TriangleMesh) -> BareSurface:
        """Take all triangles of a mesh, or random ones of a dense mesh: every tenth may be on a few meridians."""
        faces = mesh.faces
        if len(faces) > _ENOUGH:
            faces = faces[np.random.default_rng(0).integers(len(faces), size=_ENOUGH)]
        some = TriangleMesh(mesh.vertices, faces)
        return cls(mesh, some.corners.mean(axis=1), some.face_normals, some.face_areas)


def found_about(
    axes: Iterable[NDArray[np.float64]],
    find: Callable[[BareSurface, NDArray[np.float64]], Revolution | None],
    surfaces: Sequence[BareSurface],
) -> tuple[NDArray[np.float64], list[Revolution]] | None:
    """Return what is found for every surface about the first axis, (3,), about which something is, and its frame.

    `find` gets a surface and the frame: a direction across the axis, the axis, and the direction across both, as rows.
    """
    for axis in axes:
        across = np.eye(3)[int(np.abs(axis).argmin())]
        across = unit_vectors((across - (across @ axis) * axis)[None])[0]
        frame = np.stack([across, axis, np.cross(across, axis)])
        found = found_for_all(lambda surface, frame=frame: find(surface, frame), surfaces)
        if found is not None:
            return frame, found
    return None


def revolution_about(surface: BareSurface, frame: NDArray[np.float64]) -> Revolution | None:
    """Return a mesh as a solid of revolution about the second direction of a frame, or None if it is none."""
    mesh, center = surface.mesh, surface.mesh.area_center
    across = cross_section_of((mesh.vertices - center) @ frame.T)
    around = unit_vectors(np.cross((0.0, 1.0, 0.0), across.facing((surface.centers - center) @ frame.T)))
    aside = np.square((surface.normals @ frame.T * around).sum(axis=1))
    if surface.areas @ aside > _ASIDE**2 * surface.areas.sum():
        return None
    # The plane of the section meets corners of polygons, not the middle of sides.
    turned = (mesh.vertices - center) @ (across.rotation @ frame).T
    section = plane_section(turned, mesh.faces, 0.0)
    half, opposite = (beyond_line(section, np.array([side, 0.0]), 0.0) for side in (1.0, -1.0))
    # Pappus: the volume is the area times the way of its center.
    volume = across.filled * 2.0 * np.pi * half.area * half.center[0] if half.area > 0.0 else 0.0
    if abs(mesh.volume - volume) > _DIFFERENT * volume or volume == 0.0:
        return None
    if not len(opposite.starts) or overlap(opposite, mirrored_half(half, across.opposite), _CELLS) < _SAME:
        return None
    if not all_cross(mesh, turned[:, 2]):
        return None
    return Revolution(both_halves(half), center, across)


def both_halves(half: Boundary) -> Boundary:
    """Return an area on one side of the axis together with its mirror image."""
    return without_slivers(half.united([mirrored_half(half)]), _SLIVER)


def mirrored_half(half: Boundary, share: float = 1.0) -> Boundary:
    """Return the part of a section on one side of the axis on the other side, at a share of its distances."""
    return Boundary(half.ends * (-share, 1.0), half.starts * (-share, 1.0))
