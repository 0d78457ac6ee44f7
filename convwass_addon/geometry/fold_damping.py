# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduce displacements of a surface where they would flip triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .edge_means import EdgeMeans
from .mesh import TriangleMesh
from .normals import mean_directions, triangle_normals

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
    before = np.einsum("md,md->m", triangle_normals(mesh.corners), facing)

    def folded(displaced: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the corners of newly folded triangles."""
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
