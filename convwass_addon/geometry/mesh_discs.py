# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a surface that are topological discs, found around some of its triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from .edges import edge_use
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
        vertices, faces = np.unique(mesh.faces[triangles], return_inverse=True)
        faces = faces.reshape(-1, 3)
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
    """

    mesh: TriangleMesh
    around: csr_array
    across: csr_array

    @classmethod
    def of(cls, mesh: TriangleMesh) -> FaceGraph:
        """Prepare the adjacency."""
        count = len(mesh.faces)
        rows = np.repeat(np.arange(count), 3)
        around = csr_array((np.ones(3 * count, np.int8), (mesh.faces.ravel(), rows)), shape=(len(mesh.vertices), count))
        use = edge_use(mesh.faces)
        shared = use.start[use.count == 2]
        one, other = use.face[shared], use.face[shared + 1]
        ends = np.concatenate([one, other]), np.concatenate([other, one])
        return cls(mesh, around, csr_array((np.ones(len(ends[0]), np.int8), ends), shape=(count, count)))

    def touching(self, vertices: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the triangles at some vertices, ascending."""
        return np.unique(self.around[vertices].indices).astype(np.int64)

    def grown(self, triangles: NDArray[np.int64], rings: int = 1) -> NDArray[np.int64]:
        """Return triangles and rings of triangles around them, ascending."""
        for _ in range(rings):
            triangles = self.touching(np.unique(self.mesh.faces[triangles]))
        return triangles

    def components(self, triangles: NDArray[np.int64]) -> list[NDArray[np.int64]]:
        """Split triangles into parts that are connected across edges."""
        count, labels = connected_components(self.across[triangles][:, triangles], directed=False)
        return [triangles[labels == label] for label in range(count)]

    def filled(self, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return triangles, ascending, and those in holes between them."""
        near = self.grown(triangles, _HOLE_RINGS - 1)
        beyond = np.setdiff1d(self.grown(near), near)
        others = np.setdiff1d(np.concatenate([near, beyond]), triangles)
        if not len(others):
            return triangles
        parts = self.components(others)
        holes = [part for part in parts if not np.isin(part, beyond).any()]
        if len(holes) == len(parts):
            # On a small closed surface everything is near; the largest part is the outside.
            holes = sorted(holes, key=len)[:-1]
        return np.sort(np.concatenate([triangles, *holes]))

    def disc_around(self, triangles: NDArray[np.int64], most_rings: int) -> MeshDisc | None:
        """Return a disc with all of some triangles, grown by as few rings as needed; None if that is not enough."""
        for ring in range(most_rings + 1):
            triangles = self.filled(self.grown(triangles) if ring else triangles)
            found = MeshDisc.of(self.mesh, triangles)
            if found is not None:
                return found
        return None
