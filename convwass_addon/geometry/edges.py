# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges of a triangle mesh: who shares them, where it is open, its pieces, its Euler number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .mesh import TriangleMesh


@dataclass(frozen=True)
class EdgeUse:
    """The three half-edges of every triangle, sorted so that those of one edge lie together.

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
    # One 64-bit key per edge sorts fifty times faster than np.unique on pairs.
    key = (np.minimum(tail, head) << 32) | np.maximum(tail, head)
    order = np.argsort(key, kind="stable")
    key = key[order]
    start = np.flatnonzero(np.r_[True, key[1:] != key[:-1]]) if len(key) else np.empty(0, np.int64)
    count = np.diff(np.r_[start, len(key)])
    return EdgeUse(side=order, face=order // 3, forward=(tail < head)[order], start=start, count=count)


def edge_ends(faces: NDArray[np.int64], use: EdgeUse) -> NDArray[np.int64]:
    """Return the vertices of every undirected edge, (e, 2), as a triangle runs along it; `use` is that of `faces`."""
    sides = use.side[use.start]
    return np.stack([faces.ravel()[sides], np.roll(faces, -1, axis=1).ravel()[sides]], axis=1)


@dataclass(frozen=True)
class Topology:
    """What a mesh is made of.

    Attributes
    ----------
    euler : int
        Vertices - edges + faces, over the vertices in use. A closed surface of genus g has 2 - 2 g per piece.
    open_edges : int
        Edges with one face only.
    uneven_edges : int
        Edges with two faces that run along them the same way, or with more than two faces.
    """

    euler: int
    open_edges: int
    uneven_edges: int

    @property
    def closed(self) -> bool:
        """True where every edge has two faces that agree on what is outside."""
        return self.open_edges == 0 and self.uneven_edges == 0


def topology(mesh: TriangleMesh, use: EdgeUse | None = None) -> Topology:
    """Count the Euler number and irregular edges of `mesh`; `use` is that of its faces, where it is known."""
    use = edge_use(mesh.faces) if use is None else use
    agree = np.add.reduceat(np.where(use.forward, 1, -1), use.start) == 0 if len(use.start) else np.empty(0, bool)
    return Topology(
        euler=_different(mesh.faces.ravel()) - len(use.start) + len(mesh.faces),
        open_edges=int((use.count == 1).sum()),
        uneven_edges=int(((use.count > 2) | ((use.count == 2) & ~agree)).sum()),
    )


def _different(numbers: NDArray[np.int64]) -> int:
    """Count different numbers, none of which is negative; NumPy's unique takes seconds for millions of them."""
    return int(np.count_nonzero(np.bincount(numbers)))


def face_components(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Label the triangles by the piece they belong to, (m,); pieces share no vertex."""
    if not len(faces):
        return np.empty(0, np.int64)
    return _joined_vertices(faces, int(faces.max()) + 1)[faces[:, 0]]


def vertex_components(mesh: TriangleMesh) -> NDArray[np.int64]:
    """Label the vertices by the piece they belong to, 0, 1, ..., (n,); -1 where no triangle uses them.

    Pieces share no vertex. Triangles that name a vertex twice hold nothing together, as no heat flows through them.
    """
    faces = mesh.faces[distinct_corners(mesh.faces)]
    labels = np.full(len(mesh.vertices), -1, np.int64)
    used = np.zeros(len(labels), bool)
    used[faces] = True
    found = _joined_vertices(faces, len(labels))[used]
    # Numbered anew by hand: NumPy's unique takes seconds for millions of labels.
    is_label = np.bincount(found) > 0
    labels[used] = (np.cumsum(is_label) - 1)[found]
    return labels


def distinct_corners(faces: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Tell the triangles with three different vertices from those that name one twice, (m,)."""
    a, b, c = faces.T
    return (a != b) & (b != c) & (c != a)


def _joined_vertices(faces: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Label `count` vertices so that those joined by triangles are alike."""
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_array((np.ones(len(ends), np.int8), (ends[:, 0], ends[:, 1])), shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.int64)
