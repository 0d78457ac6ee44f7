# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Intersections of axis-parallel lattice lines with the triangles of a mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Candidate (triangle, line) pairs tested at once; limits the memory of the test.
_CHUNK = 1_000_000


@dataclass(frozen=True)
class Crossings:
    """Crossings of lines parallel to the third coordinate with triangles.

    Attributes
    ----------
    column, row : (c,) int64
        First and second coordinate of the line: lines pass through the integer points of the plane.
    height : (c,) float64
        Third coordinate of the crossing.
    sign : (c,) int64
        +1 where the line, followed upward, enters the solid; -1 where it leaves it.
    """

    column: NDArray[np.int64]
    row: NDArray[np.int64]
    height: NDArray[np.float64]
    sign: NDArray[np.int64]


def crossings(corners: NDArray[np.float64]) -> Iterator[Crossings]:
    """Yield the crossings of the lattice lines with triangles `corners`, (m, 3, 3), in chunks."""
    # Corner by corner: NumPy takes several times as long for a minimum over an axis of length three.
    a, b, c = (corners[:, corner, :2] for corner in range(3))
    low = np.ceil(np.minimum(np.minimum(a, b), c)).astype(np.int64)
    size = np.floor(np.maximum(np.maximum(a, b), c)).astype(np.int64) - low + 1
    hit = (size[:, 0] > 0) & (size[:, 1] > 0)
    corners, low, size = corners[hit], low[hit], size[hit]
    candidates = size[:, 0] * size[:, 1]
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
    """Test every lattice point of every triangle's bounding box with three edge functions.

    Points that fail one edge function are not tested with the next.
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    area = _edge_function(b - a, a, c[:, 0], c[:, 1])
    triangle = np.repeat(np.arange(len(corners), dtype=np.int32), candidates)
    first = np.cumsum(candidates) - candidates
    # Coordinates within the box are 32-bit, because their division takes half as long.
    within = np.arange(len(triangle), dtype=np.int32) - first.astype(np.int32)[triangle]
    across = size[:, 1].astype(np.int32)[triangle]
    column = within // across
    row = low[:, 1][triangle] + (within - column * across)
    column = low[:, 0][triangle] + column
    edges: list[NDArray[np.float64]] = []
    for tail, head in ((b, c), (c, a)):
        edge = _edge_function_of((head - tail), tail, triangle, column, row)
        keep = edge * np.sign(area)[triangle] > 0
        triangle, column, row = triangle[keep], column[keep], row[keep]
        edges = [*(other[keep] for other in edges), edge[keep]]
    whole = area[triangle]
    last = whole - edges[0] - edges[1]
    side = np.sign(whole)
    keep = last * side > 0
    triangle, (one, other) = triangle[keep], (edge[keep] for edge in edges)
    height = (one * a[:, 2][triangle] + other * b[:, 2][triangle] + last[keep] * c[:, 2][triangle]) / whole[keep]
    return Crossings(column[keep], row[keep], height, -side[keep].astype(np.int64))


def _edge_function_of(
    edge: NDArray[np.float64],
    tail: NDArray[np.float64],
    triangle: NDArray[np.integer],
    x: NDArray[np.integer],
    y: NDArray[np.integer],
) -> NDArray[np.float64]:
    """Evaluate the edge function at many points per triangle, gathering only the coordinates it needs."""
    value = y - tail[:, 1][triangle]
    value *= edge[:, 0][triangle]
    other = x - tail[:, 0][triangle]
    other *= edge[:, 1][triangle]
    value -= other
    return value


def _edge_function(
    edge: NDArray[np.float64], tail: NDArray[np.float64], x: NDArray[np.generic], y: NDArray[np.generic]
) -> NDArray[np.float64]:
    """Twice the signed area of the triangle (tail, tail + edge, point) in the plane."""
    return edge[:, 0] * (y - tail[:, 1]) - edge[:, 1] * (x - tail[:, 0])
