# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer shape keys to another mesh along a point map, across differences in pose and proportion.

What is transferred are the deformations of triangles rather than the offsets of vertices (R. Sumner and J. Popovic,
"Deformation Transfer for Triangle Meshes", ACM Transactions on Graphics 23(3), 2004), rotated like the map rotates the
surface there. A key that bends an arm of one figure bends that of the other, in any direction and of any length.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array

from ...errors import InputError
from ...geometry.algebra.factorization import factorize
from ...geometry.deformation.edge_energy import EdgeEnergy
from ...geometry.meshes.closest_points import ClosestPointFinder
from ...geometry.meshes.laplacian import laplacian
from ...geometry.meshes.mesh import TriangleMesh
from .map_frames import MapFrames, map_frames, nearest_turns
from .surface_maps import PointMap
from .transfer import check_giver

# Weight of the vertex positions predicted by the map relative to the deformations of triangles, on a surface of unit
# area: just enough to fix the position of the whole.
_HELD = 0.05
# Offsets below this fraction of the largest count as zero.
_STILL = 1e-6


@dataclass(frozen=True)
class ShapeCarrier:
    """Transfers shape keys between two meshes; built once, because most of the work does not depend on the key.

    Attributes
    ----------
    points : PointMap
    giver, receiver : TriangleMesh
    frames : MapFrames
        Rotations at the receiver's vertices.
    origins : (f,) int64
        For each of the receiver's triangles, the giver's triangle whose deformation it takes.
    turns : (f, 3, 3) float64
        Rotations at the receiver's triangles; zero where unknown.
    inverses : (g, 3, 3) float64
        Maps vectors to the coordinates of the giver's triangles: two edges and the normal.
    energy : EdgeEnergy
        Energy of the receiver.
    """

    points: PointMap
    giver: TriangleMesh
    receiver: TriangleMesh
    frames: MapFrames
    origins: NDArray[np.int64]
    turns: NDArray[np.float64]
    inverses: NDArray[np.float64]
    energy: EdgeEnergy

    @classmethod
    def of(cls, points: PointMap, giver: TriangleMesh, receiver: TriangleMesh) -> ShapeCarrier:
        """Find the rotations, and the giver's triangle for each of the receiver's.

        Raises
        ------
        InputError
            The map belongs to other meshes.
        """
        check_giver(points, giver)
        if len(points) != len(receiver.vertices):
            raise InputError("The map belongs to a mesh with other vertices; compute it again.")
        stiffness = laplacian(receiver)
        frames = map_frames(points, receiver, giver, stiffness)
        known = points.found[receiver.faces].all(axis=1)
        middles = points.at(giver, giver.vertices)[receiver.faces].mean(axis=1)
        origins = np.zeros(len(receiver.faces), np.int64)
        origins[known] = ClosestPointFinder(giver.corners).find_about(middles[known]).triangles
        turns = nearest_turns(frames.turns[receiver.faces].sum(axis=1), frames.side)
        turns[~known] = 0.0
        return cls(points, giver, receiver, frames, origins, turns, _inverses(giver), EdgeEnergy.of(receiver))

    def carried(self, offsets: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the receiver's offsets, (m, 3), for the giver's offsets, (n, 3).

        Raises
        ------
        InputError
            Not three finite numbers for every vertex of the giver.
        """
        if offsets.shape != self.giver.vertices.shape or not np.isfinite(offsets).all():
            raise InputError("A shape key must have three numbers for every vertex.")
        most = float(np.abs(offsets).max(initial=0.0))
        if most == 0:
            return np.zeros((len(self.points), 3))
        moved = np.einsum("nij,nj->ni", self.frames.turns, self.points.at(self.giver, offsets))
        moved *= self.frames.stretches[:, None]
        moves = np.linalg.norm(self.points.at(self.giver, np.abs(offsets)), axis=1) > _STILL * most
        gradients = self._gradients(offsets)[self.origins]
        gradients = self.turns @ gradients @ np.swapaxes(self.turns, 1, 2)
        held = _HELD * self._areas
        right = held[:, None] * moved + self.energy.pulls(gradients)
        # Vertices whose images do not move are fixed, so only the others are unknowns.
        free = np.flatnonzero(moves & (held > 0))
        result = np.zeros_like(moved)
        if len(free):
            system = diags_array(held[free]) + self.energy.stiffness[free][:, free]
            result[free] = factorize(csc_array(system)).solve_columns(right[free])
        return result

    @cached_property
    def _areas(self) -> NDArray[np.float64]:
        """Relative areas of the receiver's vertices; 0 for unused ones."""
        shares = self.receiver.vertex_areas
        # Vertices of degenerate triangles need a small positive area to be determined.
        return np.where(self.receiver.is_used, np.maximum(shares / shares.sum(), 1e-12), 0.0)

    def _gradients(self, offsets: NDArray[np.float64]) -> NDArray[np.float64]:
        """Deformation gradients of the giver's triangles minus the identity, (g, 3, 3)."""
        deformed = _frames_of(self.giver.corners + offsets[self.giver.faces])
        gradients = deformed @ self.inverses - np.eye(3)
        gradients[~self.inverses.any(axis=(1, 2))] = 0.0
        return gradients


def _frames_of(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Two edges and the normal of every triangle as columns, (g, 3, 3); the normal as long as the root of the area."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    up = np.cross(first, second)
    lengths = np.linalg.norm(up, axis=1, keepdims=True)
    return np.stack([first, second, up / np.sqrt(np.where(lengths > 0, lengths, 1.0))], axis=2)


def _inverses(giver: TriangleMesh) -> NDArray[np.float64]:
    """Inverses of the triangles' frames; zero for degenerate triangles."""
    frames = _frames_of(giver.corners)
    sizes = np.linalg.norm(frames, axis=(1, 2))
    sound = np.abs(np.linalg.det(frames)) > 1e-9 * np.where(sizes > 0, sizes, 1.0) ** 3
    inverses = np.zeros_like(frames)
    inverses[sound] = np.linalg.inv(frames[sound])
    return inverses
