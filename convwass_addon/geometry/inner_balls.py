# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The largest balls inside a closed surface that touch it at its vertices, and the ways through them.

The centers lie on the medial axis, along the middle of limbs of any thickness. A straight line between the centers of
two balls that overlap stays in the two, so that ways from ball to ball never leave the body.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .mesh import TriangleMesh
from .normals import vertex_normals

# Chosen by eye; what they and the other constants of the fit give is measured in docs/performance.md, "Skeletons".
# Rounds in which a ball shrinks, and the share of its radius by which the surface may reach into it in the end.
_ROUNDS, _TOLERANCE = 40, 1e-3
# What a ball touches lies this far apart at least, in its radii.
_SEPARATION = 0.5
# A ball belongs to the middle of a body part if it is this large, in radii of the largest that holds its center.
_SMALLEST_SHARE = 0.35
# Ways through a ball are as many times longer as the largest that holds its center is larger, to this power.
_DETOUR = 1.5
# Balls that reach into each other by less than this share of the smaller radius are no way.
_OVERLAP = 0.25
# Vertices whose balls are so many times farther apart than they are themselves are on different sides of a fold.
_FOLDED = 2.0
# Balls to which each is linked: the nearest ones.
_NEIGHBORS = 40


@dataclass(frozen=True)
class InnerBalls:
    """Balls inside a body.

    Attributes
    ----------
    centers : (b, 3) float64
        All inside the body.
    radii : (b,) float64
        Positive.
    costs : (b,) float64
        How many times longer a way through a ball counts: 1 in the middle of the body, more aside.
    neighbors : (p, 2) int64
        Balls whose vertices an edge of the surface joins: linked even where they do not overlap, as along limbs that
        are thinner than the triangles are long.
    """

    centers: NDArray[np.float64]
    radii: NDArray[np.float64]
    costs: NDArray[np.float64]
    neighbors: NDArray[np.int64]

    @cached_property
    def links(self) -> csr_array:
        """Lengths of the lines between balls that overlap, times their cost, (b, b), both ways."""
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
        """Return the balls that hold a point, (3,), or the one that it is nearest to."""
        beyond = np.linalg.norm(self.centers - point, axis=1) - self.radii
        held = np.flatnonzero(beyond < 0)
        return held if len(held) else np.array([np.argmin(beyond)])


def inner_balls(mesh: TriangleMesh) -> InnerBalls:
    """Return balls that touch a surface at its vertices from inside and hang together.

    By shrinking (Ma, Bae and Choi, "3D medial axis point approximation using nearest neighbors and the normal field",
    2012). Balls in ridges and bumps, which hardly belong to the middle of anything, are left out.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed, outward, in one piece; every vertex is used.
    """
    normals = vertex_normals(mesh.vertices, mesh.faces)
    samples = np.concatenate([mesh.vertices, mesh.corners.mean(axis=1)])
    tree = cKDTree(samples)
    radii = np.full(len(mesh.vertices), 0.5 * float(np.linalg.norm(np.ptp(mesh.bounds, axis=0))))
    active = np.arange(len(radii))
    for _ in range(_ROUNDS):
        centers = mesh.vertices[active] - radii[active, None] * normals[active]
        distances, nearest = tree.query(centers)
        reach = mesh.vertices[active] - samples[nearest]
        along = np.einsum("ni,ni->n", reach, normals[active])
        shrunk = np.einsum("ni,ni->n", reach, reach) / np.maximum(2.0 * along, np.finfo(float).tiny)
        # Close to where the ball touches, the facets of a round body are no bumps.
        apart = np.linalg.norm(reach, axis=1) >= _SEPARATION * shrunk
        shrinks = apart & (distances < (1.0 - _TOLERANCE) * radii[active]) & (along > 0) & (shrunk < radii[active])
        active = active[shrinks]
        radii[active] = shrunk[shrinks]
        if not len(active):
            break
    centers = mesh.vertices - radii[:, None] * normals
    radii = np.minimum(radii, tree.query(centers)[0])
    a, b, c = mesh.faces.T
    edges = np.concatenate([np.stack([a, b], axis=1), np.stack([b, c], axis=1), np.stack([c, a], axis=1)])
    # Where the body is folded, the balls of neighbors are far apart.
    apart = np.linalg.norm(centers[edges[:, 0]] - centers[edges[:, 1]], axis=1)
    edges = edges[apart <= _FOLDED * np.linalg.norm(mesh.vertices[edges[:, 0]] - mesh.vertices[edges[:, 1]], axis=1)]
    found = InnerBalls(centers, radii, np.ones(len(radii)), edges)
    return _largest_part(_central(_some(found, radii > 0)))


def _central(balls: InnerBalls) -> InnerBalls:
    """Compare every ball with the largest that holds its center, and leave out what is small beside it."""
    held = cKDTree(balls.centers).query_ball_point(balls.centers, balls.radii)
    largest = balls.radii.copy()
    for radius, own in zip(balls.radii, held, strict=True):
        largest[own] = np.maximum(largest[own], radius)
    share = balls.radii / largest
    return _some(replace(balls, costs=share**-_DETOUR), share >= _SMALLEST_SHARE)


def _largest_part(balls: InnerBalls) -> InnerBalls:
    labels = connected_components(balls.links, directed=False)[1]
    return _some(balls, labels == np.argmax(np.bincount(labels)))


def _some(balls: InnerBalls, kept: NDArray[np.bool_]) -> InnerBalls:
    number = np.cumsum(kept) - 1
    neighbors = number[balls.neighbors[kept[balls.neighbors].all(axis=1)]]
    return InnerBalls(balls.centers[kept], balls.radii[kept], balls.costs[kept], neighbors)
