# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices near each other whose sides of the surface face away from each other, as on both sides of a sheet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

OPPOSITE = -0.5
"""Sides face away from each other if the cosine between their normals is below this."""


def opposite_sides(
    tree: cKDTree, normals: NDArray[np.float64], some: NDArray[np.int64], neighbors: int, reach: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the places in `some` and the vertices that face away from these, (k,) each, the nearest first.

    Parameters
    ----------
    tree : cKDTree
        Of the vertices.
    normals : (n, 3) float64
        Unit normals at the vertices.
    some : (m,) int64
        The vertices for which others are sought.
    neighbors : int
        Number of nearest vertices, at least 2, that are considered for each.
    reach : float
        Largest distance.
    """
    distances, near = tree.query(tree.data[some], neighbors, distance_upper_bound=reach)
    places, ranks = np.nonzero(np.isfinite(distances))
    others = near[places, ranks]
    away = np.flatnonzero(np.einsum("kd,kd->k", normals[some[places]], normals[others]) < OPPOSITE)
    return places[away], others[away]
