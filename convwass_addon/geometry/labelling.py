# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The pieces of a set of cells, told from the runs that its cells form along the last axis.

A solid has far fewer runs than cells: scipy.ndimage.label, which looks at every cell, takes four times as long.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components


@dataclass(frozen=True)
class Pieces:
    """What hangs together.

    Attributes
    ----------
    shape : (int, int, int)
        Of the grid.
    starts, ends : (r,) int64
        The runs of cells in the set: the first, and the one after the last, numbered along lines of one cell more.
    names : (r,) int32
        Number of the piece that every run is in, 1, 2, ...; zero where it counts no more.
    count : int
        How many pieces there are.
    """

    shape: tuple[int, int, int]
    starts: NDArray[np.int64]
    ends: NDArray[np.int64]
    names: NDArray[np.int32]
    count: int

    @classmethod
    def of(cls, inside: NDArray[np.bool_]) -> Pieces:
        """Find the pieces of the cells, (nx, ny, nz), that are True, joined by faces, in the order they are met in."""
        # A cell of nothing at the end of every line, so that no run goes on in the next; and one before all.
        lines = np.zeros((*inside.shape[:2], inside.shape[2] + 1), bool)
        lines[..., :-1] = inside
        flat = lines.ravel()
        changes = np.flatnonzero(np.diff(flat, prepend=False))
        starts, ends = changes[::2], changes[1::2]
        step_y = lines.shape[2]
        step_x = step_y * lines.shape[1]
        beside, before = _meeting(starts, ends, step_y), _meeting(starts, ends, step_x)
        in_plane = starts[beside[0]] // step_x == starts[beside[1]] // step_x
        first, second = np.concatenate([beside[:, in_plane], before], axis=1)
        count, names = _connected(first, second, len(starts))
        return cls(inside.shape, starts, ends, names + np.int32(1), count)

    @cached_property
    def labels(self) -> NDArray[np.int32]:
        """The number of the piece that every cell is in, (nx, ny, nz); zero elsewhere."""
        lines = np.zeros((*self.shape[:2], self.shape[2] + 1), np.int32)
        marks = np.zeros(lines.size + 1, np.int32)
        marks[self.starts] = self.names
        marks[self.ends] -= self.names
        np.cumsum(marks[:-1], out=lines.reshape(-1))
        return np.ascontiguousarray(lines[..., :-1])

    @cached_property
    def sizes(self) -> NDArray[np.int64]:
        """How many cells every piece has, (count + 1,); the first number is of no piece."""
        return np.bincount(self.names, self.ends - self.starts, self.count + 1).astype(np.int64)

    def cells(self, wanted: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Return the cells, (m,) as in a flat array and ascending, of some of the pieces, (count + 1,) bool."""
        chosen = wanted[self.names]
        starts, lengths = self.starts[chosen], (self.ends - self.starts)[chosen]
        ends = np.cumsum(lengths)
        places = np.arange(ends[-1] if len(ends) else 0) + np.repeat(starts - ends + lengths, lengths)
        return places - places // (self.shape[2] + 1)

    def at(self, cells: NDArray[np.int64]) -> NDArray[np.int32]:
        """Return the numbers of the pieces that cells, (m,) as in a flat array, are in; zero for others."""
        if not self.count:
            return np.zeros(len(cells), np.int32)
        places = cells + cells // self.shape[2]
        run = np.searchsorted(self.starts, places, side="right") - 1
        within = (run >= 0) & (places < self.ends[run])
        return np.where(within, self.names[run], 0)

    def joined(self, first: NDArray[np.int64], second: NDArray[np.int64]) -> Pieces:
        """Join pairs of pieces, given by their numbers."""
        if not len(first):
            return self
        count, names = _connected(first - 1, second - 1, self.count)
        return replace(self, names=(names + np.int32(1))[self.names - 1], count=count)

    def within(self) -> Pieces:
        """Leave out those that reach the grid's walls."""
        width = self.shape[2] + 1
        x, y = np.divmod(self.starts // width, self.shape[1])
        at_wall = (x == 0) | (x == self.shape[0] - 1) | (y == 0) | (y == self.shape[1] - 1)
        at_wall |= (self.starts % width == 0) | (self.ends % width == self.shape[2])
        enclosed = np.ones(self.count + 1, bool)
        enclosed[0] = False
        enclosed[self.names[at_wall]] = False
        numbers = np.where(enclosed, np.cumsum(enclosed), 0).astype(np.int32)
        return replace(self, names=numbers[self.names], count=int(enclosed.sum()))


def _connected(first: NDArray[np.int64], second: NDArray[np.int64], count: int) -> tuple[int, NDArray[np.int32]]:
    links = csr_array((np.ones(len(first), np.int8), (first, second)), shape=(count, count))
    found, names = connected_components(links, directed=False)
    return int(found), names


def _meeting(starts: NDArray[np.int64], ends: NDArray[np.int64], step: int) -> NDArray[np.int64]:
    """Return the pairs of runs, (2, m), of which the second shares cells with the first if that is moved by `step`."""
    low = np.searchsorted(ends, starts + step, side="right")
    high = np.searchsorted(starts, ends + step, side="left")
    counts = high - low
    first = np.repeat(np.arange(len(starts)), counts)
    within = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.stack([first, low[first] + within])
