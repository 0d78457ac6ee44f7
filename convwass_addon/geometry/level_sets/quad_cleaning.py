# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove the edges of a quad surface that connect two vertices of valence three; they are always short.

The four quads around such an edge form a hexagon. Two quads without the two inner vertices replace them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .dual_surface import DualSurface

# The three ways to cut a hexagon into two quads, given by their corners.
_CUTS = np.array([[[i, i + 1, i + 2, i + 3], [i + 3, i + 4, i + 5, i]] for i in range(3)]) % 6
# Quads that a vertex needs around it to lose one and still have three.
_LEAST_QUADS = 4


def without_short_edges(dual: DualSurface) -> DualSurface:
    """Return a surface of the same topology with hardly any edges between two vertices of valence three."""
    count = len(dual.points)
    around = np.bincount(dual.quads.ravel(), minlength=count)
    around[dual.triangles] = 0
    edges = _short_edges(dual.quads, around == 3)
    if not len(edges):
        return dual
    quads, inner, hexagons = _hexagons(dual.quads, edges)
    fits = (around[hexagons[:, [0, 1, 3, 4]]] >= _LEAST_QUADS).all(axis=1) & (around[hexagons] > 0).all(axis=1)
    quads, inner, hexagons = (array[fits] for array in (quads, inner, hexagons))
    chosen = _apart(np.concatenate([inner, hexagons], axis=1), count)
    quads, inner, hexagons = (array[chosen] for array in (quads, inner, hexagons))
    chosen = ~_touching_themselves(dual.quads, quads, hexagons, count)
    quads, inner, hexagons = (array[chosen] for array in (quads, inner, hexagons))
    kept = np.ones(len(dual.quads), bool)
    kept[quads] = False
    filled = np.concatenate([dual.quads[kept], _cut(dual.points, around, hexagons)])
    used = np.ones(count, bool)
    used[inner] = False
    number = np.cumsum(used) - 1
    return replace(
        dual,
        points=dual.points[used],
        cubes=dual.cubes[used],
        quads=number[filled],
        triangles=number[dual.triangles],
    )


def _short_edges(quads: NDArray[np.int64], ends: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return edges between chosen vertices, (n,) bool, as quad and first corner on both sides, (k, 4)."""
    is_end = ends[quads]
    quad, corner = np.nonzero(is_end & np.roll(is_end, -1, axis=1))
    tail, head = quads[quad, corner], quads[quad, (corner + 1) % 4]
    keys, back = tail * len(ends) + head, head * len(ends) + tail
    order = np.argsort(keys)
    # Next to triangles, an edge has a quad on one side only.
    found = np.searchsorted(keys, back, sorter=order)
    other = order[np.minimum(found, len(order) - 1)]
    once = (keys[other] == back) & (tail < head)
    return np.stack([quad, corner, quad[other], corner[other]], axis=1)[once]


def _hexagons(
    quads: NDArray[np.int64], edges: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return the four quads around each edge, (k, 4), its two vertices, (k, 2), and the hexagon around it, (k, 6).

    With the quads (a, b, c, d) and (b, a, e, f) on both sides of the edge (a, b), the other quad of a is (e, a, d, x),
    that of b is (c, b, f, y), and the hexagon is (c, d, x, e, f, y). Its first and last two vertices lose an edge.
    """
    steps = np.arange(4)
    one, other = edges[:, 0], edges[:, 2]
    a, b, c, d = quads[one[:, None], (edges[:, 1, None] + steps) % 4].T
    _, _, e, f = quads[other[:, None], (edges[:, 3, None] + steps) % 4].T
    # The sum of the three quads at a vertex minus the two known ones is the third.
    sums = np.bincount(quads.ravel(), np.repeat(np.arange(len(quads)), 4)).astype(np.int64)
    third, fourth = (sums[vertex] - one - other for vertex in (a, b))
    x = quads[third].sum(axis=1) - e - a - d
    y = quads[fourth].sum(axis=1) - c - b - f
    return np.stack([one, other, third, fourth], axis=1), np.stack([a, b], axis=1), np.stack([c, d, x, e, f, y], axis=1)


def _apart(groups: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    """Choose groups of distinct vertices, (k, g) of `count`, such that no vertex is in two groups."""
    ordered = np.sort(groups, axis=1)
    proper = (ordered[:, 1:] != ordered[:, :-1]).all(axis=1)
    numbers = np.flatnonzero(proper)
    first = np.full(count, len(groups))
    np.minimum.at(first, groups[numbers], numbers[:, None])
    return proper & (first[groups] == np.arange(len(groups))[:, None]).all(axis=1)


def _touching_themselves(
    quads: NDArray[np.int64], inner: NDArray[np.int64], hexagons: NDArray[np.int64], count: int
) -> NDArray[np.bool_]:
    """Return which hexagons, (k, 6), have two corners in an outside quad that do not form an edge of the hexagon.

    Cut into two quads, such a hexagon could get a face or an edge that is already there.
    """
    owner, place = np.full(count, -1), np.zeros(count, np.int64)
    owner[hexagons] = np.arange(len(hexagons))[:, None]
    place[hexagons] = np.arange(6)
    outside = np.ones(len(quads), bool)
    outside[inner] = False
    around = quads[outside]
    owners, places = owner[around], place[around]
    found = np.zeros(len(hexagons), bool)
    for one in range(4):
        for step in (1, 2):
            other = (one + step) % 4
            joined = (owners[:, one] >= 0) & (owners[:, one] == owners[:, other])
            if step == 1:
                # The hexagon's own edges run backward in outside quads.
                joined &= (places[:, one] - places[:, other]) % 6 != 1
            found[owners[joined, one]] = True
    return found


def _cut(points: NDArray[np.float64], around: NDArray[np.int64], hexagons: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cut hexagons, (k, 6), where few quads meet and the cut is short; return two quads for each."""
    ends = hexagons[:, _CUTS[:, 0][:, [0, 3]]]
    # All corners but the third and the sixth have lost one quad with the removed edge.
    quads_around = around[ends] - (_CUTS[:, 0][:, [0, 3]] % 3 != 2)
    lengths = np.linalg.norm(points[ends[..., 0]] - points[ends[..., 1]], axis=2)
    best = np.argmin(quads_around.sum(axis=2) + lengths, axis=1)
    return hexagons[np.arange(len(hexagons))[:, None, None], _CUTS[best]].reshape(-1, 4)
