# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Places at which a change of the density may remove a handle, and which of them were tried in vain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

RAISED, LOWERED = 1.1, 0.85
"""Density to which cells are raised or lowered, relative to the level."""
REACH = 6
"""Half width of a change in cells."""

# With levels that differ by at most this fraction, the same changes are in vain. From a ball to a knot, one more handle
# could be removed after the level had moved by 0.005 of itself.
_SAME_LEVEL = 3e-3
# More than a grid has along an axis.
_MOST_CELLS = 1 << 16


@dataclass(frozen=True)
class Places:
    """Cells whose density may be changed.

    Attributes
    ----------
    cells : (n, 3) int64
        The cells.
    wanted : (n,)
        Their new densities.
    is_raised : (n,) bool
        Which of these are higher than before.
    """

    cells: NDArray[np.int64]
    wanted: NDArray[np.floating]
    is_raised: NDArray[np.bool_]

    @classmethod
    def of(
        cls, thin: NDArray[np.int64], holes: NDArray[np.int64], density: NDArray[np.floating], level: float, most: int
    ) -> Places:
        """Lower the density at thin places and raise it in holes, at `most` of them, the nearest to the level first."""
        cells = np.concatenate([thin, holes])
        is_raised = np.arange(len(cells)) >= len(thin)
        wanted = np.where(is_raised, RAISED * level, LOWERED * level).astype(density.dtype)
        order = np.argsort(np.abs(np.log(density[tuple(cells.T)] / level)), kind="stable")[:most]
        return cls(cells[order], wanted[order], is_raised[order])

    def chosen(self, which: NDArray[np.bool_] | NDArray[np.int64] | slice) -> Places:
        """Return some of the places."""
        return Places(self.cells[which], self.wanted[which], self.is_raised[which])

    @property
    def keys(self) -> NDArray[np.int64]:
        """A number for every place that no other place has, (n,)."""
        return 2 * np.ravel_multi_index(tuple(self.cells.T), (_MOST_CELLS,) * 3) + self.is_raised


class TriedPlaces:
    """Places where changes were tried in vain, which they are again while level and density around them stay the same.

    Changes of several widths are tried at a place, the narrowest one first.
    """

    def __init__(self) -> None:
        self._level = np.inf
        self._forget()

    def begin(self, level: float) -> None:
        """Begin to try changes at a level; forget all places if the level has moved."""
        if abs(level / self._level - 1.0) > _SAME_LEVEL:
            self._forget()
            self._level = level

    def _forget(self) -> None:
        self._keys, self._cells = np.empty(0, np.int64), np.empty((0, 3), np.int64)
        self._widths = np.empty(0, np.int64)

    def untried(self, places: Places, widths: int) -> Places:
        """Return the places where not all of the narrowest `widths` changes were tried."""
        return places.chosen(~np.isin(places.keys, self._keys[self._widths >= widths]))

    def add(self, places: Places, widths: NDArray[np.int64]) -> None:
        """Add places with the number of widths tried at each, (n,)."""
        self._keys = np.concatenate([self._keys, places.keys])
        self._cells = np.concatenate([self._cells, places.cells])
        self._widths = np.concatenate([self._widths, widths])

    def forget_around(self, cell: NDArray[np.int64]) -> None:
        """Forget the places whose surroundings a change at a cell, (3,), has changed."""
        kept = ~are_near(self._cells, cell)
        self._keys, self._cells, self._widths = self._keys[kept], self._cells[kept], self._widths[kept]


def are_near(cells: NDArray[np.int64], cell: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which cells, (n, 3), are so near to one, (3,), that changes at both overlap, (n,)."""
    return np.abs(cells - cell).max(axis=1, initial=0) <= 2 * REACH
