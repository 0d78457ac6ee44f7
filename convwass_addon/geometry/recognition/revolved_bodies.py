# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recognize solids of revolution that something is attached to, such as mugs, jugs and rockets with fins."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..algebra.rotation_fields import rotation_matrices
from ..meshes.mesh import TriangleMesh
from ..meshes.plane_section import plane_section
from ..plane.coverage import overlaps
from ..plane.line_cuts import beyond_line
from ..plane.planar_fill import Boundary
from ..plane.ring_nesting import outline_of
from .cross_sections import Circle
from .revolution import BareSurface, Revolution, both_halves, found_about, mirrored_half, revolution_about

# The first number is the sine of the largest angle between normals of the body and planes through the axis; the second
# one the least share of the surface with such normals. A mug has 0.9, a snowman with arms 0.9, a rocket with fins 0.7,
# a sitting bear or a chair 0.4, people and animals at most 0.3.
_ASIDE, _REVOLVED = 0.15, 0.6
# Sections are compared in so many half-planes through the axis, on a grid with so many cells along the longest side.
# At least the first share of them overlap with that of the body by at least the second one, a fraction of their union.
_HALVES, _CELLS = 16, 96
_ALIKE, _SAME = 0.6, 0.85
# Least and largest share of the volume that is the body's. A rocket has 0.9 without its fins. A cactus has 0.83 without
# its arms, which look better if they merge with the body in a warp, and a stool 0.7 without its legs.
_LEAST_BODY, _MOST_BODY = 0.87, 1.05
# Rounds of reweighting that find the axis, and the distance, in sizes of the surface, up to which normals meet it.
_ROUNDS, _NEAR = 12, 0.003


def common_revolved_bodies(meshes: Sequence[TriangleMesh]) -> tuple[NDArray[np.float64], list[Revolution]] | None:
    """Return the solids of revolution that most of every mesh is, about parallel axes.

    The axes are vertical, or else along one of the other coordinate axes.

    Parameters
    ----------
    meshes : sequence of TriangleMesh
        Closed meshes, oriented outward.

    Returns
    -------
    (3, 3) float64, list of Revolution
        As for :func:`.revolution.common_revolutions`.
    """
    return found_about(np.eye(3)[::-1], _whole_or_body, [BareSurface.of(mesh) for mesh in meshes])


def _whole_or_body(surface: BareSurface, frame: NDArray[np.float64]) -> Revolution | None:
    return revolution_about(surface, frame) or _body(surface, frame)


def _body(surface: BareSurface, frame: NDArray[np.float64]) -> Revolution | None:
    """Return the solid of revolution about the second direction of a frame that most of a mesh is, or None."""
    mesh = surface.mesh
    points, normals, areas = surface.centers @ frame.T, surface.normals @ frame.T, surface.areas
    center = _center(points, normals, areas)
    away = points - center
    aside = np.abs(normals[:, 0] * away[:, 2] - normals[:, 2] * away[:, 0])
    is_revolved = aside <= _ASIDE * np.hypot(away[:, 0], away[:, 2])
    if areas[is_revolved].sum() < _REVOLVED * areas.sum():
        return None
    halves = _half_sections(mesh.vertices @ frame.T - center, mesh.faces)
    if not all(half.area > 0.0 for half in halves):
        return None
    alike = overlaps(halves, _CELLS)
    typical = int(np.median(alike, axis=1).argmax())
    half = halves[typical]
    # Pappus: the volume is the area times the way of its center.
    share = 2.0 * np.pi * half.area * half.center[0] / mesh.volume
    if (alike[typical] >= _SAME).mean() < _ALIKE or not _LEAST_BODY <= share <= _MOST_BODY:
        return None
    # A handle above the body crosses the axis in all half-planes.
    section = Boundary.of_rings(outline_of(both_halves(half)).regions[0].rings)
    return Revolution(section, center @ frame, Circle(), is_whole=False)


def _center(
    points: NDArray[np.float64], normals: NDArray[np.float64], areas: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the point, (3,), of the axis along y that most normals at points of a surface meet.

    The root of the distances from the normals is minimized by reweighted least squares, so that attached parts hardly
    count.
    """
    # The distance of the axis at c from a normal n at p is (p - c) x n in the plane across it.
    rows = np.column_stack([normals[:, 2], -normals[:, 0]])
    wanted = (rows * points[:, [0, 2]]).sum(axis=1)
    center, weights = np.average(points, axis=0, weights=areas), areas
    for _ in range(_ROUNDS):
        weighted = rows * weights[:, None]
        center[[0, 2]] = np.linalg.lstsq(weighted.T @ rows, weighted.T @ wanted, rcond=None)[0]
        missed = np.abs(wanted - rows @ center[[0, 2]])
        weights = areas / np.maximum(missed, _NEAR * np.sqrt(areas.sum())) ** 1.5
    return center


def _half_sections(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> list[Boundary]:
    """Return sections of a surface in half-planes through the axis, as areas where the first coordinate is positive."""
    found = []
    angles = np.arange(_HALVES // 2) * 2.0 * np.pi / _HALVES
    for turn in rotation_matrices(np.outer(angles, (0.0, 1.0, 0.0))):
        section = plane_section(vertices @ turn.T, faces, 0.0)
        found.append(beyond_line(section, np.array([1.0, 0.0]), 0.0))
        found.append(mirrored_half(beyond_line(section, np.array([-1.0, 0.0]), 0.0)))
    return found
