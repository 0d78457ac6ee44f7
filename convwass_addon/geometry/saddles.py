# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a level set changes its topology as the level passes: saddles of a density on a grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_OFFSETS = np.array([o for o in np.ndindex(3, 3, 3) if o != (1, 1, 1)]) - 1
_STEPS = np.abs(_OFFSETS[:, None] - _OFFSETS)
# Neighbors of a cell that touch each other: by a corner or more (cells inside), by a face (cells outside).
_TOUCH = _STEPS.max(axis=2) <= 1
_ABUT = _STEPS.sum(axis=2) <= 1
# Cells outside hang together through faces, so those that touch the cell by a corner only do not count.
_IN_REACH = np.abs(_OFFSETS).sum(axis=1) <= 2
_FACES = np.abs(_OFFSETS).sum(axis=1) == 1
_LATER = np.arange(26) >= 13
# Labels travel one cell a round, around at most this many.
_ROUNDS = 12


@dataclass(frozen=True)
class Saddles:
    """Cells at which the topology of the set of denser cells changes.

    Attributes
    ----------
    bridges : (m, 3) int64
        Cells that join what hung together nowhere near before: two pieces meet, or a handle closes.
    lids : (n, 3) int64
        Cells that part what lies outside: a hole through a handle fills, or a bubble closes.
    """

    bridges: NDArray[np.int64]
    lids: NDArray[np.int64]


def saddles(density: NDArray[np.float64], low: float, high: float) -> Saddles:
    """Find the saddles of a density between two levels.

    A cell changes nothing if its denser neighbors hang together in one piece and its other neighbors do, too (a simple
    point: Bertrand and Malandain 1994, with 26-connected insides and 6-connected outsides).

    Parameters
    ----------
    density : (nx, ny, nz) float64
        Cells at the grid's wall are not looked at.
    low, high : float
        Densities to look at.
    """
    inner = density[1:-1, 1:-1, 1:-1]
    cells = np.argwhere((inner > low) & (inner <= high)) + 1
    around = _OFFSETS[:, None] + cells
    own, near = density[tuple(cells.T)], density[tuple(np.moveaxis(around, 2, 0))]
    # Of equal cells the later one counts as denser, so that every set of them has an order.
    denser = (near > own) | ((near == own) & _LATER[:, None])
    joined = _components(denser, denser, _TOUCH)
    others = ~denser & _IN_REACH[:, None]
    parted = _components(others, others & _FACES[:, None], _ABUT)
    return Saddles(cells[joined > 1], cells[parted > 1])


def _components(
    present: NDArray[np.bool_], counted: NDArray[np.bool_], adjacent: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Count the connected groups of `present` neighbors, (26, n), that hold one that is `counted`."""
    nothing = len(present)
    labels = np.where(present, np.arange(nothing, dtype=np.int8)[:, None], np.int8(nothing))
    for _ in range(_ROUNDS):
        before = labels.copy()
        for neighbor in range(nothing):
            labels[neighbor] = np.where(present[neighbor], labels[adjacent[neighbor]].min(axis=0), nothing)
        if np.array_equal(before, labels):
            break
    # The first of a group's neighbors keeps its own name.
    return sum((counted & (labels == name)).any(axis=0).astype(np.int64) for name in range(nothing))
