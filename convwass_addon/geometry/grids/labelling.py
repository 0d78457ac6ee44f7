# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Connected components of a set of cells, from its run-length encoding along the last axis.

A solid has far fewer runs than cells: scipy.ndimage.label, which visits every cell, takes four times as long.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays.components import component_labels
from ..arrays.integer_ranges import integer_ranges


@dataclass(frozen=True)
class Pieces:
    """The connected components of a set of cells.

    Attributes
    ----------
    shape : (int, int, int)
        Shape of the grid.
    starts, ends : (r,) int64
        The runs of cells in the set: first cell and one after the last, as flat indices with one padding cell per line.
    names : (r,) int32
        Component of every run, 1, 2, ...; zero for dropped components.
    count : int
        Number of components.
    """

    shape: tuple[int, int, int]
    starts: NDArray[np.int64]
    ends: NDArray[np.int64]
    names: NDArray[np.int32]
    count: int

    @classmethod
    def of(cls, inside: NDArray[np.bool_]) -> Pieces:
        """Label the True cells, (nx, ny, nz), connected through faces, in order of first occurrence."""
        # An empty cell after every line, so that runs end with their line.
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
        names = component_labels(first, second, len(starts))
        return cls(inside.shape, starts, ends, (names + 1).astype(np.int32), _count(names))

    @cached_property
    def labels(self) -> NDArray[np.int32]:
        """The component of every cell, (nx, ny, nz); zero elsewhere."""
        lines = np.zeros((*self.shape[:2], self.shape[2] + 1), np.int32)
        marks = np.zeros(lines.size + 1, np.int32)
        marks[self.starts] = self.names
        marks[self.ends] -= self.names
        np.cumsum(marks[:-1], out=lines.reshape(-1))
        return np.ascontiguousarray(lines[..., :-1])

    @cached_property
    def sizes(self) -> NDArray[np.int64]:
        """Number of cells of every component, (count + 1,); index 0 collects dropped runs."""
        return np.bincount(self.names, self.ends - self.starts, self.count + 1).astype(np.int64)

    def cells(self, wanted: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Return the flat indices of the cells, (m,), ascending, of selected components, (count + 1,) bool."""
        chosen = wanted[self.names]
        starts, lengths = self.starts[chosen], (self.ends - self.starts)[chosen]
        ends = np.cumsum(lengths)
        places = np.arange(ends[-1] if len(ends) else 0) + np.repeat(starts - ends + lengths, lengths)
        return places - places // (self.shape[2] + 1)

    def at(self, cells: NDArray[np.int64]) -> NDArray[np.int32]:
        """Return the components of cells given by flat indices, (m,); zero for cells outside all components."""
        if not self.count:
            return np.zeros(len(cells), np.int32)
        places = cells + cells // self.shape[2]
        run = np.searchsorted(self.starts, places, side="right") - 1
        within = (run >= 0) & (places < self.ends[run])
        return np.where(within, self.names[run], 0)

    def joined(self, first: NDArray[np.int64], second: NDArray[np.int64]) -> Pieces:
        """Merge pairs of components."""
        if not len(first):
            return self
        names = component_labels(first - 1, second - 1, self.count)
        return replace(self, names=(names + 1).astype(np.int32)[self.names - 1], count=_count(names))

    def within(self) -> Pieces:
        """Drop components that touch the boundary of the grid."""
        width = self.shape[2] + 1
        x, y = np.divmod(self.starts // width, self.shape[1])
        at_wall = (x == 0) | (x == self.shape[0] - 1) | (y == 0) | (y == self.shape[1] - 1)
        at_wall |= (self.starts % width == 0) | (self.ends % width == self.shape[2])
        enclosed = np.ones(self.count + 1, bool)
        enclosed[0] = False
        enclosed[self.names[at_wall]] = False
        numbers = np.where(enclosed, np.cumsum(enclosed), 0).astype(np.int32)
        return replace(self, names=numbers[self.names], count=int(enclosed.sum()))


def _count(names: NDArray[np.int64]) -> int:
    return int(names.max(initial=-1)) + 1


def _meeting(starts: NDArray[np.int64], ends: NDArray[np.int64], step: int) -> NDArray[np.int64]:
    """Return the pairs of runs, (2, m), of which the second overlaps the first shifted by `step`."""
    low = np.searchsorted(ends, starts + step, side="right")
    high = np.searchsorted(starts, ends + step, side="left")
    return np.stack(integer_ranges(low, high - low))
