# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Widen narrow angles by moving vertices along the surface.

Smart Laplacian smoothing: a vertex moves to the mean of its neighbors only if this increases the smallest angle around
it (L. Freitag, "On combining Laplacian and optimization-based mesh smoothing techniques", Trends in Unstructured Mesh
Generation 1997). Vertices on creases move along the crease, and corners stay: moves are restricted to the intersection
of the planes of all adjacent triangles (X. Jiao, "Face offsetting", Journal of Computational Physics 220, 2007).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..arrays.label_groups import label_order
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import triangle_normals
from .triangle_angles import smallest_angles

# Triangles with a smaller angle are narrow; a move must increase the smallest angle by at least the gain. In radians.
_NARROW, _GAIN = float(np.radians(25.0)), float(np.radians(0.1))
_ROUNDS = 8
# Directions count as normal to the surface if their eigenvalue exceeds this fraction of the largest one.
_OFF = 0.1
# Fractions of the move to the mean of the neighbors to try.
_SHARES = (1.0, 0.5)
# Smallest cosine between the normals of a triangle before and after a move.
_TURNED = 0.5


def with_wider_angles(mesh: TriangleMesh, most: float) -> TriangleMesh:
    """Move vertices of narrow triangles if this increases the smallest angle around them.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed or open.
    most : float
        Largest distance of a vertex from the planes of its triangles, in the unit of the mesh.

    Returns
    -------
    TriangleMesh
        The mesh with the same triangles.
    """
    vertices, faces = mesh.vertices.copy(), mesh.faces
    angles = smallest_angles(mesh.corners)
    # Vertices to examine: a vertex without a gain can only gain again after a neighbor has moved.
    is_open = np.ones(len(vertices), bool)
    for _ in range(_ROUNDS):
        is_chosen = np.zeros(len(vertices), bool)
        is_chosen[faces.compress(angles < _NARROW, axis=0)] = True
        is_chosen &= is_open
        if not is_chosen.any():
            break
        rings = _Rings.of(is_chosen, faces)
        moves = rings.moves(vertices, faces, most)
        is_open[rings.vertices] = moves.gains > 0.0
        if not len(moves.chosen):
            break
        vertices[rings.vertices[moves.chosen]] += moves.steps
        changed = rings.faces.compress(np.isin(rings.owners, moves.chosen))
        is_open[faces.take(changed, axis=0)] = True
        angles[changed] = smallest_angles(vertices.take(faces.take(changed, axis=0), axis=0))
    return replace(mesh, vertices=vertices)


@dataclass(frozen=True)
class _Moves:
    """Possible moves of vertices, and their gains.

    Attributes
    ----------
    gains : (k,) float64
        Increase of the smallest angle around each vertex, in radians.
    chosen : (c,) int64
        The vertices with the largest gains, no two of them neighbors.
    steps : (c, 3) float64
        Displacements of the chosen vertices.
    """

    gains: NDArray[np.float64]
    chosen: NDArray[np.int64]
    steps: NDArray[np.float64]


@dataclass(frozen=True)
class _Rings:
    """The triangles around some vertices.

    Attributes
    ----------
    vertices : (k,) int64
        The vertices.
    faces, corners, owners : (r,) int64
        Triangles, the vertex's corner in each, and the vertex's index in `vertices`; grouped by vertex.
    starts : (k,) int64
        Index of the first triangle of every vertex.
    """

    vertices: NDArray[np.int64]
    faces: NDArray[np.int64]
    corners: NDArray[np.int64]
    owners: NDArray[np.int64]
    starts: NDArray[np.int64]

    @classmethod
    def of(cls, is_chosen: NDArray[np.bool_], faces: NDArray[np.int64]) -> _Rings:
        """Collect the triangles around the vertices of a mask, (n,)."""
        sides = np.flatnonzero(is_chosen.take(faces.ravel()))
        ends = faces.ravel().take(sides)
        order = label_order(ends, len(is_chosen))
        sides, ends = sides[order], ends[order]
        starts = np.flatnonzero(np.diff(ends, prepend=-1))
        owners = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(ends)))
        return cls(ends[starts], sides // 3, sides % 3, owners, starts)

    def moves(self, vertices: NDArray[np.float64], faces: NDArray[np.int64], most: float) -> _Moves:
        """Find moves that increase the smallest angle around a vertex."""
        # Rotate every triangle so that the vertex comes first.
        around = faces.ravel().take(3 * self.faces[:, None] + (self.corners[:, None] + np.arange(3)) % 3)
        corners = vertices.take(around, axis=0)
        normals = triangle_normals(corners)
        middles = self._sum(corners[:, 1] + corners[:, 2]) / (2.0 * self._counts[:, None])
        moves = _along(self._sum(normals[:, :, None] * normals[:, None, :]), middles - vertices[self.vertices])
        heights = np.maximum.reduceat(
            np.abs(np.einsum("rd,rd->r", moves.take(self.owners, axis=0), normals)), self.starts
        )
        moves *= (most / np.maximum(heights, most))[:, None]
        before = np.minimum.reduceat(smallest_angles(corners), self.starts)
        gains, shares = np.zeros(len(before)), np.zeros(len(before))
        for share in _SHARES:
            tried = corners.copy()
            tried[:, 0] += share * moves.take(self.owners, axis=0)
            turned = np.einsum("rd,rd->r", triangle_normals(tried), normals) < _TURNED
            after = np.where(turned, 0.0, smallest_angles(tried))
            gain = np.minimum.reduceat(after, self.starts) - before
            is_better = gain > np.maximum(gains, _GAIN)
            gains[is_better], shares[is_better] = gain[is_better], share
        chosen = self._best_of_neighbors(around, gains, len(vertices))
        return _Moves(gains, chosen, shares[chosen, None] * moves[chosen])

    @property
    def _counts(self) -> NDArray[np.int64]:
        return np.diff(self.starts, append=len(self.owners))

    def _sum(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.add.reduceat(values, self.starts, axis=0)

    def _best_of_neighbors(
        self, around: NDArray[np.int64], gains: NDArray[np.float64], count: int
    ) -> NDArray[np.int64]:
        """Return the vertices with a larger gain than all their neighbors; ties go to the first."""
        order = np.argsort(-gains, kind="stable")
        order = order[gains[order] > 0.0]
        ranks = np.full(count, len(gains))
        ranks[self.vertices[order]] = np.arange(len(order))
        least = np.minimum.reduceat(np.minimum(ranks[around[:, 1]], ranks[around[:, 2]]), self.starts)
        return np.flatnonzero((ranks[self.vertices] < least) & (gains > 0.0))


def _along(spreads: NDArray[np.float64], moves: NDArray[np.float64]) -> NDArray[np.float64]:
    """Restrict moves, (k, 3), to the intersection of planes; `spreads` has the sums of n n^T over their normals n."""
    sizes, directions = np.linalg.eigh(spreads)
    kept = sizes < _OFF * sizes[:, -1:]
    return np.einsum("kij,kj,klj,kl->ki", directions, kept.astype(float), directions, moves)
