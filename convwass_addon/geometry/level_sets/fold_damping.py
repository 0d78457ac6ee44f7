# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduce displacements of a surface where they would flip triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..meshes.edge_means import EdgeMeans
from ..meshes.edges import faces_touching
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import mean_directions, triangle_normals

# A triangle counts as folded if the cosine between its normal and those of its vertices is below this.
_TURNED = 0.1
# How often corners of folded triangles are moved to the mean of their neighbors.
_SMOOTHINGS = 10
# If that is not enough, how often displacements are halved before they are dropped.
_HALVINGS = 5
# Rounds in which the reduction is spread over the neighbors.
_FADING = 2


def without_folds(
    mesh: TriangleMesh, normals: NDArray[np.float64], offsets: NDArray[np.float64], means: EdgeMeans
) -> NDArray[np.float64]:
    """Return displacements that flip no triangle that was not flipped before.

    Parameters
    ----------
    mesh : TriangleMesh
        The undisplaced surface.
    normals : (n, 3) float64
        Unit normals at its vertices.
    offsets : (n, 3) float64
        Displacements of its vertices.
    means : EdgeMeans
        Averages over the neighbors in the mesh.

    Returns
    -------
    (n, 3) float64
        The displacements; at triangles that they would flip, those to the mean of the neighbors, or smaller ones.
    """
    facing = mean_directions(normals, mesh.faces)
    before = np.einsum("md,md->m", mesh.face_normals, facing)
    is_folded = np.zeros(len(mesh.faces), bool)

    def folded(displaced: NDArray[np.float64], rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the corners of newly folded triangles if only some of them, (k,), have moved since the last time."""
        corners = (mesh.vertices + displaced).take(mesh.faces.take(rows, axis=0), axis=0)
        after = np.einsum("md,md->m", triangle_normals(corners), facing.take(rows, axis=0))
        is_folded[rows] = (after < _TURNED) & (after < before.take(rows))
        return np.unique(mesh.faces[is_folded])

    displaced, every = offsets.copy(), np.arange(len(mesh.faces))
    rows = every
    for _ in range(_SMOOTHINGS):
        found = folded(displaced, rows)
        if not len(found):
            return displaced
        middles = means.mean_points_at(mesh.vertices + displaced, found)
        displaced[found] = middles - mesh.vertices[found]
        moved = np.zeros(len(offsets), bool)
        moved[found] = True
        rows = faces_touching(mesh.faces, moved)
    shares, smoothed = np.ones(len(offsets)), displaced
    for halving in range(_HALVINGS + 1):
        found = folded(displaced, rows)
        if not len(found):
            break
        shares[found] = 0.5 * shares[found] if halving < _HALVINGS else 0.0
        displaced = means.spread_minimum(shares, _FADING)[:, None] * smoothed
        rows = every
    return displaced
