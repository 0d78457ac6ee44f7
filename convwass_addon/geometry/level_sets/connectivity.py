# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Betti numbers of a solid, computed from its closed surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..meshes.edges import face_components
from .isosurface import LevelSurface


@dataclass(frozen=True, order=True)
class Connectivity:
    """The topology of a solid.

    Attributes
    ----------
    pieces, handles, bubbles : int
        Numbers of connected components, of holes through them, and of hollows inside them.
    """

    pieces: int
    handles: int
    bubbles: int

    @classmethod
    def of(cls, surface: LevelSurface) -> Connectivity:
        """Count from a closed manifold surface: every vertex is used, every edge has two triangles."""
        mesh = surface.mesh
        volumes = np.bincount(face_components(mesh.faces), weights=mesh.face_volumes)
        # A closed surface has three edges for every two triangles.
        euler = len(mesh.vertices) - len(mesh.faces) // 2
        bubbles = int((volumes < 0).sum())
        return cls(len(volumes) - bubbles, len(volumes) - euler // 2, bubbles)

    def or_more(self, other: Connectivity) -> Connectivity:
        """Return the larger of each pair of numbers."""
        return Connectivity(
            max(self.pieces, other.pieces), max(self.handles, other.handles), max(self.bubbles, other.bubbles)
        )

    def or_less(self, other: Connectivity) -> Connectivity:
        """Return the smaller of each pair of numbers."""
        return Connectivity(
            min(self.pieces, other.pieces), min(self.handles, other.handles), min(self.bubbles, other.bubbles)
        )

    def beyond(self, most: Connectivity) -> Connectivity:
        """Return by how much each number exceeds that of another."""
        return Connectivity(
            max(self.pieces - most.pieces, 0), max(self.handles - most.handles, 0), max(self.bubbles - most.bubbles, 0)
        )
