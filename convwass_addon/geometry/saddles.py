# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a level set changes its topology as the level passes: saddles of a density on a grid.

A cell changes nothing if its denser neighbors hang together in one piece and its other neighbors do, too (a simple
point: Bertrand and Malandain 1994). One kind hangs together by corners then (26-connected), the other by faces
(6-connected): which is which is left open by cells, and a surface between them may go either way at every place.
Neighborhoods are numbers of 26 bits, so that all cells are looked at together.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_OFFSETS = np.array([o for o in np.ndindex(3, 3, 3) if o != (1, 1, 1)]) - 1
_STEPS = np.abs(_OFFSETS[:, None] - _OFFSETS)
# Bits of the neighbors that a grid's walls leave to cells within, and how many bits a table takes at a time.
_BITS = np.uint32(1) << np.arange(26, dtype=np.uint32)
_ALL = np.bitwise_or.reduce(_BITS)
_DIGIT = 9
# Where cells hang together through faces, those that touch the cell by a corner only do not count.
_IN_REACH = np.bitwise_or.reduce(_BITS[np.abs(_OFFSETS).sum(axis=1) <= 2])
_FACES = np.bitwise_or.reduce(_BITS[np.abs(_OFFSETS).sum(axis=1) == 1])


def _tables(adjacent: NDArray[np.bool_]) -> list[NDArray[np.uint32]]:
    """Return, for every nine bits, the neighbors they name and those adjacent to them."""
    reached = np.bitwise_or.reduce(np.where(adjacent, _BITS, np.uint32(0)), axis=1) | _BITS
    tables = []
    for start in range(0, 26, _DIGIT):
        digits = np.arange(2**_DIGIT, dtype=np.uint32)
        table = np.zeros(len(digits), np.uint32)
        for bit, reach in enumerate(reached[start : start + _DIGIT]):
            table[digits >> np.uint32(bit) & 1 > 0] |= reach
        tables.append(table)
    return tables


# Neighbors of a cell that touch each other: by a corner or more, by a face.
_TOUCHING = _tables(_STEPS.max(axis=2) <= 1)
_ABUTTING = _tables(_STEPS.sum(axis=2) <= 1)


def bridges(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    """Find cells that join what hung together nowhere near before: two pieces meet, or a handle closes.

    Parameters
    ----------
    density : (nx, ny, nz)
        Cells at the grid's wall are not looked at. What is inside hangs together by corners.
    low, high : float
        Densities to look at, the upper one included.

    Returns
    -------
    (m, 3) int64
    """
    cells = _between(density, low, high)
    return cells[_parted_by_corners(_denser(density, cells))]


def lids(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    """Find cells that part what lies outside: a hole through a handle fills, or a bubble closes.

    The parameters and the result are as for :func:`bridges`.
    """
    cells = _between(density, low, high)
    return cells[_parted_by_faces(~_denser(density, cells))]


def bridges_by_faces(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    """Find bridges where what is inside hangs together by faces only; else as :func:`bridges`."""
    cells = _between(density, low, high)
    return cells[_parted_by_faces(_denser(density, cells))]


def lids_by_corners(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    """Find lids where what is outside hangs together by corners, too; else as :func:`lids`."""
    cells = _between(density, low, high)
    return cells[_parted_by_corners(~_denser(density, cells) & _ALL)]


def _parted_by_corners(neighbors: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Tell where neighbors, as bits, are more than one piece of cells that touch."""
    return _grown(neighbors & -neighbors, neighbors, _TOUCHING) != neighbors


def _parted_by_faces(neighbors: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Tell where those of them at the cell's faces are in more than one piece of cells that abut."""
    near = neighbors & _IN_REACH
    faces = near & _FACES
    return (faces & ~_grown(faces & -faces, near, _ABUTTING)) != 0


def _between(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    inner = density[1:-1, 1:-1, 1:-1]
    return np.argwhere((inner > low) & (inner <= high)) + 1


def _denser(density: NDArray[np.floating], cells: NDArray[np.int64]) -> NDArray[np.uint32]:
    """Return which of their neighbors are denser than cells, (n, 3), as bits, (n,)."""
    values = np.ascontiguousarray(density).ravel()
    places = np.ravel_multi_index(tuple(cells.T), density.shape)
    own = values[places]
    found = np.zeros(len(cells), np.uint32)
    for bit, (i, j, k) in enumerate(_OFFSETS):
        near = values[places + ((i * density.shape[1] + j) * density.shape[2] + k)]
        # Of equal cells the later one counts as denser, so that every set of them has an order.
        found |= (near >= own if bit >= 13 else near > own).astype(np.uint32) << np.uint32(bit)
    return found


def _grown(
    start: NDArray[np.uint32], within: NDArray[np.uint32], tables: list[NDArray[np.uint32]]
) -> NDArray[np.uint32]:
    """Return all neighbors that hang together with those of `start`."""
    first, second, third = tables
    mask = np.uint32(2**_DIGIT - 1)
    while True:
        grown = first[start & mask] | second[start >> np.uint32(_DIGIT) & mask] | third[start >> np.uint32(2 * _DIGIT)]
        grown &= within
        if np.array_equal(grown, start):
            return start
        start = grown
