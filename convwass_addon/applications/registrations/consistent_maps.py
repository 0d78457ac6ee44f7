# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between three and more shapes that agree with each other.

Where shapes are mapped pair by pair, the way from one to another and on to a third rarely ends where the direct map
does, so that the deformed shapes of a blend do not coincide. Only the best maps are kept, those of the maximum spanning
tree of their scores, and all others become compositions of these. The worst map of a composition is at least as good as
the direct one: that holds for all paths of a maximum spanning tree (T. Hu, "The Maximum Capacity Route Problem",
Operations Research 9(6), 1961).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import depth_first_order, minimum_spanning_tree

from ...geometry.meshes.normals import vertex_normals
from ...progress import Control
from .carriers import Carrier
from .laid_meshes import Laid
from .shape_deformations import ShapeDeformation

# The tree is found by costs, one more than the largest score minus a score: sparse arrays have no zeros.
_MOST = 2.0


def composed_ways(scores: Mapping[tuple[int, int], float], count: int) -> dict[tuple[int, int], list[int]]:
    """Return the pairs whose maps become compositions.

    Parameters
    ----------
    scores : mapping of (int, int) to float
        The score of the map of every pair of shapes that occur together, 0 to 1; smaller index first.
    count : int
        The number of shapes.

    Returns
    -------
    mapping of (int, int) to list of int
        The shapes on the way from the first one of a pair to the second one, with both; empty if no maps close a cycle.
    """
    costs, ends = [_MOST - score for score in scores.values()], np.array(list(scores), np.int64).reshape(-1, 2).T
    tree = csr_array(minimum_spanning_tree(coo_array((costs, (ends[0], ends[1])), shape=(count, count)).tocsr()))
    kept = set(zip(*(own.tolist() for own in tree.nonzero()), strict=True))
    return {pair: _way(tree, *pair) for pair in scores if pair not in kept}


def _way(tree: csr_array, begin: int, end: int) -> list[int]:
    """Return the shapes between two, with both."""
    _, before = depth_first_order(tree, begin, directed=False)
    way = [end]
    while way[-1] != begin:
        way.append(int(before[way[-1]]))
    return way[::-1]


def composed(
    carriers: Sequence[Carrier],
    deformations: Mapping[tuple[int, int], ShapeDeformation],
    way: Sequence[int],
    control: Control,
) -> Laid:
    """Lay a shape onto another one by way of others.

    Parameters
    ----------
    carriers : sequence of Carrier
        The shapes.
    deformations : mapping of (int, int) to ShapeDeformation
        The deformations between neighbors on the way.
    way : sequence of int
        From the shape that is laid to the one that it is laid on, at least one other between them.
    control : Control
        Stops the work.
    """
    first = deformations[way[0], way[1]]
    faces = carriers[way[0]].mesh.faces
    points, trust, images = first.points, first.confidence, first.images
    for place, (one, other) in enumerate(pairwise(way[1:])):
        if place > 0:
            images = carriers[one].finder.find(points, vertex_normals(points, faces), control=control)
        onward, corners = deformations[one, other], carriers[one].mesh.faces
        points = images.interpolated(onward.points[corners])
        trust = trust * images.interpolated(onward.confidence[corners][:, :, None])[:, 0]
    return Laid(points, trust)
