# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact coverage of the cells of a 2D grid by a filled boundary, without sampling."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..algebra.quotients import quotients
from ..arrays.bounds import common_bounds
from ..arrays.integer_ranges import integer_ranges
from .planar_fill import Boundary


def coverage(boundary: Boundary, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Covered area of every cell.

    Edges are cut at grid lines. A piece then lies in one cell, to which it adds the area on its right, and it adds its
    height to all cells further right (the accumulation of FreeType's smooth rasterizer, in floating point).

    Parameters
    ----------
    boundary : Boundary
        In cells; parts outside the grid are ignored.
    shape : (int, int)
        Cells per axis.

    Returns
    -------
    (nx, ny) float64
        In [0, 1]; the sum is the area within the grid.
    """
    # An extra column collects what lies left of the grid; rows outside the grid are dropped.
    table = np.zeros((shape[0] + 2, shape[1]))
    starts, ends = _cut_at_lines(boundary)
    if not len(starts):
        return table[: shape[0]]
    middle = 0.5 * (starts + ends)
    row = np.floor(middle[:, 1]).astype(np.int64)
    column = np.floor(middle[:, 0]).astype(np.int64)
    inside = (row >= 0) & (row < shape[1]) & (column < shape[0])
    row, column = row[inside], column[inside]
    # The filled side is to the right of an edge that runs down.
    height = (starts[:, 1] - ends[:, 1])[inside]
    beyond = np.where(column < 0, 1.0, 1.0 - (middle[inside, 0] - column))
    column = np.maximum(column, -1) + 1
    np.add.at(table, (column, row), height * beyond)
    np.add.at(table, (column + 1, row), height * (1.0 - beyond))
    # A piece left of the grid covers its whole row.
    np.cumsum(table, axis=0, out=table)
    return np.clip(table[1:-1], 0.0, 1.0)


def overlap(one: Boundary, other: Boundary, cells: int) -> float:
    """Return the area of the intersection of two filled areas over that of their union; see :func:`overlaps`."""
    return float(overlaps([one, other], cells)[0, 1])


def overlaps(areas: Sequence[Boundary], cells: int) -> NDArray[np.float64]:
    """Return the areas of the intersections of filled areas over those of their unions, (k, k).

    Areas of cells that both cover in part are compared, which is nearly exact for boundaries that are nearly parallel.

    Parameters
    ----------
    areas : sequence of Boundary
        The k areas, not empty.
    cells : int
        Cells along the longest side of a grid over all.
    """
    low, high = common_bounds([area.bounds for area in areas])
    scale = cells / float((high - low).max())
    shape = tuple(int(count) for count in np.ceil((high - low) * scale).astype(int) + 1)
    covered = np.stack([coverage(area.moved(-low * scale, scale), shape).ravel() for area in areas])
    unions = np.stack([np.maximum(own, covered).sum(axis=1) for own in covered])
    both = np.stack([np.minimum(own, covered).sum(axis=1) for own in covered])
    # Areas much smaller than a cell may cover none.
    return quotients(both, unions)


def self_overlap(boundary: Boundary, cells: int) -> float:
    """Return the share of an area that lies upon itself, or is turned over, with its outline running clockwise.

    Parameters
    ----------
    boundary : Boundary
        Edges that may cross, not empty.
    cells : int
        Cells along the longest side of a grid over the area.
    """
    low, high = boundary.bounds
    spacing = float((high - low).max()) / cells
    shape = tuple(np.ceil((high - low) / spacing).astype(int))
    moved = boundary.moved(-low / spacing, 1.0 / spacing)
    covered, turned_over = (
        float(coverage(own, shape).sum()) * spacing**2 for own in (moved, Boundary(moved.ends, moved.starts))
    )
    # The area of a boundary counts what is turned over as negative.
    return 1.0 - covered / (boundary.area + 2.0 * turned_over)


def _cut_at_lines(boundary: Boundary) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cut edges at integer coordinates; return the starts and ends of the pieces."""
    starts, ends = boundary.starts, boundary.ends
    numbers = np.arange(len(starts))
    owners, shares = [numbers, numbers], [np.zeros(len(starts)), np.ones(len(starts))]
    for axis in range(2):
        low, high = np.minimum(starts[:, axis], ends[:, axis]), np.maximum(starts[:, axis], ends[:, axis])
        first = np.floor(low).astype(np.int64) + 1
        counts = np.maximum(np.ceil(high).astype(np.int64) - first, 0)
        owner, lines = integer_ranges(first, counts)
        owners.append(owner)
        shares.append((lines - starts[owner, axis]) / (ends[owner, axis] - starts[owner, axis]))
    owner, share = np.concatenate(owners), np.clip(np.concatenate(shares), 0.0, 1.0)
    order = np.lexsort((share, owner))
    owner, share = owner[order], share[order]
    points = starts[owner] + share[:, None] * (ends[owner] - starts[owner])
    # Use the exact ends, without rounding.
    points[share == 1.0] = ends[owner[share == 1.0]]
    same = owner[:-1] == owner[1:]
    return points[:-1][same], points[1:][same]
