# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges of a triangle mesh: adjacency, boundary, connected components and Euler characteristic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.components import component_labels
from ..arrays.label_groups import label_order
from .mesh import TriangleMesh


@dataclass(frozen=True)
class EdgeUse:
    """The three half-edges of every triangle, sorted by undirected edge.

    Attributes
    ----------
    side : (3m,) int64
        Each half-edge: 3 f + c runs from corner c of triangle f to the next.
    face : (3m,) int64
        Triangle of each half-edge.
    forward : (3m,) bool
        True where the half-edge runs from the smaller vertex index to the larger.
    start : (e,) int64
        Where each undirected edge begins in the arrays above.
    count : (e,) int64
        Number of triangles at each undirected edge.
    """

    side: NDArray[np.int64]
    face: NDArray[np.int64]
    forward: NDArray[np.bool_]
    start: NDArray[np.int64]
    count: NDArray[np.int64]


def edge_use(faces: NDArray[np.int64]) -> EdgeUse:
    """Group the half-edges of `faces`, (m, 3), by undirected edge."""
    tail = faces.ravel()
    head = np.roll(faces, -1, axis=1).ravel()
    key, order = sorted_pairs(tail, head)
    start = np.flatnonzero(np.r_[True, key[1:] != key[:-1]]) if len(key) else np.empty(0, np.int64)
    count = np.diff(np.r_[start, len(key)])
    return EdgeUse(side=order, face=order // 3, forward=(tail < head)[order], start=start, count=count)


def pair_numbers(one: NDArray[np.int64], other: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return numbers of undirected pairs of vertices, (k,) each, ordered by the smaller vertex, then by the larger."""
    return (np.minimum(one, other) << 32) | np.maximum(one, other)


def sorted_pairs(one: NDArray[np.int64], other: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Sort undirected pairs of vertices, (k,) each, by their numbers; return these and the stable order, (k,) each."""
    low, high = np.minimum(one, other), np.maximum(one, other)
    count = int(high.max(initial=0)) + 1
    order = label_order(high, count)
    order = order.take(label_order(low.take(order), count))
    return ((low << 32) | high).take(order), order


def paired_vertices(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the vertices of pairs, (k, 2), smaller index first, from the numbers of :func:`pair_numbers`."""
    return np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1)


def edge_ends(faces: NDArray[np.int64], use: EdgeUse) -> NDArray[np.int64]:
    """Return the vertices of every undirected edge, (e, 2), in the direction of a triangle; `use` is from `faces`."""
    sides = use.side[use.start]
    return np.stack([faces.ravel()[sides], np.roll(faces, -1, axis=1).ravel()[sides]], axis=1)


def mesh_edges(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the edges of `faces`, (m, 3), between different vertices, each once and sorted, smaller index first."""
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys, _ = sorted_pairs(tails, heads)
    ends = paired_vertices(keys[np.diff(keys, prepend=-1) > 0])
    return ends[ends[:, 0] < ends[:, 1]]


def rim_vertices(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the vertices at edges that only one of `faces`, (m, 3), has, sorted."""
    use = edge_use(faces)
    return np.unique(edge_ends(faces, use)[use.count == 1])


def edge_lengths(points: NDArray[np.float64], ends: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the lengths of edges, (e,), given points, (n, 3), and which of them the ends are, (e, 2)."""
    return np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)


def side_lengths(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the lengths of the sides of triangles, (m, 3, 3) corners, opposite each corner, (m, 3)."""
    return np.linalg.norm(np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1), axis=2)


@dataclass(frozen=True)
class Topology:
    """Topological properties of a mesh.

    Attributes
    ----------
    euler : int
        Vertices - edges + faces, counting used vertices only; a closed surface of genus g has 2 - 2 g per component.
    open_edges : int
        Edges with only one face.
    uneven_edges : int
        Non-manifold edges: with more than two faces, or with two faces of opposite orientation.
    """

    euler: int
    open_edges: int
    uneven_edges: int

    @property
    def closed(self) -> bool:
        """Whether every edge has two faces of consistent orientation."""
        return self.open_edges == 0 and self.uneven_edges == 0


def topology(mesh: TriangleMesh, use: EdgeUse | None = None) -> Topology:
    """Compute the Euler characteristic and count irregular edges; `use` is `edge_use(mesh.faces)` if known."""
    use = edge_use(mesh.faces) if use is None else use
    agree = np.add.reduceat(np.where(use.forward, 1, -1), use.start) == 0 if len(use.start) else np.empty(0, bool)
    return Topology(
        euler=_count_distinct(mesh.faces.ravel()) - len(use.start) + len(mesh.faces),
        open_edges=int((use.count == 1).sum()),
        uneven_edges=int(((use.count > 2) | ((use.count == 2) & ~agree)).sum()),
    )


def _count_distinct(numbers: NDArray[np.int64]) -> int:
    """Count distinct nonnegative numbers; NumPy's unique takes seconds for millions of them."""
    return int(np.count_nonzero(np.bincount(numbers)))


def face_components(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Label the triangles by connected component, (m,); components share no vertex."""
    if not len(faces):
        return np.empty(0, np.int64)
    return _joined_vertices(faces, int(faces.max()) + 1)[faces[:, 0]]


def vertex_components(mesh: TriangleMesh) -> NDArray[np.int64]:
    """Label the vertices by connected component, 0, 1, ..., (n,); -1 where no triangle uses them.

    Components share no vertex. Triangles that repeat a vertex connect nothing, as no heat flows through them.
    """
    faces = proper_faces(mesh.faces)
    labels = np.full(len(mesh.vertices), -1, np.int64)
    used = np.zeros(len(labels), bool)
    used[faces] = True
    found = _joined_vertices(faces, len(labels))[used]
    # Renumber directly: NumPy's unique takes seconds for millions of labels.
    is_label = np.bincount(found) > 0
    labels[used] = (np.cumsum(is_label) - 1)[found]
    return labels


def proper_faces(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return those of some triangles, (m, 3), that have three different vertices."""
    a, b, c = faces.T
    return faces[(a != b) & (b != c) & (c != a)]


def proper_part(mesh: TriangleMesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the vertices that `proper_faces` use, (n,), and these triangles between them, (m, 3)."""
    return used_part(proper_faces(mesh.faces), len(mesh.vertices))


def used_part(faces: NDArray[np.int64], count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return which of `count` vertices some triangles, (m, 3), use, (n,), and the triangles between them, (m, 3)."""
    # NumPy's unique takes seconds for millions of corners.
    is_used = np.zeros(count, bool)
    is_used[faces] = True
    return np.flatnonzero(is_used), (np.cumsum(is_used) - 1)[faces]


def faces_between(faces: NDArray[np.int64], vertices: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return the triangles, (f, 3), that are between some of `count` vertices, (k,), only, as indices in these."""
    place = np.full(count, -1, np.int64)
    place[vertices] = np.arange(len(vertices))
    found = place[faces]
    return found[(found >= 0).all(axis=1)]


def faces_touching(faces: NDArray[np.int64], vertices: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the indices of those of `faces`, (m, 3), that have at least one of some vertices, a mask (n,)."""
    a, b, c = (vertices.take(corner) for corner in faces.T)
    return np.flatnonzero(a | b | c)


def component_areas(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return the areas of the connected components; loose vertices belong to none."""
    labels = vertex_components(mesh)
    used = labels >= 0
    return np.bincount(labels[used], mesh.vertex_areas[used])


def _joined_vertices(faces: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Label `count` vertices by connected component of the triangles' edges."""
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    return component_labels(*ends.T, count)
