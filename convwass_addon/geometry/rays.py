# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where lattice lines cross the triangles of a mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Candidate (triangle, line) pairs that are tested at once; bounds the memory of the test.
_CHUNK = 1_000_000


@dataclass(frozen=True)
class Crossings:
    """Crossings of lines parallel to the third coordinate with triangles.

    Attributes
    ----------
    column, row : (c,) int64
        First and second coordinate of the line: the lines stand on the integer points of the plane.
    height : (c,) float64
        Third coordinate of the crossing.
    sign : (c,) int64
        +1 where the line, followed upward, enters the solid; -1 where it leaves.
    """

    column: NDArray[np.int64]
    row: NDArray[np.int64]
    height: NDArray[np.float64]
    sign: NDArray[np.int64]


def crossings(corners: NDArray[np.float64]) -> Iterator[Crossings]:
    """Yield the crossings of the integer lines with triangles `corners`, (m, 3, 3), a chunk at a time."""
    flat = corners[:, :, :2]
    low = np.ceil(flat.min(axis=1)).astype(np.int64)
    size = np.floor(flat.max(axis=1)).astype(np.int64) - low + 1
    hit = (size > 0).all(axis=1)
    corners, low, size = corners[hit], low[hit], size[hit]
    candidates = size.prod(axis=1)
    total = np.cumsum(candidates)
    begin = 0
    while begin < len(corners):
        done = total[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(total, done + _CHUNK, side="right")))
        part = slice(begin, end)
        yield _inside_triangles(corners[part], low[part], size[part], candidates[part])
        begin = end


def _inside_triangles(
    corners: NDArray[np.float64], low: NDArray[np.int64], size: NDArray[np.int64], candidates: NDArray[np.int64]
) -> Crossings:
    """Test every lattice point of every triangle's bounding box with three edge functions."""
    triangle = np.repeat(np.arange(len(corners)), candidates)
    within = np.arange(len(triangle)) - np.repeat(np.cumsum(candidates) - candidates, candidates)
    column = low[triangle, 0] + within // size[triangle, 1]
    row = low[triangle, 1] + within % size[triangle, 1]
    a, b, c = (corners[triangle, i] for i in range(3))
    edge = np.stack([_edge_function(b, c, column, row), _edge_function(c, a, column, row)])
    area = _edge_function(a, b, c[:, 0], c[:, 1])
    last = area - edge[0] - edge[1]
    side = np.sign(area)
    keep = (edge[0] * side > 0) & (edge[1] * side > 0) & (last * side > 0)
    height = (edge[0] * a[:, 2] + edge[1] * b[:, 2] + last * c[:, 2])[keep] / area[keep]
    return Crossings(column[keep], row[keep], height, -side[keep].astype(np.int64))


def _edge_function(
    tail: NDArray[np.float64], head: NDArray[np.float64], x: NDArray[np.generic], y: NDArray[np.generic]
) -> NDArray[np.float64]:
    """Twice the signed area of the triangle (tail, head, point) in the plane."""
    return (head[:, 0] - tail[:, 0]) * (y - tail[:, 1]) - (head[:, 1] - tail[:, 1]) * (x - tail[:, 0])
