# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of rotation vectors without jumps by full turns between neighbors.

A rotation vector is a unit axis times an angle in radians. Adding 2 pi to the angle gives the same rotation, but
changes interpolation from or to it. A field with rotations beyond 180 degrees can only be interpolated after all of its
vectors have been chosen consistently.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree
from scipy.spatial.transform import Rotation

from ..arrays.components import component_labels
from ..arrays.label_groups import label_groups

LARGEST_TURN = 1.5 * np.pi
"""Three quarters of a turn, in radians: no limb rotates farther, but maps of surfaces can twist feet and hands."""

# Cutting a limb off at a joint affects less than this fraction of all edges.
_FEW = 0.02
# The vectors of one rotation differ by full turns; vectors that differ by more than half a turn are on different
# branches.
_HALF_TURN = np.pi


def rotation_matrices(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotations, (n, 3, 3), of rotation vectors, (n, 3) in radians, by Rodrigues' formula."""
    angles = np.linalg.norm(vectors, axis=1)
    along = np.sinc(angles / np.pi)
    around = 0.5 * np.square(np.sinc(angles / (2.0 * np.pi)))
    return matrices_about(vectors.T, along, around)


def matrices_about(
    axes: NDArray[np.float64], along: NDArray[np.float64], around: NDArray[np.float64] | float
) -> NDArray[np.float64]:
    """Return 1 + along [a] + around [a]^2, (n, 3, 3), where [a] is the cross product with an axis, (3, n)."""
    x, y, z = axes
    result = np.empty((len(x), 3, 3))
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


def unwound(
    vectors: NDArray[np.float64], edges: NDArray[np.int64], largest: float = LARGEST_TURN
) -> NDArray[np.float64]:
    """Choose rotation vectors that differ as little as possible between neighbors.

    Every connected component is traversed along the minimum spanning tree of relative angles, starting at the vertex
    nearest to the median.

    Parameters
    ----------
    vectors : (n, 3)
        The shortest rotation vectors, in radians.
    edges : (e, 2) int64
        Pairs of neighbors.
    largest : float
        Regions that would rotate by more than this angle, in radians, take the short way instead.

    Returns
    -------
    (n, 3) float64
        Vectors for the same rotations.
    """
    if not _jumps(vectors, edges).any():
        return vectors
    chosen = vectors.copy()
    for parents, children in _tree_levels(vectors, edges):
        chosen[children] = nearest_branches(vectors[children], chosen[parents])
    far = np.linalg.norm(chosen - vectors, axis=1) > _HALF_TURN
    regions = component_labels(*edges[far[edges].all(axis=1)].T, len(vectors))
    angles = np.zeros(len(vectors))
    np.maximum.at(angles, regions[far], np.linalg.norm(chosen[far], axis=1))
    back = far & (angles[regions] > largest)
    chosen[back] = vectors[back]
    return chosen


def unwound_towards(
    vectors: NDArray[np.float64],
    guesses: NDArray[np.float64],
    edges: NDArray[np.int64],
    largest: float = LARGEST_TURN,
) -> NDArray[np.float64]:
    """Choose rotation vectors close to `guesses`, (n, 3), if that leaves jumps at no more than a few edges.

    A limb that rotates by about 180 degrees can do so in two directions; this makes two shapes that move towards each
    other agree on one. Otherwise the result is that of :func:`unwound`.
    """
    alone, guided = unwound(vectors, edges, largest), nearest_branches(vectors, guesses)
    most = max(_jumps(alone, edges).sum(), _FEW * len(edges))
    return guided if _jumps(guided, edges).sum() <= most else alone


def nearest_branches(vectors: NDArray[np.float64], guesses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return, among the rotation vectors equivalent to `vectors`, (n, 3), those nearest to `guesses`, (n, 3)."""
    angles = np.linalg.norm(vectors, axis=1)
    lengths = np.linalg.norm(guesses, axis=1)
    # A rotation close to the identity has no reliable axis, so use that of the guess.
    axes = np.where(
        angles[:, None] > 1e-8,
        vectors / np.maximum(angles, 1e-300)[:, None],
        guesses / np.maximum(lengths, 1e-300)[:, None],
    )
    turns = np.round((np.einsum("nd,nd->n", guesses, axes) - angles) / (2.0 * np.pi))
    return vectors + (2.0 * np.pi * turns)[:, None] * axes


def _jumps(vectors: NDArray[np.float64], edges: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which edges connect different branches, (e,)."""
    return np.linalg.norm(vectors[edges[:, 0]] - vectors[edges[:, 1]], axis=1) > _HALF_TURN


def _tree_levels(vectors: NDArray[np.float64], edges: NDArray[np.int64]) -> list[tuple[NDArray, NDArray]]:
    """Return parents and children of every level of the spanning forest, starting with the roots' children."""
    count = len(vectors)
    turns = Rotation.from_rotvec(vectors)
    angles = (turns[edges[:, 0]] * turns[edges[:, 1]].inv()).magnitude()
    # The sparse graph would drop edges of weight zero.
    tree = minimum_spanning_tree(csr_array((angles + 1e-6, edges.T), shape=(count, count))).tocoo()
    roots = _roots(vectors, component_labels(*edges.T, count))
    # An extra vertex connects to every root, so that one traversal visits all trees.
    rows = np.concatenate([tree.coords[0], np.full(len(roots), count)])
    columns = np.concatenate([tree.coords[1], roots])
    forest = coo_array((np.ones(len(rows)), (rows, columns)), shape=(count + 1, count + 1)).tocsr()
    order, parents = breadth_first_order(forest, count, directed=False)
    place = np.empty(count + 1, np.int64)
    place[order] = np.arange(count + 1)
    # Breadth-first order groups the children of a level, in the order of their parents.
    places = place[parents[order[1:]]]
    ends = [1, 1 + len(roots)]
    while ends[-1] < count + 1:
        ends.append(1 + int(np.searchsorted(places, ends[-1])))
    return [(parents[order[first:last]], order[first:last]) for first, last in pairwise(ends[1:])]


def _roots(vectors: NDArray[np.float64], labels: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return for every component the vertex whose vector is nearest to the median."""
    return np.array(
        [
            own[np.square(vectors[own] - np.median(vectors[own], axis=0)).sum(axis=1).argmin()]
            for own in label_groups(labels, int(labels.max()) + 1)
        ]
    )
