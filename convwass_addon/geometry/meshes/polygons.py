# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces with any number of corners, as Blender stores them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .mesh import TriangleMesh
from .quad_pairing import quad_pairs


@dataclass(frozen=True)
class PolygonEdges:
    """The edges of polygonal faces.

    Attributes
    ----------
    vertices : (e, 2) int64
        Their ends, the smaller vertex first, in lexicographic order.
    of_corners : (c,) int64
        The edge from every corner of the faces to the next one.
    """

    vertices: NDArray[np.int64]
    of_corners: NDArray[np.int64]


@dataclass(frozen=True)
class Polygons:
    """Polygonal faces of a mesh.

    Attributes
    ----------
    corners : (c,) int64
        Vertices of all faces, concatenated; counter-clockwise seen from outside.
    starts : (f,) int64
        Index in `corners` of each face's first corner.
    sources : (c,) int64
        For each corner, the corner 3 f + c of the triangles that the faces were made from.
    """

    corners: NDArray[np.int64]
    starts: NDArray[np.int64]
    sources: NDArray[np.int64]

    @property
    def owners(self) -> NDArray[np.int64]:
        """The face of every triangle that the faces were made from, (m,)."""
        counts = np.diff(self.starts, append=len(self.corners))
        owners = np.empty(int(self.sources.max(initial=-1)) // 3 + 1, np.int64)
        owners[self.sources // 3] = np.repeat(np.arange(len(self.starts)), counts)
        return owners

    @property
    def edges(self) -> PolygonEdges:
        """The edges, once each."""
        # Imported here because this module is loaded when the extension is enabled, and that one loads SciPy.
        from .edges import paired_vertices, sorted_pairs

        following = np.arange(1, len(self.corners) + 1)
        following[np.append(self.starts[1:], len(self.corners))[: len(self.starts)] - 1] = self.starts
        tails, heads = self.corners, self.corners[following]
        keys, order = sorted_pairs(tails, heads)
        is_first = np.diff(keys, prepend=-1) > 0
        of_corners = np.empty(len(order), np.int64)
        of_corners[order] = np.cumsum(is_first) - 1
        return PolygonEdges(paired_vertices(keys[is_first]), of_corners)

    @classmethod
    def of_triangles(cls, faces: NDArray[np.int64]) -> Polygons:
        """Convert triangles, (m, 3), without changes."""
        return cls(faces.ravel(), np.arange(0, faces.size, 3), np.arange(faces.size))

    @classmethod
    def of_quads(cls, mesh: TriangleMesh) -> Polygons:
        """Join triangles to quads; single triangles come last.

        Rows 2 i and 2 i + 1 of the form (a, b, c) and (a, c, d) are joined to (a, b, c, d), which undoes the splitting
        of :func:`.even_surface.even_surface`. The other triangles are joined where this gives good quads.
        """
        faces = mesh.faces
        numbers = np.arange(faces.size).reshape(faces.shape)
        pairs = len(faces) // 2
        paired = faces[: 2 * pairs].reshape(-1, 2, 3)
        fits = (paired[:, 0, 0] == paired[:, 1, 0]) & (paired[:, 0, 2] == paired[:, 1, 1])
        of_pairs = numbers[: 2 * pairs].reshape(-1, 2, 3)
        rest = np.concatenate([of_pairs[~fits].reshape(-1, 3), numbers[2 * pairs :]])
        found = quad_pairs(mesh.vertices, faces.ravel()[rest])
        single = np.ones(len(rest), bool)
        single[found // 3] = False
        quads = np.concatenate([of_pairs[fits].reshape(-1, 6)[:, [0, 1, 2, 5]], rest.ravel()[found]])
        rest = rest[single]
        starts = [np.arange(0, quads.size, 4), quads.size + np.arange(0, rest.size, 3)]
        sources = np.concatenate([quads.ravel(), rest.ravel()])
        return cls(faces.ravel()[sources], np.concatenate(starts), sources)
