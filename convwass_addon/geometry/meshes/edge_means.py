# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Averages of values over the neighbors of mesh vertices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.label_sums import label_sums
from .edges import edge_ends, edge_use
from .mesh import TriangleMesh


@dataclass(frozen=True)
class EdgeMeans:
    """The edges of a mesh, for averaging over neighbors.

    Attributes
    ----------
    ends : (e, 2) int64
        The vertices of every edge.
    counts : (n,) int64
        Number of neighbors of every vertex, at least 1 to divide by.
    """

    ends: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: TriangleMesh) -> EdgeMeans:
        """Prepare averages over the neighbors in a mesh."""
        ends = edge_ends(mesh.faces, edge_use(mesh.faces))
        # Columns are used one by one.
        return cls(np.asfortranarray(ends), np.maximum(np.bincount(ends.ravel(), minlength=len(mesh.vertices)), 1))

    def mean(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Average vertex values, (n,), over the neighbors of each vertex; 0 without neighbors."""
        first, second = self.ends.T
        sums = np.bincount(first, values.take(second), len(self.counts))
        return (sums + np.bincount(second, values.take(first), len(self.counts))) / self.counts

    def mean_points(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Average points, (n, d), in the same way."""
        return np.stack([self.mean(part) for part in points.T], axis=1)

    def mean_points_at(self, points: NDArray[np.float64], vertices: NDArray[np.int64]) -> NDArray[np.float64]:
        """Average points, (n, d), over the neighbors of some different vertices, (k,), only, as (k, d)."""
        count = len(self.counts)
        chosen = np.zeros(count, bool)
        chosen[vertices] = True
        sums = np.zeros((len(vertices), points.shape[1]))
        for own, others in (self.ends.T, self.ends.T[::-1]):
            edges = np.flatnonzero(chosen.take(own))
            sums += label_sums(own.take(edges), points.take(others.take(edges), axis=0), count).take(vertices, axis=0)
        return sums / self.counts.take(vertices)[:, None]

    def with_neighbors(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return a vertex mask, (n,), extended by its neighbors."""
        first, second = self.ends.T
        found = chosen.copy()
        found[second[chosen[first]]] = True
        found[first[chosen[second]]] = True
        return found

    def spread_minimum(self, values: NDArray[np.float64], rounds: int) -> NDArray[np.float64]:
        """Lower values, (n,), repeatedly to at most the mean of their neighbors, so that minima spread smoothly."""
        for _ in range(rounds):
            values = np.minimum(values, self.mean(values))
        return values
