# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacements of a surface, reduced where they would turn triangles over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .edge_means import EdgeMeans
from .mesh import TriangleMesh
from .normals import triangle_normals, unit_vectors

# Triangles may turn away from the normals about them up to this cosine.
_TURNED = 0.1
# So often, corners of folded triangles are moved to the middle of their neighbors.
_SMOOTHINGS = 10
# Where that does not do, offsets are halved so often at most, then dropped.
_HALVINGS = 5
# Rounds in which the reduction fades over the neighbors.
_FADING = 2


def without_folds(
    mesh: TriangleMesh, normals: NDArray[np.float64], offsets: NDArray[np.float64], means: EdgeMeans
) -> NDArray[np.float64]:
    """Return displacements that turn no triangle over which was not turned over before.

    Parameters
    ----------
    mesh : TriangleMesh
        The surface before it is displaced.
    normals : (n, 3) float64
        Where it faces at its vertices, unit vectors.
    offsets : (n, 3) float64
        Displacements of its vertices.
    means : EdgeMeans
        Of the mesh.

    Returns
    -------
    (n, 3) float64
        The displacements; about triangles that they turn over, those to the middle of the neighbors, or smaller ones.
    """
    facing = unit_vectors(normals[mesh.faces].sum(axis=1))
    before = np.einsum("md,md->m", triangle_normals(mesh.corners), facing)

    def folded(displaced: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the corners of triangles that are turned over now."""
        corners = (mesh.vertices + displaced)[mesh.faces]
        after = np.einsum("md,md->m", triangle_normals(corners), facing)
        return np.unique(mesh.faces[(after < _TURNED) & (after < before)])

    displaced = offsets.copy()
    for _ in range(_SMOOTHINGS):
        found = folded(displaced)
        if not len(found):
            return displaced
        middles = means.mean_points(mesh.vertices + displaced)
        displaced[found] = middles[found] - mesh.vertices[found]
    shares, smoothed = np.ones(len(offsets)), displaced
    for halving in range(_HALVINGS + 1):
        found = folded(displaced)
        if not len(found):
            break
        shares[found] = 0.5 * shares[found] if halving < _HALVINGS else 0.0
        displaced = means.spread_minimum(shares, _FADING)[:, None] * smoothed
    return displaced
