# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find cells where a level set changes its topology as the level passes: saddles of a density on a grid.

A cell changes nothing if its denser neighbors are connected and its other neighbors are, too (a simple point: Bertrand
and Malandain 1994). One of the two sets is connected through corners (26-connected), the other through faces
(6-connected). Cells do not determine which is which, and an isosurface may go either way at every place. Neighborhoods
are encoded as 26-bit numbers, so that all cells are processed together.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_OFFSETS = np.array([o for o in np.ndindex(3, 3, 3) if o != (1, 1, 1)]) - 1
_STEPS = np.abs(_OFFSETS[:, None] - _OFFSETS)
# Bits of the neighbors, and the number of bits per table lookup.
_BITS = np.uint32(1) << np.arange(26, dtype=np.uint32)
_ALL = np.bitwise_or.reduce(_BITS)
_DIGIT = 9
# With connectivity through faces, neighbors that share only a corner with the cell are irrelevant.
_IN_REACH = np.bitwise_or.reduce(_BITS[np.abs(_OFFSETS).sum(axis=1) <= 2])
_FACES = np.bitwise_or.reduce(_BITS[np.abs(_OFFSETS).sum(axis=1) == 1])


def _tables(adjacent: NDArray[np.bool_]) -> list[NDArray[np.uint32]]:
    """Return tables, one per group of nine bits, from neighbors to these and all neighbors adjacent to them."""
    reached = np.bitwise_or.reduce(np.where(adjacent, _BITS, np.uint32(0)), axis=1) | _BITS
    tables = []
    for start in range(0, 26, _DIGIT):
        digits = np.arange(2**_DIGIT, dtype=np.uint32)
        table = np.zeros(len(digits), np.uint32)
        for bit, reach in enumerate(reached[start : start + _DIGIT]):
            table[digits >> np.uint32(bit) & 1 > 0] |= reach
        tables.append(table)
    return tables


# Adjacency among the neighbors of a cell: by at least a corner, or by a face.
_TOUCHING = _tables(_STEPS.max(axis=2) <= 1)
_ABUTTING = _tables(_STEPS.sum(axis=2) <= 1)


def bridges(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    """Find cells that connect otherwise separate parts nearby: two components merge, or a handle closes.

    Parameters
    ----------
    density : (nx, ny, nz)
        Cells at the boundary of the grid are ignored. The inside is 26-connected.
    low, high : float
        Range of densities to examine, including the upper end.

    Returns
    -------
    (m, 3) int64
    """
    cells = _between(density, low, high)
    return cells[_parted_by_corners(_denser(density, cells))]


def lids(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    """Find cells that separate the outside nearby: the hole of a handle closes, or a bubble forms.

    Parameters and result are those of :func:`bridges`.
    """
    cells = _between(density, low, high)
    return cells[_parted_by_faces(~_denser(density, cells))]


def bridges_by_faces(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    """Like :func:`bridges`, with a 6-connected inside."""
    cells = _between(density, low, high)
    return cells[_parted_by_faces(_denser(density, cells))]


def lids_by_corners(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    """Like :func:`lids`, with a 26-connected outside."""
    cells = _between(density, low, high)
    return cells[_parted_by_corners(~_denser(density, cells) & _ALL)]


def _parted_by_corners(neighbors: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Return where neighbors, given as bits, form more than one 26-connected component."""
    return _grown(neighbors & -neighbors, neighbors, _TOUCHING) != neighbors


def _parted_by_faces(neighbors: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Return where face neighbors, given as bits, belong to more than one 6-connected component of the neighbors."""
    near = neighbors & _IN_REACH
    faces = near & _FACES
    return (faces & ~_grown(faces & -faces, near, _ABUTTING)) != 0


def _between(density: NDArray[np.floating], low: float, high: float) -> NDArray[np.int64]:
    inner = density[1:-1, 1:-1, 1:-1]
    return np.argwhere((inner > low) & (inner <= high)) + 1


def _denser(density: NDArray[np.floating], cells: NDArray[np.int64]) -> NDArray[np.uint32]:
    """Return which neighbors of cells, (n, 3), are denser, as bits, (n,)."""
    values = np.ascontiguousarray(density).ravel()
    places = np.ravel_multi_index(tuple(cells.T), density.shape)
    own = values[places]
    found = np.zeros(len(cells), np.uint32)
    for bit, (i, j, k) in enumerate(_OFFSETS):
        near = values[places + ((i * density.shape[1] + j) * density.shape[2] + k)]
        # Ties are broken by position, so that cells have a strict order.
        found |= (near >= own if bit >= 13 else near > own).astype(np.uint32) << np.uint32(bit)
    return found


def _grown(
    start: NDArray[np.uint32], within: NDArray[np.uint32], tables: list[NDArray[np.uint32]]
) -> NDArray[np.uint32]:
    """Return all neighbors connected to those of `start`."""
    first, second, third = tables
    mask = np.uint32(2**_DIGIT - 1)
    while True:
        grown = first[start & mask] | second[start >> np.uint32(_DIGIT) & mask] | third[start >> np.uint32(2 * _DIGIT)]
        grown &= within
        if np.array_equal(grown, start):
            return start
        start = grown
