# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which part of every cell of a plane grid is filled: exact areas, without samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .planar_fill import Boundary


def coverage(boundary: Boundary, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Area of every cell that is filled.

    Edges are cut at the lines of the grid. A piece then lies in one cell, where it adds the area to the right of it,
    and it adds its height to all cells to the right (the accumulation of FreeType's smooth rasterizer, in floats).

    Parameters
    ----------
    boundary : Boundary
        In cells; what lies outside of the grid is left out.
    shape : (int, int)
        Cells per axis.

    Returns
    -------
    (nx, ny) float64
        In [0, 1]; their sum is the area within the grid.
    """
    # A column before the grid takes what lies left of it; rows outside of the grid are dropped.
    table = np.zeros((shape[0] + 2, shape[1]))
    starts, ends = _cut_at_lines(boundary)
    if not len(starts):
        return table[: shape[0]]
    middle = 0.5 * (starts + ends)
    row = np.floor(middle[:, 1]).astype(np.int64)
    column = np.floor(middle[:, 0]).astype(np.int64)
    inside = (row >= 0) & (row < shape[1]) & (column < shape[0])
    row, column = row[inside], column[inside]
    # What is filled is right of an edge that runs down.
    height = (starts[:, 1] - ends[:, 1])[inside]
    beyond = np.where(column < 0, 1.0, 1.0 - (middle[inside, 0] - column))
    column = np.maximum(column, -1) + 1
    np.add.at(table, (column, row), height * beyond)
    np.add.at(table, (column + 1, row), height * (1.0 - beyond))
    # A piece before the grid fills all of its row.
    np.cumsum(table, axis=0, out=table)
    return np.clip(table[1:-1], 0.0, 1.0)


def _cut_at_lines(boundary: Boundary) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cut edges where a coordinate is a whole number; return the starts and ends of the pieces."""
    starts, ends = boundary.starts, boundary.ends
    numbers = np.arange(len(starts))
    owners, shares = [numbers, numbers], [np.zeros(len(starts)), np.ones(len(starts))]
    for axis in range(2):
        low, high = np.minimum(starts[:, axis], ends[:, axis]), np.maximum(starts[:, axis], ends[:, axis])
        first = np.floor(low).astype(np.int64) + 1
        counts = np.maximum(np.ceil(high).astype(np.int64) - first, 0)
        owner = np.repeat(numbers, counts)
        lines = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts) + first[owner]
        owners.append(owner)
        shares.append((lines - starts[owner, axis]) / (ends[owner, axis] - starts[owner, axis]))
    owner, share = np.concatenate(owners), np.clip(np.concatenate(shares), 0.0, 1.0)
    order = np.lexsort((share, owner))
    owner, share = owner[order], share[order]
    points = starts[owner] + share[:, None] * (ends[owner] - starts[owner])
    # The ends themselves, not what rounding makes of them.
    points[share == 1.0] = ends[owner[share == 1.0]]
    same = owner[:-1] == owner[1:]
    return points[:-1][same], points[1:][same]
