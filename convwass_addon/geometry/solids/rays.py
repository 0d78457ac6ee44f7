# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Intersections of axis-parallel lattice lines with the triangles of a mesh.

The projection of a triangle is divided into columns, each of which meets two of its edges; the lines between these
edges cross the triangle. Adjacent triangles compute identical positions on their common edge, so closed meshes have no
gaps.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.chunks import chunks_by_sizes
from ..arrays.integer_ranges import integer_ranges

NUDGE = (1.23e-5, 2.77e-5)
"""Offset of meshes aligned with a grid across the lines, so that none passes exactly through an edge or a vertex."""

# Lattice points in the bounding boxes of triangles that are processed together; limits the memory.
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
    a, b, c = (corners[:, corner, :2] for corner in range(3))
    size = np.maximum(np.maximum(a, b), c) - np.minimum(np.minimum(a, b), c) + 1.0
    for some in chunks_by_sizes(size[:, 0] * size[:, 1], _CHUNK):
        yield _between_edges(corners[some])


@dataclass(frozen=True)
class _Edges:
    """Edges of triangles by the first coordinate: start points, (k, 3), and slopes of the other coordinates, (k, 2)."""

    tails: NDArray[np.float64]
    slopes: NDArray[np.float64]

    @classmethod
    def between(cls, tails: NDArray[np.float64], heads: NDArray[np.float64]) -> _Edges:
        along = heads - tails
        # An edge parallel to the columns crosses none of them.
        return cls(tails, along[:, 1:] / np.where(along[:, :1] > 0.0, along[:, :1], 1.0))

    def at(self, edges: NDArray[np.int64], column: NDArray[np.int64]) -> tuple[NDArray[np.float64], ...]:
        """Return the second and third coordinates, (c,) each, of given edges, (c,), at given columns, (c,)."""
        along = column - self.tails[:, 0].take(edges)
        return tuple(self.tails[:, 1 + k].take(edges) + along * self.slopes[:, k].take(edges) for k in range(2))


def _between_edges(corners: NDArray[np.float64]) -> Crossings:
    """Return all crossings with the given triangles."""
    count = len(corners)
    order = corners[:, :, 0].argsort(axis=1, kind="stable")
    first, middle, last = (
        corners.reshape(-1, 3).take(3 * np.arange(count) + place, axis=0) for place in np.ascontiguousarray(order.T)
    )
    turned = np.where((order[:, 1] - order[:, 0]) % 3 == 1, 1, -1)
    begin = np.ceil(first[:, 0]).astype(np.int64)
    triangle, column = integer_ranges(begin, np.ceil(last[:, 0]).astype(np.int64) - begin)
    # The edge from the first corner to the last, and the two edges through the middle corner.
    one, one_height = _Edges.between(first, last).at(triangle, column)
    halves = _Edges.between(np.concatenate([first, middle]), np.concatenate([middle, last]))
    is_second = column >= middle[:, 0].take(triangle)
    other, other_height = halves.at(triangle + count * is_second, column)
    low, high = np.minimum(one, other), np.maximum(one, other)
    begin = np.ceil(low).astype(np.int64)
    line, row = integer_ranges(begin, np.ceil(high).astype(np.int64) - begin)
    # Heights between both edges.
    slope = (other_height - one_height) / np.where(other != one, other - one, 1.0)
    height = one_height.take(line) + (row - one.take(line)) * slope.take(line)
    sign = np.where(other < one, -turned.take(triangle), turned.take(triangle))
    return Crossings(column.take(line), row, height, sign.take(line))
