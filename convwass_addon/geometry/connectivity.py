# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a solid hangs together, counted on its closed surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from .isosurface import LevelSurface
from .mesh import TriangleMesh


@dataclass(frozen=True, order=True)
class Connectivity:
    """How a solid hangs together.

    Attributes
    ----------
    pieces, handles, bubbles : int
        Parts apart from each other, holes through them, and hollows inside them.
    """

    pieces: int
    handles: int
    bubbles: int

    @classmethod
    def of(cls, surface: LevelSurface) -> Connectivity:
        """Count what a closed surface has; every vertex belongs to triangles, every edge to two of them."""
        mesh = surface.mesh
        volumes = np.bincount(_face_pieces(mesh), weights=mesh.face_volumes)
        # Edges are three halves of the triangles.
        euler = len(mesh.vertices) - len(mesh.faces) // 2
        bubbles = int((volumes < 0).sum())
        return cls(len(volumes) - bubbles, len(volumes) - euler // 2, bubbles)

    def or_more(self, other: Connectivity) -> Connectivity:
        """Return the larger number of each kind."""
        return Connectivity(
            max(self.pieces, other.pieces), max(self.handles, other.handles), max(self.bubbles, other.bubbles)
        )

    def or_less(self, other: Connectivity) -> Connectivity:
        """Return the smaller number of each kind."""
        return Connectivity(
            min(self.pieces, other.pieces), min(self.handles, other.handles), min(self.bubbles, other.bubbles)
        )

    def beyond(self, most: Connectivity) -> Connectivity:
        """Return by how much each number is larger than another."""
        return Connectivity(
            max(self.pieces - most.pieces, 0), max(self.handles - most.handles, 0), max(self.bubbles - most.bubbles, 0)
        )


def _face_pieces(mesh: TriangleMesh) -> NDArray[np.int32]:
    """Label the triangles by the surface they belong to, (m,)."""
    faces, corners = len(mesh.faces), len(mesh.vertices)
    # A graph of triangles and vertices is in the order of its rows as it stands.
    ends = np.concatenate([np.arange(0, 3 * faces + 1, 3), np.full(corners, 3 * faces)]).astype(np.int32)
    named = (mesh.faces.ravel() + faces).astype(np.int32)
    graph = csr_array((np.ones(len(named), np.int8), named, ends), shape=(faces + corners,) * 2)
    return connected_components(graph, directed=False)[1][:faces]
