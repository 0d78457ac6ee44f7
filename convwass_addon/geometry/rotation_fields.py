# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of rotations as rotation vectors, without jumps by full turns between neighbors.

A rotation vector is an axis of unit length times an angle in radians. Adding 2 pi to the angle changes nothing about
the rotation, but everything about the way there: a field that turns beyond 180 degrees somewhere can be interpolated
only after all of its vectors have been chosen consistently.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree
from scipy.spatial.transform import Rotation

# Regions that would turn by more than this, three quarters of a circle, take the short way instead: no limb turns so
# far, but maps twist feet and hands.
_LARGEST_TURN = 1.5 * np.pi
# A joint that has to be torn for its limb to go another way takes less than this share of all edges.
_FEW = 0.02
# Two vectors of one rotation differ by a full turn; two that differ by more than half of it are on different branches.
_HALF_TURN = np.pi


def rotation_matrices(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotations, (n, 3, 3), of rotation vectors, (n, 3) in radians, by Rodrigues' formula."""
    angles = np.linalg.norm(vectors, axis=1)
    along = np.sinc(angles / np.pi)
    around = 0.5 * np.square(np.sinc(angles / (2.0 * np.pi)))
    x, y, z = vectors.T
    result = np.empty((len(vectors), 3, 3))
    result[:, 0, 0] = 1.0 - around * (y * y + z * z)
    result[:, 1, 1] = 1.0 - around * (x * x + z * z)
    result[:, 2, 2] = 1.0 - around * (x * x + y * y)
    for (row, column), axis, product in (((1, 0), z, x * y), ((0, 2), y, x * z), ((2, 1), x, y * z)):
        symmetric, skew = around * product, along * axis
        result[:, row, column] = symmetric + skew
        result[:, column, row] = symmetric - skew
    return result


def rotation_vectors(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the shortest rotation vectors, (n, 3) in radians, of rotations, (n, 3, 3)."""
    if not len(matrices):
        return np.empty((0, 3))
    return Rotation.from_matrix(matrices).as_rotvec()


def unwound(vectors: NDArray[np.float64], edges: NDArray[np.int64]) -> NDArray[np.float64]:
    """Choose rotation vectors that change as little as can be from neighbor to neighbor.

    Every connected component is walked along the spanning tree of the smallest relative angles, beginning at the vertex
    nearest to the median. Regions that would turn by more than three quarters of a circle go the short way.

    Parameters
    ----------
    vectors : (n, 3)
        The shortest rotation vectors, radians.
    edges : (e, 2) int64
        Which vertices are neighbors.

    Returns
    -------
    (n, 3) float64
        Vectors of the same rotations.
    """
    if not _jumps(vectors, edges).any():
        return vectors
    chosen = vectors.copy()
    for parents, children in _levels(vectors, edges):
        chosen[children] = nearest_branches(vectors[children], chosen[parents])
    far = np.linalg.norm(chosen - vectors, axis=1) > _HALF_TURN
    regions = _regions(edges[far[edges].all(axis=1)], len(vectors))
    largest = np.zeros(len(vectors))
    np.maximum.at(largest, regions[far], np.linalg.norm(chosen[far], axis=1))
    back = far & (largest[regions] > _LARGEST_TURN)
    chosen[back] = vectors[back]
    return chosen


def unwound_towards(
    vectors: NDArray[np.float64], guesses: NDArray[np.float64], edges: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Choose rotation vectors close to others, (n, 3), where that leaves jumps at a few edges at most.

    A limb that turns by about 180 degrees has two ways to do so; this makes two shapes that move towards each other
    take the same one. Otherwise vectors are chosen as by :func:`unwound`.
    """
    alone, guided = unwound(vectors, edges), nearest_branches(vectors, guesses)
    most = max(_jumps(alone, edges).sum(), _FEW * len(edges))
    return guided if _jumps(guided, edges).sum() <= most else alone


def nearest_branches(vectors: NDArray[np.float64], guesses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return, of all vectors of the same rotations as `vectors`, (n, 3), the ones nearest to `guesses`, (n, 3)."""
    angles = np.linalg.norm(vectors, axis=1)
    lengths = np.linalg.norm(guesses, axis=1)
    # Nearly no rotation has no axis of its own: it takes that of the guess.
    axes = np.where(
        angles[:, None] > 1e-8,
        vectors / np.maximum(angles, 1e-300)[:, None],
        guesses / np.maximum(lengths, 1e-300)[:, None],
    )
    turns = np.round((np.einsum("nd,nd->n", guesses, axes) - angles) / (2.0 * np.pi))
    return vectors + (2.0 * np.pi * turns)[:, None] * axes


def _jumps(vectors: NDArray[np.float64], edges: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Tell which edges lead from one branch to another, (e,)."""
    return np.linalg.norm(vectors[edges[:, 0]] - vectors[edges[:, 1]], axis=1) > _HALF_TURN


def _levels(vectors: NDArray[np.float64], edges: NDArray[np.int64]) -> list[tuple[NDArray, NDArray]]:
    """Return parents and children of every level of the spanning forest, from the roots' children on."""
    count = len(vectors)
    turns = Rotation.from_rotvec(vectors)
    angles = (turns[edges[:, 0]] * turns[edges[:, 1]].inv()).magnitude()
    # Lengths of zero would be no edges.
    tree = minimum_spanning_tree(csr_array((angles + 1e-6, edges.T), shape=(count, count))).tocoo()
    roots = _roots(vectors, _regions(edges, count))
    # One more vertex, from which the walk goes to every root first.
    rows = np.concatenate([tree.coords[0], np.full(len(roots), count)])
    columns = np.concatenate([tree.coords[1], roots])
    forest = coo_array((np.ones(len(rows)), (rows, columns)), shape=(count + 1, count + 1)).tocsr()
    order, parents = breadth_first_order(forest, count, directed=False)
    place = np.empty(count + 1, np.int64)
    place[order] = np.arange(count + 1)
    # Parents come in the order of their children, so that the children of a level follow each other.
    places = place[parents[order[1:]]]
    ends = [1, 1 + len(roots)]
    while ends[-1] < count + 1:
        ends.append(1 + int(np.searchsorted(places, ends[-1])))
    return [(parents[order[first:last]], order[first:last]) for first, last in pairwise(ends[1:])]


def _regions(edges: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Label `count` vertices by what edges join, (count,)."""
    graph = coo_array((np.ones(len(edges), np.int8), edges.T), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def _roots(vectors: NDArray[np.float64], labels: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the vertex of every component whose vector is nearest to the component's median."""
    order = np.argsort(labels, kind="stable")
    members = np.split(order, np.flatnonzero(np.diff(labels[order])) + 1)
    return np.array(
        [own[np.square(vectors[own] - np.median(vectors[own], axis=0)).sum(axis=1).argmin()] for own in members]
    )
