# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the edges nearest to points of the plane by measuring all of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Pairs of a point and an edge processed together, few enough for the processor's cache.
_AT_ONCE = 1 << 15


@dataclass(frozen=True)
class NearestEdges:
    """Where edges are nearest to points.

    Attributes
    ----------
    edges : (k,) int64
        The nearest edge of every point.
    shares : (k,) float64
        Where on it the nearest point is, from 0 at its start to 1.
    distances : (k,) float64
        The distances from there.
    """

    edges: NDArray[np.int64]
    shares: NDArray[np.float64]
    distances: NDArray[np.float64]


def nearest_edges(points: NDArray[np.float64], starts: NDArray[np.float64], along: NDArray[np.float64]) -> NearestEdges:
    """Return the edges nearest to points.

    Parameters
    ----------
    points : (k, 2)
        The points.
    starts, along : (e, 2)
        Where edges start, at least one, and the vectors from there to their ends.
    """
    found = NearestEdges(np.empty(len(points), np.int64), np.empty(len(points)), np.empty(len(points)))
    (x, y), (along_x, along_y) = starts.T, along.T
    squares = np.maximum(np.square(along).sum(axis=1), np.finfo(np.float64).tiny)
    for part in np.array_split(np.arange(len(points)), max(1, len(points) * len(starts) // _AT_ONCE)):
        # One array per coordinate: with both in one, this takes three times as long.
        beyond_x, beyond_y = points[part, 0, None] - x, points[part, 1, None] - y
        shares = np.clip((beyond_x * along_x + beyond_y * along_y) / squares, 0.0, 1.0)
        away = np.square(beyond_x - shares * along_x) + np.square(beyond_y - shares * along_y)
        edges, rows = away.argmin(axis=1), np.arange(len(part))
        found.edges[part], found.shares[part] = edges, shares[rows, edges]
        found.distances[part] = np.sqrt(away[rows, edges])
    return found
