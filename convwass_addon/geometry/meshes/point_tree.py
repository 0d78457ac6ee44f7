# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Search trees of points on surfaces."""

from __future__ import annotations

from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

_LEAF = 48


def point_tree(points: ArrayLike) -> cKDTree:
    """Return a search tree of points on a surface, (n, d), possibly with their directions.

    Surfaces fill little of the space. Nodes that are neither balanced nor shrunk to their points are built in less than
    half of the time. They answer as fast near the surface, and up to twice as fast far away (docs/performance,
    "Maps and registrations").
    """
    return cKDTree(points, leafsize=_LEAF, compact_nodes=False, balanced_tree=False)
