# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a surface that are topological discs, found around some of its triangles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from ..arrays.distinct import sorted_distinct
from .edges import edge_use
from .face_neighbors import FaceNeighbors
from .mesh import TriangleMesh

# Rings of triangles around a part in which holes of the part are looked for.
_HOLE_RINGS = 8


@dataclass(frozen=True)
class MeshDisc:
    """A part of a mesh that is a topological disc.

    Attributes
    ----------
    triangles : (k,) int64
        Of the mesh.
    vertices : (v,) int64
        Of the mesh, ascending.
    faces : (k, 3) int64
        The triangles as indices into `vertices`.
    rim : (b,) int64
        Indices into `vertices` of the boundary, counter-clockwise.
    """

    triangles: NDArray[np.int64]
    vertices: NDArray[np.int64]
    faces: NDArray[np.int64]
    rim: NDArray[np.int64]

    @property
    def inner(self) -> NDArray[np.int64]:
        """Indices into `vertices` of those inside the boundary."""
        is_inner = np.ones(len(self.vertices), bool)
        is_inner[self.rim] = False
        return np.flatnonzero(is_inner)

    @classmethod
    def of(cls, mesh: TriangleMesh, triangles: NDArray[np.int64]) -> MeshDisc | None:
        """Return some triangles as a disc; None if they are none."""
        corners = mesh.faces[triangles]
        vertices = sorted_distinct(corners.ravel())
        faces = np.searchsorted(vertices, corners)
        use = edge_use(faces)
        if (use.count > 2).any() or len(vertices) - len(use.start) + len(faces) != 1:
            return None
        rim = _only_loop(faces, use.side[use.start[use.count == 1]])
        return None if rim is None else cls(triangles, vertices, faces, rim)


def _only_loop(faces: NDArray[np.int64], sides: NDArray[np.int64]) -> NDArray[np.int64] | None:
    """Return the vertices along half-edges that form a single closed loop, otherwise None."""
    tails, heads = faces.ravel()[sides].tolist(), np.roll(faces, -1, axis=1).ravel()[sides].tolist()
    after = dict(zip(tails, heads, strict=True))
    if len(after) != len(tails) or not tails:
        return None
    loop = [tails[0]]
    while len(loop) < len(tails):
        following = after.get(loop[-1])
        if following is None or following == loop[0]:
            return None
        loop.append(following)
    return np.array(loop) if after.get(loop[-1]) == loop[0] else None


@dataclass(frozen=True)
class FaceGraph:
    """Adjacency of the triangles of a mesh. All methods take time in proportion to the parts they are about.

    Attributes
    ----------
    mesh : TriangleMesh
        The mesh.
    around : csr_array
        Triangles at every vertex, (n, m).
    across : csr_array
        Triangles that share an edge, (m, m).
    is_closed : bool
        Whether two triangles share every edge.
    """

    mesh: TriangleMesh
    around: csr_array
    across: csr_array
    is_closed: bool

    @classmethod
    def of(cls, mesh: TriangleMesh) -> FaceGraph:
        """Prepare the adjacency."""
        count = len(mesh.faces)
        rows = np.repeat(np.arange(count), 3)
        around = csr_array((np.ones(3 * count, np.int8), (mesh.faces.ravel(), rows)), shape=(len(mesh.vertices), count))
        use = edge_use(mesh.faces)
        one, other = FaceNeighbors.of(use).faces
        ends = np.concatenate([one, other]), np.concatenate([other, one])
        across = csr_array((np.ones(len(ends[0]), np.int8), ends), shape=(count, count))
        return cls(mesh, around, across, len(one) == len(use.start))

    def touching(self, vertices: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the triangles at some vertices, ascending."""
        return sorted_distinct(self.around[vertices].indices.astype(np.int64))

    def grown(self, triangles: NDArray[np.int64], rings: int = 1) -> NDArray[np.int64]:
        """Return triangles and rings of triangles around them, ascending."""
        return np.sort(np.concatenate([triangles, *self._rings(triangles, rings)]))

    def _rings(self, triangles: NDArray[np.int64], count: int) -> list[NDArray[np.int64]]:
        """Return rings of triangles around some others, each ascending."""
        # Each ring only needs the previous one.
        is_known, is_passed = self._is_known, self._is_passed
        rings, vertices = [triangles], []
        is_known[triangles] = True
        for _ in range(count):
            corners = self.mesh.faces[rings[-1]].ravel()
            vertices.append(sorted_distinct(corners[~is_passed[corners]]))
            is_passed[vertices[-1]] = True
            near = self.around[vertices[-1]].indices
            rings.append(sorted_distinct(near[~is_known[near]].astype(np.int64)))
            is_known[rings[-1]] = True
        for ring, passed in zip(rings, [*vertices, np.empty(0, np.int64)], strict=True):
            is_known[ring], is_passed[passed] = False, False
        return rings[1:]

    @cached_property
    def _is_known(self) -> NDArray[np.bool_]:
        """Marks of triangles, all False between calls."""
        return np.zeros(len(self.mesh.faces), bool)

    @cached_property
    def _is_passed(self) -> NDArray[np.bool_]:
        """Marks of vertices, all False between calls."""
        return np.zeros(len(self.mesh.vertices), bool)

    def components(self, triangles: NDArray[np.int64]) -> list[NDArray[np.int64]]:
        """Split triangles, ascending, into parts that are connected across edges."""
        labels = self._labels(triangles)
        order = np.argsort(labels, kind="stable")
        return np.split(triangles[order], np.cumsum(np.bincount(labels))[:-1])

    def _labels(self, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return which part of some triangles, ascending, each belongs to: parts are connected across edges."""
        rows = self.across[triangles]
        # Selecting columns would take time in proportion to the mesh.
        places = np.searchsorted(triangles, rows.indices)
        kept = triangles.take(places, mode="clip") == rows.indices
        tails = np.repeat(np.arange(len(triangles)), np.diff(rows.indptr))[kept]
        ends = np.ones(len(tails), np.int8), (tails, places[kept])
        return connected_components(csr_array(ends, shape=(len(triangles),) * 2), directed=False)[1]

    def filled(self, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return triangles, ascending, and those in holes between them."""
        rings = self._rings(triangles, _HOLE_RINGS)
        others = np.sort(np.concatenate(rings))
        if not len(others):
            return triangles
        labels = self._labels(others)
        sizes = np.bincount(labels)
        is_hole = np.ones(len(sizes), bool)
        # A part that goes on is none.
        is_hole[labels[np.searchsorted(others, rings[-1])]] = False
        if is_hole.all():
            # On a small closed surface everything is near; the largest part is the outside.
            is_hole[np.flatnonzero(sizes == sizes.max())[-1]] = False
        return np.sort(np.concatenate([triangles, others[is_hole[labels]]]))

    def disc_around(self, triangles: NDArray[np.int64], most_rings: int) -> MeshDisc | None:
        """Return a disc with all of some triangles, grown by as few rings as needed; None if that is not enough."""
        for ring in range(most_rings + 1):
            triangles = self.grown(triangles) if ring else triangles
            found = MeshDisc.of(self.mesh, triangles)
            # A disc has no holes unless it ends at the border of the mesh.
            if found is None or not self.is_closed:
                whole = self.filled(triangles)
                if len(whole) > len(triangles):
                    triangles, found = whole, MeshDisc.of(self.mesh, whole)
            if found is not None:
                return found
        return None
