# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape keys of one mesh taken to another along a point map, right across pose and proportion.

What is carried over is not by how far vertices move but how triangles deform (R. Sumner and J. Popovic, "Deformation
Transfer for Triangle Meshes", ACM Transactions on Graphics 23(3), 2004), turned as the map turns the surface there:
what bends an arm of one figure bends that of the other, wherever it points and however long it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array

from ...errors import InputError
from ...geometry.closest_points import ClosestPointFinder
from ...geometry.edge_energy import EdgeEnergy
from ...geometry.factorization import factorize
from ...geometry.laplacian import laplacian
from ...geometry.mesh import TriangleMesh
from .map_frames import MapFrames, map_frames, nearest_turns
from .surface_maps import PointMap
from .transfer import check_giver

# How strongly vertices are held where the map says they move to, against how triangles should deform, on a surface
# scaled to unit area: it only says where the whole goes.
_HELD = 0.05
# An offset below this share of the largest is none.
_STILL = 1e-6


@dataclass(frozen=True)
class ShapeCarrier:
    """Takes shape keys from one mesh to another; made once, as most of the work does not depend on the key.

    Attributes
    ----------
    points : PointMap
    giver, receiver : TriangleMesh
    frames : MapFrames
        How directions turn, at the receiver's vertices.
    origins : (f,) int64
        For each of the receiver's triangles that of the giver which it deforms like.
    turns : (f, 3, 3) float64
        How directions turn, at the receiver's triangles; zero where nothing is known.
    inverses : (g, 3, 3) float64
        Takes vectors to the giver's triangles' own coordinates: two edges and the normal.
    energy : EdgeEnergy
        Of the receiver.
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
        """Find out how what is carried turns, and which triangle of the giver each of the receiver's deforms like.

        Raises
        ------
        InputError
            A map of other meshes.
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
        """Return the offsets of the receiver, (m, 3), for those of the giver, (n, 3).

        Raises
        ------
        InputError
            Not three numbers for every vertex of the giver.
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
        # Vertices whose images stay where they are stay too, so that only the others are unknown.
        free = np.flatnonzero(moves & (held > 0))
        result = np.zeros_like(moved)
        if len(free):
            system = diags_array(held[free]) + self.energy.stiffness[free][:, free]
            result[free] = factorize(csc_array(system)).solve(np.ascontiguousarray(right[free].T)).T
        return result

    @cached_property
    def _areas(self) -> NDArray[np.float64]:
        """Shares of the area that the receiver's vertices have; 0 for unused ones."""
        shares = self.receiver.vertex_areas
        # Vertices of nothing but flat triangles still want to be somewhere.
        used = np.zeros(len(shares), bool)
        used[self.receiver.faces] = True
        return np.where(used, np.maximum(shares / shares.sum(), 1e-12), 0.0)

    def _gradients(self, offsets: NDArray[np.float64]) -> NDArray[np.float64]:
        """How each of the giver's triangles deforms, less the identity, (g, 3, 3)."""
        deformed = _frames_of(self.giver.corners + offsets[self.giver.faces])
        gradients = deformed @ self.inverses - np.eye(3)
        gradients[~self.inverses.any(axis=(1, 2))] = 0.0
        return gradients


def _frames_of(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Two edges of every triangle and its normal, as long as the root of its area, as columns, (g, 3, 3)."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    up = np.cross(first, second)
    lengths = np.linalg.norm(up, axis=1, keepdims=True)
    return np.stack([first, second, up / np.sqrt(np.where(lengths > 0, lengths, 1.0))], axis=2)


def _inverses(giver: TriangleMesh) -> NDArray[np.float64]:
    """Inverses of the triangles' frames; zero for those without area."""
    frames = _frames_of(giver.corners)
    sizes = np.linalg.norm(frames, axis=(1, 2))
    sound = np.abs(np.linalg.det(frames)) > 1e-9 * np.where(sizes > 0, sizes, 1.0) ** 3
    inverses = np.zeros_like(frames)
    inverses[sound] = np.linalg.inv(frames[sound])
    return inverses
