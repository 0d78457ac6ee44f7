# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Even triangulation of a filled area of the plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, cKDTree

from ..meshes.edges import edge_ends, edge_use
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import doubled_areas
from ..plane.planar_fill import Boundary
from .subdivision import with_edges_halved

# Least distance of inner points from the boundary, in edge lengths, which avoids thin triangles between them.
_CLEARANCE = 0.6
# Triangles with less area, in squared edge lengths, are degenerate.
_LEAST_AREA = 1e-6


def planar_mesh(boundary: Boundary, edge: float) -> TriangleMesh:
    """Triangulate the area inside a boundary.

    Samples the boundary and a hexagonal lattice inside, and keeps the Delaunay triangles whose centroid is inside.
    Where the sides of the boundary are at least one edge apart, these cover the area exactly.

    Parameters
    ----------
    boundary : Boundary
        Any number of regions and holes.
    edge : float
        Target edge length of the triangles.

    Returns
    -------
    TriangleMesh
        In the plane z = 0, facing up. Points on the boundary come first.
    """
    rim = np.unique(boundary.divided(edge).starts, axis=0)
    inner = _lattice(boundary.bounds, edge)
    inner = inner[boundary.contains(inner)]
    inner = inner[cKDTree(rim).query(inner)[0] > _CLEARANCE * edge] if len(inner) else inner
    points = np.concatenate([rim, inner])
    # Far from the origin, Qhull takes small triangles for flat.
    triangles = Delaunay(points - points.mean(axis=0)).simplices.astype(np.int64)
    doubled = doubled_areas(points[triangles])
    triangles = np.where((doubled < 0)[:, None], triangles[:, ::-1], triangles)
    kept = (np.abs(doubled) > _LEAST_AREA * edge**2) & boundary.contains(points[triangles].mean(axis=1))
    return TriangleMesh(np.column_stack([points, np.zeros(len(points))]), triangles[kept])


def without_bridges(mesh: TriangleMesh) -> TriangleMesh:
    """Halve all edges that connect points of the boundary through the inside.

    Then the triangles at a corner of the boundary, too, can follow it when it turns from convex to reflex.
    """
    use = edge_use(mesh.faces)
    ends = edge_ends(mesh.faces, use)
    is_rim = np.zeros(len(mesh.vertices), bool)
    is_rim[ends[use.count == 1]] = True
    return with_edges_halved(mesh, use, (use.count > 1) & is_rim[ends].all(axis=1)).mesh


def _lattice(bounds: NDArray[np.float64], edge: float) -> NDArray[np.float64]:
    """Return the points of a hexagonal lattice in a box, (n, 2)."""
    rows = np.arange(bounds[0, 1], bounds[1, 1], edge * np.sqrt(0.75))
    columns = np.arange(bounds[0, 0], bounds[1, 0], edge)
    x, y = np.meshgrid(columns, rows)
    x[1::2] += edge / 2
    return np.stack([x.ravel(), y.ravel()], axis=1)
