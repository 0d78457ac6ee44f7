# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotations of vertex neighborhoods between two poses of a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..algebra.rotations import nearest_rotations
from ..meshes.mesh import TriangleMesh
from .poisson_deformation import deformation_gradients

# Rounds of averaging gradients over adjacent triangles, because single triangles may fold or flip.
_ROUNDS = 4


def surface_rotations(
    before: NDArray[np.float64], after: NDArray[np.float64], faces: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the rotation of every vertex, (n, 3, 3), between two poses of a surface.

    Parameters
    ----------
    before, after : (n, 3)
        Positions of the vertices.
    faces : (m, 3) int64
        Triangles. Vertices without triangles get the identity.
    """
    areas = TriangleMesh(before, faces).face_areas
    # Triangles without area at rest have the identity as gradient; it only counts where there are no others.
    areas = np.maximum(areas, 1e-9 * max(float(areas.max(initial=0.0)), np.finfo(float).tiny))
    ends = np.arange(0, faces.size + 1, 3)
    sums = csr_array((np.ones(faces.size), faces.ravel(), ends), shape=(len(faces), len(before)))
    totals = sums.T @ areas
    used = totals > 0
    of_faces = deformation_gradients(before, after, faces).reshape(-1, 9)

    def mean_around(values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Average values of triangles, (m, 9), around every vertex, (n, 9)."""
        return (sums.T @ (areas[:, None] * values)) / np.where(used, totals, 1.0)[:, None]

    of_vertices = mean_around(of_faces)
    for _ in range(_ROUNDS - 1):
        of_vertices = mean_around(sums @ of_vertices / 3.0)
    of_vertices[~used] = np.eye(3).ravel()
    turns = nearest_rotations(np.ascontiguousarray(of_vertices.T).reshape(3, 3, -1)).rotations
    return np.moveaxis(turns, 2, 0)
