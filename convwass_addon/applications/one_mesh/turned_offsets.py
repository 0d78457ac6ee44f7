# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Offsets of a few vertices that rotate with the surface around them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.surface_rotations import surface_rotations
from ...geometry.meshes.mesh import TriangleMesh


@dataclass(frozen=True)
class TurnedOffsets:
    """Offsets at the end of a path, in the frame of the undeformed mesh.

    Attributes
    ----------
    moved : (k,) int64
        The vertices that have an offset.
    around : (j,) int64
        These vertices and their neighbors.
    own : (k,) int64
        Indices of the vertices in `around`.
    faces : (m, 3) int64
        Triangles among `around`.
    rest : (j, 3) float64
        Positions in the undeformed mesh.
    offsets : (k, 3) float64
        Offsets, rotated back to the undeformed mesh.
    """

    moved: NDArray[np.int64]
    around: NDArray[np.int64]
    own: NDArray[np.int64]
    faces: NDArray[np.int64]
    rest: NDArray[np.float64]
    offsets: NDArray[np.float64]

    @classmethod
    def of(cls, mesh: TriangleMesh, end: NDArray[np.float64], offsets: NDArray[np.float64]) -> TurnedOffsets:
        """Compute the record from the offsets, (n, 3), of vertices whose positions at the end are `end`, (n, 3)."""
        has = (offsets != 0.0).any(axis=1)
        triangles = mesh.faces[has[mesh.faces].any(axis=1)]
        around, faces = np.unique(triangles, return_inverse=True)
        moved = around[has[around]]
        own = np.flatnonzero(has[around])
        blank = cls(moved, around, own, faces.reshape(-1, 3), mesh.vertices[around], offsets[moved])
        if not len(moved):
            return blank
        back = np.einsum("kji,kj->ki", blank._turns(end), offsets[moved])
        return cls(moved, around, own, blank.faces, blank.rest, back)

    def added(self, vertices: NDArray[np.float64], guided: NDArray[np.float64], share: float) -> NDArray[np.float64]:
        """Add a fraction of the offsets to vertices, (n, 3), rotated like the guided mesh, (n, 3)."""
        if not len(self.moved):
            return vertices
        found = vertices.copy()
        found[self.moved] += share * np.einsum("kij,kj->ki", self._turns(guided), self.offsets)
        return found

    def _turns(self, guided: NDArray[np.float64]) -> NDArray[np.float64]:
        return surface_rotations(self.rest, guided[self.around], self.faces)[self.own]
