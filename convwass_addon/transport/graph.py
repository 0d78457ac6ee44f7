# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Graphs of distributions, prepared for propagation."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..geometry.arrays.components import component_labels
from ..geometry.arrays.label_groups import label_groups
from ..sentence import first_names


@dataclass(frozen=True)
class PropagationGraph:
    """An undirected graph some of whose vertices are fixed.

    Every edge e has two ends (half-edges): 2 e at its first vertex and 2 e + 1 at its second, so the other end of h is
    h ^ 1. Edges between two fixed vertices carry no unknown and are left out.

    Attributes
    ----------
    size : int
        Number of vertices.
    vertex_of_end : (2 e,) int64
        The vertex of every end.
    weight_of_end : (2 e,) float64
        The weight of the edge of every end.
    fixed : (size,) bool
        Whether the vertex's distribution is given.
    """

    size: int
    vertex_of_end: NDArray[np.int64]
    weight_of_end: NDArray[np.float64]
    fixed: NDArray[np.bool_]

    @classmethod
    def from_edges(
        cls, edges: ArrayLike, edge_weights: ArrayLike | float, fixed: Collection[int], size: int | None = None
    ) -> PropagationGraph:
        """Validate and convert an edge list.

        Parameters
        ----------
        edges : (e, 2)
            Pairs of vertices.
        edge_weights : (e,) or float
            Positive weights.
        fixed : collection of int
            Vertices whose distributions are given.
        size : int, optional
            Number of vertices; by default just enough for the edges and the fixed vertices.

        Raises
        ------
        ValueError
            Edges that are not pairs, are loops, or leave the graph; weights that are not positive; vertices without a
            path to a fixed one. The message names the argument.
        """
        pairs = _vertices(edges, "edges") if np.size(edges) else np.empty((0, 2), np.int64)
        if pairs.ndim != 2 or pairs.shape[1] != 2:
            raise ValueError(f"edges must have the shape (e, 2), got {pairs.shape}")
        if not len(fixed):
            raise ValueError("fixed must hold at least one vertex with its distribution")
        given = _vertices(sorted(fixed), "fixed")
        count = int(max(pairs.max(initial=-1), given.max()) + 1) if size is None else int(size)
        if min(pairs.min(initial=0), given.min()) < 0 or max(pairs.max(initial=-1), given.max()) >= count:
            raise ValueError(f"edges and fixed must name vertices between 0 and {count - 1}")
        loops = pairs[pairs[:, 0] == pairs[:, 1], 0]
        if len(loops):
            raise ValueError(f"edges must not run from a vertex to itself, as one at vertex {loops[0]} does")
        weights = checked_edge_weights(edge_weights, len(pairs))
        is_fixed = np.zeros(count, bool)
        is_fixed[given] = True
        _check_reached(pairs, is_fixed)
        kept = ~(is_fixed[pairs[:, 0]] & is_fixed[pairs[:, 1]])
        ends = pairs[kept].ravel()
        return cls(count, ends, np.repeat(weights[kept], 2), is_fixed)

    @cached_property
    def total_weights(self) -> NDArray[np.float64]:
        """The sum of the weights of the edges at every vertex, (size,)."""
        return np.bincount(self.vertex_of_end, self.weight_of_end, self.size)

    @cached_property
    def ends_at(self) -> tuple[NDArray[np.int64], ...]:
        """The ends at every vertex, one array for each of the `size` vertices."""
        return tuple(label_groups(self.vertex_of_end, self.size))

    @cached_property
    def parts(self) -> NDArray[np.int64]:
        """Connected component of every free vertex, (size,), -1 at fixed vertices.

        Components that only meet at fixed vertices are independent problems.
        """
        tails, heads = self.vertex_of_end[0::2], self.vertex_of_end[1::2]
        inner = ~(self.fixed[tails] | self.fixed[heads])
        labels = component_labels(tails[inner], heads[inner], self.size)
        parts = np.full(self.size, -1)
        parts[~self.fixed] = np.unique(labels[~self.fixed], return_inverse=True)[1]
        return parts

    @cached_property
    def part_of_end(self) -> NDArray[np.int64]:
        """The component of every end's edge, (2 e,)."""
        parts = self.parts[self.vertex_of_end]
        return np.maximum(parts, parts[np.arange(len(parts)) ^ 1])

    @cached_property
    def colors(self) -> tuple[NDArray[np.int64], ...]:
        """Color classes: the fixed vertices, then groups of free vertices that no edge joins.

        The kernel is applied to all ends of a group at once. Greedy coloring in order of decreasing degree (Welsh and
        Powell 1967).
        """
        color = np.where(self.fixed, 0, -1)
        neighbors = [self.vertex_of_end[ends ^ 1] for ends in self.ends_at]
        for vertex in sorted(np.flatnonzero(~self.fixed), key=lambda v: -len(neighbors[v])):
            taken = set(color[neighbors[vertex]])
            color[vertex] = next(c for c in range(1, self.size + 1) if c not in taken)
        return tuple(np.flatnonzero(color == c) for c in range(color.max() + 1))


def line(count: int) -> NDArray[np.int64]:
    """Edges of a path of `count` vertices, (count - 1, 2)."""
    return np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)


def _check_reached(pairs: NDArray[np.int64], fixed: NDArray[np.bool_]) -> None:
    labels = component_labels(*pairs.T, len(fixed))
    lost = np.flatnonzero(~np.isin(labels, labels[fixed]))
    if len(lost):
        names = first_names([str(vertex) for vertex in lost])
        raise ValueError(f"edges must connect every vertex with a fixed one; no path leads to {names}")


def checked_edge_weights(edge_weights: ArrayLike | float, count: int) -> NDArray[np.float64]:
    """Return the weights of all edges, (count,), from one for each or one for all; ValueError if they are invalid."""
    weights = np.asarray(edge_weights, dtype=np.float64)
    if weights.shape not in ((), (count,)):
        raise ValueError(f"edge_weights must be one number or {count}, got shape {weights.shape}")
    if not (np.isfinite(weights).all() and (weights > 0).all()):
        raise ValueError("edge_weights must be positive numbers")
    return np.broadcast_to(weights, count)


def _vertices(numbers: ArrayLike, name: str) -> NDArray[np.int64]:
    vertices = np.asarray(numbers)
    if not np.issubdtype(vertices.dtype, np.integer):
        raise ValueError(f"{name} must name vertices by whole numbers, got {vertices.dtype}")
    return vertices.astype(np.int64)
