# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maximal balls inside a closed surface that touch it at its vertices, and the paths through them.

Their centers lie on the medial axis, along the middle of limbs of any thickness. The line between the centers of two
overlapping balls lies within their union, so paths from ball to ball never leave the body.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..meshes.edges import edge_lengths, mesh_edges
from ..meshes.mesh import TriangleMesh
from .touching_balls import ball_radii

# Chosen by eye; docs/performance, "Skeletons", lists what these and the other constants of the fit achieve.
# A ball is central if its radius is at least this fraction of that of the largest ball that contains its center.
_SMALLEST_SHARE = 0.35
# Exponent of the cost of paths: of the radius of the largest ball that contains a ball's center, over its own radius.
_DETOUR = 1.5
# Balls count as connected if they overlap by at least this fraction of the smaller radius.
_OVERLAP = 0.25
# At a fold, the balls of adjacent vertices are farther apart than the vertices by at least this factor.
_FOLDED = 2.0
# Number of nearest balls to which each ball is linked.
_NEIGHBORS = 40
# Points that represent the surface where only radii are asked for; up to twice as many of fine meshes.
_MOST_SAMPLES = 20_000


@dataclass(frozen=True)
class InnerBalls:
    """Balls inside a body.

    Attributes
    ----------
    centers : (b, 3) float64
        Inside the body.
    radii : (b,) float64
        Positive.
    costs : (b,) float64
        Factor of the length of paths through a ball: 1 in the middle of the body, more elsewhere.
    neighbors : (p, 2) int64
        Pairs of balls whose vertices share an edge of the surface. They are linked even if they do not overlap, as
        along limbs that are thinner than the triangles are long.
    """

    centers: NDArray[np.float64]
    radii: NDArray[np.float64]
    costs: NDArray[np.float64]
    neighbors: NDArray[np.int64]

    @cached_property
    def links(self) -> csr_array:
        """Lengths of the lines between overlapping balls, times their cost, (b, b), in both directions."""
        count = len(self.centers)
        near, neighbors = cKDTree(self.centers).query(self.centers, min(_NEIGHBORS, count))
        tails = np.repeat(np.arange(count), neighbors.shape[1])
        heads, lengths = neighbors.ravel(), near.ravel()
        smaller = np.minimum(self.radii[tails], self.radii[heads])
        kept = (tails != heads) & (lengths < self.radii[tails] + self.radii[heads] - _OVERLAP * smaller)
        tails = np.concatenate([tails[kept], self.neighbors[:, 0]])
        heads = np.concatenate([heads[kept], self.neighbors[:, 1]])
        order = np.unique(tails * count + heads, return_index=True)[1]
        tails, heads = tails[order], heads[order]
        lengths = np.linalg.norm(self.centers[tails] - self.centers[heads], axis=1)
        costs = np.maximum(lengths, np.finfo(float).tiny) * 0.5 * (self.costs[tails] + self.costs[heads])
        graph = coo_array((costs, (tails, heads)), shape=(count, count)).tocsr()
        return graph.maximum(graph.T).tocsr()

    def entrances(self, point: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the balls that contain a point, (3,), or the one nearest to it."""
        beyond = np.linalg.norm(self.centers - point, axis=1) - self.radii
        held = np.flatnonzero(beyond < 0)
        return held if len(held) else np.array([np.argmin(beyond)])


def inner_balls(mesh: TriangleMesh) -> InnerBalls:
    """Return connected balls that touch a surface at its vertices from inside.

    Balls in ridges and bumps, which are not central, are left out.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed, oriented outward, connected; every vertex is used.
    """
    normals = mesh.vertex_normals
    tree = cKDTree(_surface_samples(mesh))
    radii = ball_radii(mesh.vertices, normals, tree, 0.5 * mesh.diagonal)
    centers = mesh.vertices - radii[:, None] * normals
    radii = np.minimum(radii, tree.query(centers)[0])
    edges = mesh_edges(mesh.faces)
    # Across a fold, the balls of adjacent vertices are far apart.
    edges = edges[edge_lengths(centers, edges) <= _FOLDED * edge_lengths(mesh.vertices, edges)]
    found = InnerBalls(centers, radii, np.ones(len(radii)), edges)
    return _largest_part(_central(_subset(found, radii > 0)))


def touching_radii(mesh: TriangleMesh, chosen: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the radius of the largest ball inside a closed surface that touches it at some vertices, (k,).

    The surface of a fine mesh is represented by 20 000 to 40 000 of its vertices and centers of triangles.

    Parameters
    ----------
    mesh : TriangleMesh
        As for :func:`inner_balls`, in any number of components.
    chosen : (k,) int64
        The vertices.
    """
    normals = mesh.vertex_normals
    samples = _surface_samples(mesh)
    tree = cKDTree(samples[:: max(1, len(samples) // _MOST_SAMPLES)])
    return ball_radii(mesh.vertices[chosen], normals[chosen], tree, 0.5 * mesh.diagonal)


def _surface_samples(mesh: TriangleMesh) -> NDArray[np.float64]:
    return np.concatenate([mesh.vertices, mesh.corners.mean(axis=1)])


def _central(balls: InnerBalls) -> InnerBalls:
    """Compare every ball with the largest that contains its center, and remove relatively small ones."""
    held = cKDTree(balls.centers).query_ball_point(balls.centers, balls.radii)
    largest = balls.radii.copy()
    for radius, own in zip(balls.radii, held, strict=True):
        largest[own] = np.maximum(largest[own], radius)
    share = balls.radii / largest
    return _subset(replace(balls, costs=share**-_DETOUR), share >= _SMALLEST_SHARE)


def _largest_part(balls: InnerBalls) -> InnerBalls:
    labels = connected_components(balls.links, directed=False)[1]
    return _subset(balls, labels == np.argmax(np.bincount(labels)))


def _subset(balls: InnerBalls, kept: NDArray[np.bool_]) -> InnerBalls:
    number = np.cumsum(kept) - 1
    neighbors = number[balls.neighbors[kept[balls.neighbors].all(axis=1)]]
    return InnerBalls(balls.centers[kept], balls.radii[kept], balls.costs[kept], neighbors)
