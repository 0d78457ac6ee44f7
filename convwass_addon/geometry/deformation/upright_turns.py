# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find how far an upright shape is turned about the vertical axis relative to another one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..algebra.rotation_fields import rotation_matrices
from ..meshes.mesh import TriangleMesh
from ..meshes.point_tree import point_tree
from ..plane.plane_angles import best_turn

# Number of turns tried, and of vertices of each shape that are compared: of larger meshes, up to twice as many.
_TURNS, _SAMPLES = 12, 1000
# Length in sizes of the surface that the difference of unit normals counts as.
_NORMALS = 0.2
# A turn is needed if it leaves at most this fraction of the distance that the shapes have as they stand. Between the
# benchmark's tuned pairs, which all face the same way, the best turn leaves .91 or more; between a horse and a cow
# turned by 180 degrees .79, and after 90 degrees .30 to .83 for bodies that are longer than wide.
_CLEARLY = 0.87
# Corresponding points indicate a turn if it leaves at most this fraction of their root mean square distance.
_LEFT_OF_POINTS = 0.5


def upright_turn(source: TriangleMesh, target: TriangleMesh) -> NDArray[np.float64] | None:
    """Return the rotation about the z axis that makes one shape face like another.

    Parameters
    ----------
    source, target : TriangleMesh
        Oriented outward; compared with centers and sizes made equal.

    Returns
    -------
    (3, 3) float64 or None
        A multiple of 30 degrees; None if no turn brings the shapes clearly closer to each other.
    """
    angles = 2.0 * np.pi * np.arange(_TURNS) / _TURNS
    turns = np.array([rotation_about_z(angle) for angle in angles])
    apart = distances_after(source, target, turns)
    best = int(apart.argmin())
    return turns[best] if apart[best] < _CLEARLY * apart[0] else None


def upright_turn_of_points(points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return the rotation about the z axis that brings points clearly closer to others.

    Parameters
    ----------
    points, others : (k, 3) float64
        Corresponding points about the centers of their shapes, in sizes of the surfaces.

    Returns
    -------
    (3, 3) float64 or None
        The multiple of 30 degrees nearest to the least-squares rotation. None if it leaves much of the distance, and
        for less than two points: a single one could be anywhere.
    """
    if len(points) < 2:
        return None
    step = 2.0 * np.pi / _TURNS
    turn = rotation_about_z(step * np.round(best_turn(points[:, :2], others[:, :2]) / step))
    before, after = np.linalg.norm(points - others), np.linalg.norm(points @ turn.T - others)
    return turn if after < _LEFT_OF_POINTS * before else None


def rotation_about_z(angle: float) -> NDArray[np.float64]:
    """Return the matrix of the rotation about the z axis by an angle in radians, (3, 3)."""
    return rotation_matrices(np.array([[0.0, 0.0, angle]]))[0]


def distances_after(source: TriangleMesh, target: TriangleMesh, turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean distance of two shapes, both ways, after turns of the first one, (k, 3, 3), in sizes, (k,)."""
    points, normals, areas = _samples(source)
    others, facing, shares = _samples(target)
    there = point_tree(np.hstack([others, _NORMALS * facing]))
    found = []
    for turn in turns:
        turned = np.hstack([points @ turn.T, _NORMALS * normals @ turn.T])
        ahead, back = there.query(turned)[0], point_tree(turned).query(there.data)[0]
        found.append(0.5 * (areas @ ahead + shares @ back))
    return np.array(found)


def _samples(mesh: TriangleMesh) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return some vertices about the center in sizes of the surface, their normals, and their shares of the area."""
    used = np.flatnonzero(mesh.is_used)
    chosen = used[:: max(len(used) // _SAMPLES, 1)]
    areas = mesh.vertex_areas
    middle = areas @ mesh.vertices / areas.sum()
    points = (mesh.vertices[chosen] - middle) / mesh.root_area
    return points, mesh.vertex_normals[chosen], areas[chosen] / areas[chosen].sum()
