# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points where two shapes coincide already, as most of a body does in two poses.

Soft maps use properties that are the same left and right, and may exchange the legs of a man who raises an arm. A few
coinciding points with similar normals resolve that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.arrays.components import component_labels
from ...geometry.arrays.far_points import far_points
from ...geometry.meshes.edges import mesh_edges
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import vertex_normals

# Chosen by eye; `python3 run.py bench coherence` measures the effect.
# Points coincide if their distance is at most this fraction of the surface's size (the square root of its area) or the
# length of its triangles, and if the cosine between their normals is at least the second number.
_APART, _FACING = 0.02, 0.8
# Shapes coincide if at least this fraction of their surfaces does.
_LEAST_SHARE = 0.03
_PAIRS = 8


def coinciding_places(first: TriangleMesh, second: TriangleMesh) -> NDArray[np.int64]:
    """Find points where two shapes coincide as they stand, or else with centers and sizes made equal.

    Returns
    -------
    (k, 2) int64
        A few pairs of coinciding vertices, far apart from each other; none if too little coincides.
    """
    placed = _found(first, first.vertices, second, second.vertices)
    return placed if len(placed) else _found(first, _unit(first), second, _unit(second))


def _unit(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return the vertices relative to the centroid of the surface, in sizes of the surface."""
    middle = mesh.area_center
    return (mesh.vertices - middle) / mesh.root_area


def _found(
    first: TriangleMesh, points: NDArray[np.float64], second: TriangleMesh, others: NDArray[np.float64]
) -> NDArray[np.int64]:
    region, nearest = coinciding_region(first, points, second, others)
    places = np.flatnonzero(region)
    if first.vertex_areas @ region < _LEAST_SHARE * first.area or len(places) < _PAIRS:
        return np.empty((0, 2), np.int64)
    chosen = places[far_points(points[places], _PAIRS)]
    partners, once = np.unique(nearest[chosen], return_index=True)
    return np.stack([chosen[once], partners], axis=1)


def coinciding_region(
    first: TriangleMesh, points: NDArray[np.float64], second: TriangleMesh, others: NDArray[np.float64]
) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Find the largest connected region of a mesh that coincides with another and has similar normals.

    Limbs that exchange their places coincide where they cross; such regions are small and would be misleading.

    Parameters
    ----------
    first, second : TriangleMesh
        Oriented outward.
    points, others : (n, 3)
        Positions of their vertices.

    Returns
    -------
    (n,) bool, (n,) int64
        The vertices of the first mesh in the region, and the nearest vertex of the second to each of its vertices.
    """
    used = np.flatnonzero(second.is_used)
    size = np.sqrt(TriangleMesh(points, first.faces).area)
    apart, nearest = cKDTree(others[used]).query(points)
    nearest = used[nearest]
    facing = np.einsum("nd,nd->n", vertex_normals(points, first.faces), vertex_normals(others, second.faces)[nearest])
    together = (apart <= size * max(_APART, len(first.faces) ** -0.5)) & (facing >= _FACING)
    areas = first.vertex_areas * together
    ends = mesh_edges(first.faces)
    ends = ends[(areas[ends] > 0).all(axis=1)]
    labels = component_labels(*ends.T, len(areas))
    return (areas > 0) & (labels == np.bincount(labels, areas).argmax()), nearest
