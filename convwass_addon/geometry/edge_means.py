# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Means of values over the neighbors of every vertex of a mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .edges import edge_ends, edge_use
from .mesh import TriangleMesh


@dataclass(frozen=True)
class EdgeMeans:
    """The edges of a mesh, over which values are averaged.

    Attributes
    ----------
    ends : (e, 2) int64
        The vertices of every edge.
    counts : (n,) int64
        Neighbors of every vertex, or 1 where it has none.
    """

    ends: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: TriangleMesh) -> EdgeMeans:
        """Prepare means over the vertices of a mesh."""
        ends = edge_ends(mesh.faces, edge_use(mesh.faces))
        return cls(ends, np.maximum(np.bincount(ends.ravel(), minlength=len(mesh.vertices)), 1))

    def mean(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Average values of the vertices, (n,), over the neighbors of each; 0 where it has none."""
        first, second = self.ends.T
        sums = np.bincount(first, values[second], len(self.counts))
        return (sums + np.bincount(second, values[first], len(self.counts))) / self.counts

    def mean_points(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Average points of the vertices, (n, d), in the same way."""
        return np.stack([self.mean(part) for part in points.T], axis=1)

    def with_neighbors(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Add the neighbors of some vertices, (n,)."""
        first, second = self.ends.T
        found = chosen.copy()
        found[second[chosen[first]]] = True
        found[first[chosen[second]]] = True
        return found

    def spread_minimum(self, values: NDArray[np.float64], rounds: int) -> NDArray[np.float64]:
        """Let values, (n,), fall off smoothly towards smaller ones: they are no more than the means of neighbors."""
        for _ in range(rounds):
            values = np.minimum(values, self.mean(values))
        return values
