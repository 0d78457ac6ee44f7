# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stretch a mesh that lies on a closed surface over slits that it leaves open.

A mesh with a hole, on a surface without one, is open where the hole ends, and its walls lie inside the surface. The
vertices next to the slit are drawn to the points of the surface that nothing covers, until both sides meet. Other
vertices give way a little, and walls follow.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array

from ...progress import UNINTERRUPTED, Control
from ..algebra.factorization import factorize
from ..meshes.edge_laplacian import edge_laplacian
from ..meshes.facing_points import FacingPointFinder
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import vertex_normals

_ROUNDS = 10
# Distances beyond this, relative to the square root of the surface's area, have little weight.
_REACH = 0.1
# Vertices lie on the surface if they are closer than this, relative to its square root, and the cosine between normals
# is above this.
_CLOSE, _FACING = 0.03, 0.7
# Weights of differences of displacements along edges, on the surface and at walls, and of staying in place on the
# surface, relative to a weight of one for covering a point. The least weight holds walls that nothing else constrains.
_SMOOTHNESS, _WALLS, _STAYING, _LEAST = 0.3, 0.1, 0.05, 1e-5


def covering(mesh: TriangleMesh, surface: TriangleMesh, control: Control = UNINTERRUPTED) -> NDArray[np.float64]:
    """Return the vertices, (n, 3), of a mesh that covers a surface.

    Parameters
    ----------
    mesh : TriangleMesh
        Lies on the surface, except for walls inside and slits between them.
    surface : TriangleMesh
        Closed, oriented outward.
    control : Control
        Stops the work.
    """
    finder, facing = FacingPointFinder(surface), surface.face_normals
    wanted = surface.vertex_normals
    size, points = surface.root_area, mesh.vertices
    for number in range(_ROUNDS):
        control.check()
        normals = vertex_normals(points, mesh.faces)
        below = finder.find(points, normals, control)
        on_surface = below.interpolated(surface.corners)
        is_there = np.einsum("nd,nd->n", facing[below.triangles], normals) > _FACING
        is_there &= below.distances < _CLOSE * size
        if number % 2:
            points = np.where(is_there[:, None], on_surface, points)
        points = points + _step(TriangleMesh(points, mesh.faces), is_there, surface.vertices, wanted, size)
    return points


def _step(
    mesh: TriangleMesh,
    is_there: NDArray[np.bool_],
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    size: float,
) -> NDArray[np.float64]:
    """Return displacements, (n, 3), towards points of the surface with normals; some vertices rather stay."""
    count = len(mesh.vertices)
    found = FacingPointFinder(mesh).find(points, normals)
    rows = np.repeat(np.arange(len(points)), 3)
    places = (rows, mesh.faces[found.triangles].ravel())
    shares = csr_array((found.shares.ravel(), places), shape=(len(points), count))
    missing = points - shares @ mesh.vertices
    # A finer surface has no more weight than a mesh that is as fine.
    weights = min(count / len(points), 1.0) * np.exp(-np.square(found.distances / (_REACH * size)))
    pulled = csr_array(shares.T @ diags_array(weights))
    # Instead of S^T W S, its sums of rows: an upper bound, so that no step is too large, and an M-matrix.
    staying = np.where(is_there, _STAYING, 0.0) + _LEAST + pulled.sum(axis=1)
    smoothness = _SMOOTHNESS * edge_laplacian(mesh.faces, np.sqrt(np.where(is_there, 1.0, _WALLS)))
    system = csc_array(smoothness + diags_array(staying))
    return factorize(system).solve_columns(pulled @ missing)
