# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotations of vertex neighborhoods between two poses of a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .poisson_deformation import deformation_gradients
from .rotations import nearest_rotations

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
    corners = before[faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    # Triangles without area at rest have the identity as gradient; it only counts where there are no others.
    areas = np.maximum(areas, 1e-9 * max(float(areas.max(initial=0.0)), np.finfo(float).tiny))
    totals = np.bincount(faces.ravel(), np.repeat(areas, 3), len(before))
    used = totals > 0
    of_faces = deformation_gradients(before, after, faces).reshape(-1, 9)
    of_vertices = np.tile(np.eye(3).ravel(), (len(before), 1))
    for turn in range(_ROUNDS):
        if turn:
            of_faces = of_vertices[faces].mean(axis=1)
        for entry in range(9):
            sums = np.bincount(faces.ravel(), np.repeat(areas * of_faces[:, entry], 3), len(before))
            of_vertices[used, entry] = sums[used] / totals[used]
    turns = nearest_rotations(np.ascontiguousarray(of_vertices.T).reshape(3, 3, -1)).rotations
    return np.moveaxis(turns, 2, 0)
