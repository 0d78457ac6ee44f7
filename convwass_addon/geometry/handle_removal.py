# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove false handles of a level set by small changes of its density."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .cuts import Cuts
from .labelling import Pieces
from .level_topology import euler_numbers_within, hollows_below, pieces_above
from .saddles import bridges, bridges_by_faces, lids, lids_by_corners

# Chosen by eye; docs/performance.md, "Voxels and topology", and `python3 run.py bench quality` tell how many false
# handles remain.
# Density to which cells are raised or lowered, relative to the level, and the radii of the change in cells.
RAISED, LOWERED = 1.1, 0.85
_RADII = (1.5, 2.25, 3.0, 4.5)
# Wide changes move a lot from one frame to the next, so the first this many radii are tried alone before all of them.
_NARROW = 2
# Holes may be filled by a narrow change if their density is at least this fraction of the level. Between the rings of
# scissors that become a snail, it is a quarter; with a half, the thick ring was cut (docs/performance.md).
_DEEPEST = 0.1
# The isosurface may separate cells at a saddle of their values if the saddle is at least this close to the level.
_SLACK = 0.95
# Number of places examined at once.
_AT_ONCE = 20
# Half width of a change in cells. Its shapes are (radii, 13, 13, 13), one at the center and zero at the boundary.
_REACH = 6
# More than a grid has along an axis.
_MOST_CELLS = 1 << 16


@dataclass(frozen=True)
class Effort:
    """How large the changes are that remove handles.

    Attributes
    ----------
    false : float
        A handle may be removed if the level is at least this fraction of the density at its thinnest place, or if the
        density in its hole is at least this fraction of the level.
    radii : int
        How many of the radii are tried.
    places : int
        Number of places examined.
    smoothings : int
        How strongly places are smoothed, from 1 to 3, where handles remain.
    """

    false: float
    radii: int
    places: int
    smoothings: int


GENTLE = Effort(0.5, 3, 240, 1)
"""For every blend by itself."""
FIRM = Effort(0.1, 4, 960, 3)
"""For blends whose neighbors have no such handle. From octopus to horse at 64 cells, the handle of one frame in 24
takes a fraction of 0.2; from ball to knot at 40 cells by transport, seven frames take the strongest smoothing."""


def _shape(radius: float) -> NDArray[np.float32]:
    squared = sum(axis**2 for axis in np.ogrid[(slice(-_REACH, _REACH + 1),) * 3])
    rim = np.exp(-(_REACH**2) / (2.0 * radius**2))
    return np.maximum((np.exp(-squared / (2.0 * radius**2)) - rim) / (1.0 - rim), 0.0).astype(np.float32)


_SHAPES = np.stack([_shape(radius) for radius in _RADII])


def remove_handles(density: NDArray[np.floating], level: float, excess: int, effort: Effort = GENTLE) -> int:
    """Move saddles near a level to its other side until enough handles are removed, the smallest changes first.

    A handle can be cut, or its hole can be filled. Narrow changes come first, in the order of the number of cells that
    they move to the other side: inside a ring as inside the contact of two rings, the density is about one, and only
    the number of cells tells that the contact is thinner.

    Parameters
    ----------
    density : (nx, ny, nz)
        Changed in place.
    level : float
        Level of the surface.
    excess : int
        Number of handles to remove.
    effort : Effort
        The largest changes.

    Returns
    -------
    int
        Number of handles removed; the number of components does not increase.
    """
    cheap = _removed(density, level, excess, _SHAPES[:_NARROW], _cheapest_places(density, level, effort))
    return cheap.count + _removed_by_density(density, level, excess - cheap.count, effort)


def _removed_by_density(density: NDArray[np.floating], level: float, excess: int, effort: Effort) -> int:
    """Remove handles at the places whose densities are nearest to the level, with wider and wider changes."""
    if excess <= 0:
        return 0
    own = _SHAPES[: effort.radii]
    places = _places(density, level, effort)
    narrow = _removed(density, level, excess, own[:_NARROW], places)
    wide = between = _NOTHING
    if narrow.count < excess:
        if narrow.count:
            wide = _removed(density, level, excess - narrow.count, own, _places(density, level, effort))
        else:
            # The density is as before, so that what was tried would fail again.
            wide = _removed(density, level, excess, own[_NARROW:], places.chosen(~narrow.helpful))
    left = excess - narrow.count - wide.count
    if left > 0:
        others = _places_between(density, level, effort)
        between = _removed(density, level, left, own, others if left < excess else others.beyond(places))
    return excess - left + between.count


@dataclass(frozen=True)
class _Removed:
    """Number of removed handles, and which of the places would remove one if it could be changed alone."""

    count: int
    helpful: NDArray[np.bool_]


_NOTHING = _Removed(0, np.zeros(0, bool))


def _removed(
    density: NDArray[np.floating], level: float, excess: int, shapes: NDArray[np.float32], places: _Places
) -> _Removed:
    """Like `remove_handles`, with given shapes of changes at given places."""
    around = np.pad(density, _REACH)
    search = _Search(around, level, shapes)
    left = excess
    cells, wanted = places.cells, places.wanted
    helpful = np.zeros(len(cells), bool)
    for start in range(0, len(cells), _AT_ONCE):
        batch = slice(start, start + _AT_ONCE)
        done = search.change(cells[batch], wanted[batch], left)
        helpful[batch] = done.helpful
        left -= done.count
        if left <= 0:
            break
    if left < excess:
        density[...] = around[(slice(_REACH, -_REACH),) * 3]
    return _Removed(excess - left, helpful)


@dataclass(frozen=True)
class _Places:
    """Cells, (n, 3), whose density may be changed, their new densities, (n,), and which of these are higher, (n,)."""

    cells: NDArray[np.int64]
    wanted: NDArray[np.floating]
    is_raised: NDArray[np.bool_]

    @classmethod
    def of(
        cls, thin: NDArray[np.int64], holes: NDArray[np.int64], density: NDArray[np.floating], level: float, most: int
    ) -> _Places:
        """Lower the density at thin places and raise it in holes, at `most` of them, the nearest to the level first."""
        cells = np.concatenate([thin, holes])
        is_raised = np.arange(len(cells)) >= len(thin)
        wanted = np.where(is_raised, RAISED * level, LOWERED * level).astype(density.dtype)
        order = np.argsort(np.abs(np.log(density[tuple(cells.T)] / level)), kind="stable")[:most]
        return cls(cells[order], wanted[order], is_raised[order])

    def chosen(self, which: NDArray[np.bool_] | NDArray[np.int64]) -> _Places:
        """Return some of the places."""
        return _Places(self.cells[which], self.wanted[which], self.is_raised[which])

    def beyond(self, others: _Places) -> _Places:
        """Return the places that are not among others."""
        return self.chosen(~np.isin(self._keys(), others._keys()))

    def _keys(self) -> NDArray[np.int64]:
        """Return a number for every place that no other place has, (n,)."""
        return 2 * np.ravel_multi_index(tuple(self.cells.T), (_MOST_CELLS,) * 3) + self.is_raised


class _Search:
    """A density, padded by the half width of a change, that is modified in place."""

    def __init__(self, around: NDArray[np.floating], level: float, shapes: NDArray[np.float32]) -> None:
        self._around, self._level, self._shapes = around, level, shapes
        # A margin of one cell is enough to connect the outside.
        self._inner = around[(slice(_REACH - 1, 1 - _REACH),) * 3]
        self._counts: dict[Callable[..., Pieces], int] = {}

    def change(self, cells: NDArray[np.int64], wanted: NDArray[np.floating], most: int) -> _Removed:
        """Try changes at cells, (n, 3), in turn."""
        before = self._windows(cells)
        after = before[:, None] * self._factors(cells, wanted)
        gains = self._gains(before, after)
        radii = np.argmax(gains > 0, axis=1)
        flips = (before > self._level) != (after[np.arange(len(cells)), radii] > self._level)
        useful, lowers = (gains > 0).any(axis=1), wanted < self._level
        inside = self._inner > self._level
        cuts = Cuts(inside, _flipped(cells, flips, useful & lowers))
        fills = Cuts(~inside, _flipped(cells, flips, useful & ~lowers))
        gone = 0
        later = np.zeros(len(cells), bool)
        for index in np.flatnonzero(useful):
            if later[index]:
                continue
            # The Euler number cannot tell cutting a handle from splitting a component, or filling one from making a
            # bubble.
            if not (cuts if lowers[index] else fills).take(int(index)):
                continue
            if not self._applied(cells[index : index + 1], wanted[index : index + 1], radii[index]):
                continue
            gone += int(gains[index, radii[index]])
            if gone >= most:
                return _Removed(gone, useful)
            # Gains of overlapping changes have to be computed again.
            later[index + 1 :] |= np.abs(cells[index + 1 :] - cells[index]).max(axis=1) <= 2 * _REACH
        if later.any():
            gone += self.change(cells[later], wanted[later], most - gone).count
        return _Removed(gone, useful)

    def flips(self, cells: NDArray[np.int64], wanted: NDArray[np.floating]) -> NDArray[np.int64]:
        """Return how many cells a change at each cell, (n, 3), moves to the other side of the level, (n,).

        This is for the narrowest change that removes a handle; where none does, the number is -1.
        """
        before = self._windows(cells)
        after = before[:, None] * self._factors(cells, wanted)
        helps = self._gains(before, after) > 0
        changed = after[np.arange(len(cells)), np.argmax(helps, axis=1)]
        counts = np.count_nonzero((before > self._level) != (changed > self._level), axis=(1, 2, 3))
        return np.where(helps.any(axis=1), counts, -1)

    def _applied(self, cell: NDArray[np.int64], wanted: NDArray[np.floating], radius: np.int64) -> bool:
        """Change the density at one cell, (1, 3), unless this splits a component or a hollow; return whether it did."""
        span = _span(cell[0])
        before = self._around[span].copy()
        counted = pieces_above if wanted[0] < self._level else hollows_below
        if counted not in self._counts:
            self._counts[counted] = counted(self._inner, self._level).count
        self._around[span] *= self._factors(cell, wanted)[0, radius]
        count = counted(self._inner, self._level).count
        if count > self._counts[counted]:
            self._around[span] = before
            return False
        self._counts[counted] = count
        return True

    def _factors(self, cells: NDArray[np.int64], wanted: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the factors of the density around each cell for each radius, (n, radii, 13, 13, 13)."""
        share = wanted / self._around[tuple((cells + _REACH).T)] - 1.0
        return 1.0 + share[:, None, None, None, None] * self._shapes

    def _windows(self, cells: NDArray[np.int64]) -> NDArray[np.floating]:
        """Return the density around each cell, (n, 13, 13, 13)."""
        reach = np.arange(2 * _REACH + 1)
        i, j, k = cells.T[:, :, None] + reach
        return self._around[i[:, :, None, None], j[:, None, :, None], k[:, None, None, :]]

    def _gains(self, before: NDArray[np.floating], after: NDArray[np.floating]) -> NDArray[np.int64]:
        """Return how many handles each change removes at each radius if it splits no component, (n, radii)."""
        numbers = euler_numbers_within(after.reshape(-1, *before.shape[1:]), self._level).reshape(len(before), -1)
        return np.rint((numbers - euler_numbers_within(before, self._level)[:, None]) / 2).astype(np.int64)


def _flipped(
    cells: NDArray[np.int64], flips: NDArray[np.bool_], wanted: NDArray[np.bool_]
) -> dict[int, NDArray[np.int64]]:
    """Return the cells, (m, 3), that wanted changes move to the other side of the level, by the index of the change."""
    chosen = np.flatnonzero(wanted)
    change, *offsets = np.nonzero(flips[chosen])
    # Cells of the density with a margin of one cell.
    places = np.stack(offsets, axis=1) + cells[chosen][change] - (_REACH - 1)
    ends = np.searchsorted(change, np.arange(len(chosen) + 1))
    return {
        int(index): places[start:end]
        for index, start, end in zip(chosen, ends[:-1], ends[1:], strict=True)
        if end > start
    }


def _span(cell: NDArray[np.int64]) -> tuple[slice, ...]:
    """Return the slices, in the padded density, of the cells that a change at a cell affects."""
    return tuple(slice(int(at), int(at) + 2 * _REACH + 1) for at in cell)


def _cheapest_places(density: NDArray[np.floating], level: float, effort: Effort) -> _Places:
    """Return the places where a narrow change removes a handle, those that move the fewest cells first."""
    thin = [find(density, level * _SLACK, level / effort.false) for find in (bridges, bridges_by_faces)]
    holes = [find(density, level * _DEEPEST, level / _SLACK) for find in (lids, lids_by_corners)]
    found = [np.unique(np.concatenate(cells), axis=0) for cells in (thin, holes)]
    places = _Places.of(*found, density, level, effort.places)
    search = _Search(np.pad(density, _REACH), level, _SHAPES[:_NARROW])
    batches = [slice(start, start + _AT_ONCE) for start in range(0, len(places.cells), _AT_ONCE)]
    flips = [search.flips(places.cells[batch], places.wanted[batch]) for batch in batches]
    moved = np.concatenate([np.empty(0, np.int64), *flips])
    order = np.argsort(moved, kind="stable")
    return places.chosen(order[moved[order] >= 0])


def _places(density: NDArray[np.floating], level: float, effort: Effort) -> _Places:
    """Return saddles of potentially false handles."""
    thin = bridges(density, level * _SLACK, level / effort.false)
    holes = lids(density, level * effort.false, level / _SLACK)
    return _Places.of(thin, holes, density, level, effort.places)


def _places_between(density: NDArray[np.floating], level: float, effort: Effort) -> _Places:
    """Return saddles that exist only because the isosurface separates cells sharing an edge or a corner."""
    thin = bridges_by_faces(density, level * _SLACK, level / effort.false)
    holes = lids_by_corners(density, level * effort.false, level / _SLACK)
    return _Places.of(thin, holes, density, level, effort.places)
