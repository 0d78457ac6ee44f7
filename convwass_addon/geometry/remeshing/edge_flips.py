# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flip edges to open narrow angles where this does not move the surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..meshes.edges import edge_use, faces_touching, pair_numbers
from ..meshes.face_neighbors import FaceNeighbors
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import triangle_normals
from .triangle_angles import smallest_angle_cosines

# Flip only triangles with an angle below 25 degrees (a cosine above this), and only for at least this gain.
_NARROW, _GAIN = float(np.cos(np.radians(25.0))), 1e-3
# Lower limit of the cosine between the normals of new triangles and of those that they replace.
_TURNED = 0.5
_ROUNDS = 3


def with_flipped_edges(mesh: TriangleMesh, most: float) -> TriangleMesh:
    """Flip edges of narrow triangles where this increases the smallest angle of the two triangles.

    Parameters
    ----------
    mesh : TriangleMesh
        Boundary and non-manifold edges are not flipped.
    most : float
        Largest distance that a flip may move the surface, in the unit of the mesh; this preserves creases.

    Returns
    -------
    TriangleMesh
        The same vertices and the same number of triangles; unchanged triangles keep their indices.
    """
    faces, cosines = mesh.faces, smallest_angle_cosines(mesh.corners)
    for _ in range(_ROUNDS):
        near = _around(faces, cosines > _NARROW, len(mesh.vertices))
        flips = _Flips.of(mesh.vertices, faces.take(near, axis=0), cosines.take(near), most)
        if not len(flips.first):
            break
        faces = faces.copy()
        for rows, new in ((near[flips.first], flips.new_first), (near[flips.second], flips.new_second)):
            faces[rows] = new
            cosines[rows] = smallest_angle_cosines(mesh.vertices[new])
    return TriangleMesh(mesh.vertices, faces)


def _around(faces: NDArray[np.int64], chosen: NDArray[np.bool_], count: int) -> NDArray[np.int64]:
    """Return all triangles that share a vertex with chosen ones, (m,) bool, of a mesh with `count` vertices."""
    touched = np.zeros(count, bool)
    touched[faces.compress(chosen, axis=0)] = True
    return faces_touching(faces, touched)


@dataclass(frozen=True)
class _Flips:
    """Pairs of triangles to replace, without repeated triangles, and their replacements."""

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    new_first: NDArray[np.int64]
    new_second: NDArray[np.int64]

    @classmethod
    def of(
        cls, vertices: NDArray[np.float64], faces: NDArray[np.int64], cosines: NDArray[np.float64], most: float
    ) -> _Flips:
        """Choose valid flips, at most one per triangle: the best. All triangles around narrow ones must be given."""
        use = edge_use(faces)
        neighbors = FaceNeighbors.of(use)
        sides, (one, other) = neighbors.sides, neighbors.faces
        worth = (np.maximum(cosines[one], cosines[other]) > _NARROW) & neighbors.agree
        sides, (one, other) = sides[:, worth], (one[worth], other[worth])
        # The edge runs from a to b in the first triangle; c and d are the opposite corners.
        flat = faces.ravel()
        a, b = flat[sides[0]], flat[_next(sides[0])]
        c, d = flat[_next(_next(sides[0]))], flat[_next(_next(sides[1]))]
        made = np.stack([np.stack([a, d, c], axis=1), np.stack([d, b, c], axis=1)])
        before = np.maximum(cosines[one], cosines[other])
        after = np.maximum(*(smallest_angle_cosines(vertices.take(own, axis=0)) for own in made))
        fits = after < before - _GAIN
        fits &= _distances(*(vertices.take(ends, axis=0) for ends in (a, b, c, d))) <= most
        fits &= _agree(vertices, faces[one], faces[other], *made)
        fits &= ~_is_edge(c, d, flat[use.side[use.start]], flat[_next(use.side[use.start])])
        chosen = _best_of_both(one, other, np.where(fits, before - after, 0.0), len(faces))
        # Of flips to the same new edge, as from both sides of a thin fin, the best one.
        _, own = np.unique(pair_numbers(c, d)[chosen], return_index=True)
        chosen = chosen[np.sort(own)]
        return cls(one[chosen], other[chosen], made[0, chosen], made[1, chosen])


def _next(sides: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the next half-edges of the same triangles."""
    return sides - sides % 3 + (sides + 1) % 3


def _distances(
    a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64], d: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the distances between the lines a b and c d, (n,): how far a flip moves the surface."""
    across = np.cross(b - a, d - c)
    lengths = np.linalg.norm(across, axis=1)
    heights = np.abs(np.einsum("nd,nd->n", c - a, across))
    return np.where(lengths > 0.0, heights / np.maximum(lengths, np.finfo(float).tiny), np.inf)


def _agree(vertices: NDArray[np.float64], *triangles: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return whether the last two of four triangles are not degenerate and face the same way as the first two."""
    first, second, *made = (triangle_normals(vertices[own]) for own in triangles)
    return np.all(
        [np.einsum("nd,nd->n", new, old) > _TURNED for new in made for old in (first, second)], axis=0
    ) & np.all([np.abs(own).max(axis=1) > 0.0 for own in made], axis=0)


def _is_edge(
    c: NDArray[np.int64], d: NDArray[np.int64], tails: NDArray[np.int64], heads: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Return which pairs of vertices are already joined by an edge; edges are sorted by their ends."""
    keys, wanted = pair_numbers(tails, heads), pair_numbers(c, d)
    place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return (keys[place] == wanted) | (c == d)


def _best_of_both(
    one: NDArray[np.int64], other: NDArray[np.int64], gains: NDArray[np.float64], count: int
) -> NDArray[np.int64]:
    """Return the pairs that are best for both of their triangles, best first; the first one wins ties."""
    order = np.argsort(-gains, kind="stable")
    order = order[gains[order] > 0.0]
    best = np.full(count, len(gains))
    ranks = np.arange(len(order))
    np.minimum.at(best, one[order], ranks)
    np.minimum.at(best, other[order], ranks)
    return order[(best[one[order]] == ranks) & (best[other[order]] == ranks)]
