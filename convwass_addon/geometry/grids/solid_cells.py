# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The grid cells of a solid and their adjacency."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

HALF_OF_THE_NEIGHBORS = tuple(offset for offset in product((-1, 0, 1), repeat=3) if offset > (0, 0, 0))
"""Offsets to 13 of the 26 neighbors of a cell; the others are their negatives."""


@dataclass(frozen=True)
class SolidCells:
    """The grid cells that contain part of a solid.

    Attributes
    ----------
    number : (nx, ny, nz) int64
        Index of every cell among those of the solid; -1 outside.
    filled : (n,) float64
        Filled fraction of the cells of the solid.
    """

    number: NDArray[np.int64]
    filled: NDArray[np.float64]

    @classmethod
    def of(cls, mass: NDArray[np.float64], least: float) -> SolidCells:
        """Select the cells whose filled fraction is at least `least`."""
        inside = mass >= least
        number = np.full(mass.shape, -1, np.int64)
        number[inside] = np.arange(np.count_nonzero(inside))
        return cls(number, mass[inside])

    def __len__(self) -> int:
        return len(self.filled)

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Mask of the cells, with the grid's shape."""
        return self.number >= 0

    def gathered(self, field: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values of a field (nx, ny, nz, ...) at the cells, (n, ...)."""
        return field[self.inside]

    def scattered(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Field (nx, ny, nz, ...) with values, (n, ...), at the cells and zero elsewhere."""
        field = np.zeros((*self.number.shape, *values.shape[1:]))
        field[self.inside] = values
        return field

    def pairs(self, offset: tuple[int, int, int]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return all pairs of cells of the solid whose second cell is at `offset` from the first, (p,) each."""
        here = tuple(slice(max(0, -step), size - max(0, step)) for step, size in _by_axis(offset, self.number))
        there = tuple(slice(max(0, step), size + min(0, step)) for step, size in _by_axis(offset, self.number))
        first, second = self.number[here].ravel(), self.number[there].ravel()
        both = (first >= 0) & (second >= 0)
        return first[both], second[both]


def _by_axis(offset: tuple[int, int, int], field: NDArray) -> Iterator[tuple[int, int]]:
    return zip(offset, field.shape, strict=True)
