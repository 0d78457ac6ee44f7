# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Merge coincident vertices, since files of separate triangles would otherwise seem to be full of holes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .edges import proper_faces, rim_vertices, used_part
from .mesh import TriangleMesh


def welded(mesh: TriangleMesh) -> TriangleMesh:
    """Return the mesh with coincident vertices merged and degenerate triangles removed.

    Unused vertices are removed as well.
    """
    used, faces = used_part(mesh.faces, len(mesh.vertices))
    places = place_labels(mesh.vertices[used])
    points = np.empty((int(places.max(initial=-1)) + 1, 3))
    points[places] = mesh.vertices[used]
    return TriangleMesh(points, np.ascontiguousarray(proper_faces(places[faces])))


@dataclass(frozen=True)
class ClosedSeams:
    """A mesh whose seams are closed, such as UV seams in glTF files.

    Attributes
    ----------
    mesh : TriangleMesh
        The mesh with coincident vertices of open edges merged. Vertices and triangles keep their numbers; bodies that
        touch stay apart.
    merged : (n,) int64
        The vertex that every vertex is merged with, or itself.
    """

    mesh: TriangleMesh
    merged: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: TriangleMesh) -> ClosedSeams:
        """Close the seams of a mesh; if there are none, it stays the same."""
        rim = rim_vertices(mesh.faces)
        _, first, places = np.unique(place_labels(mesh.vertices[rim]), return_index=True, return_inverse=True)
        merged = np.arange(len(mesh.vertices))
        if len(first) == len(rim):
            return cls(mesh, merged)
        merged[rim] = rim[first[places]]
        return cls(TriangleMesh(mesh.vertices, merged[mesh.faces]), merged)


def place_labels(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return numbers of the places of points, (n, 3), in the order of their coordinates, (n,)."""
    # Sorting by columns takes a tenth of the time of np.unique for rows.
    order = np.lexsort(points.T[::-1])
    ordered = points[order]
    is_first = np.ones(len(order), bool)
    is_first[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    places = np.empty(len(order), np.int64)
    places[order] = np.cumsum(is_first) - 1
    return places
