# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove false handles of a level set by small changes of its density."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..arrays.chunks import chunks
from ..grids.labelling import Pieces
from .cuts import Cuts
from .handle_places import REACH, Places, TriedPlaces, are_near
from .level_topology import euler_numbers_within, hollows_below, pieces_above
from .saddles import bridges, bridges_by_faces, lids, lids_by_corners

# Chosen by eye; docs/performance, "Voxels and topology", and `python3 run.py bench quality` tell how many false
# handles remain.
# Radii of the change in cells.
_RADII = (1.5, 2.25, 3.0, 4.5)
# Wide changes move a lot from one frame to the next, so the first this many radii are tried alone before all of them.
_NARROW = 2
# A cut removes at most this many cells. More is a limb, which would be cut in another place or not at all in the next
# frame (docs/performance, "Voxels and topology"): the fin of a rocket takes 32 to 45. The deepest cut that spares a
# cactus and a child a handle for two frames takes 28.
_MOST_CUT = 30
# Holes may be filled by a narrow change if their density is at least this fraction of the level. Between the rings of
# scissors that become a snail, it is a quarter; with a half, the thick ring was cut (docs/performance).
_DEEPEST = 0.1
# The isosurface may separate cells at a saddle of their values if the saddle is at least this close to the level.
_SLACK = 0.95
# Number of places examined at once.
_AT_ONCE = 20
# Finds saddles, (n, 3), of a density between two values.
_Finder = Callable[[NDArray[np.floating], float, float], NDArray[np.int64]]


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
    squared = sum(axis**2 for axis in np.ogrid[(slice(-REACH, REACH + 1),) * 3])
    rim = np.exp(-(REACH**2) / (2.0 * radius**2))
    return np.maximum((np.exp(-squared / (2.0 * radius**2)) - rim) / (1.0 - rim), 0.0).astype(np.float32)


# Shapes of the changes, (radii, 13, 13, 13), one at the center and zero at the boundary.
_SHAPES = np.stack([_shape(radius) for radius in _RADII])


def remove_handles(
    density: NDArray[np.floating],
    level: float,
    excess: int,
    effort: Effort = GENTLE,
    tried: TriedPlaces | None = None,
    control: Control = UNINTERRUPTED,
) -> int:
    """Move saddles near a level to its other side until enough handles are removed, the smallest changes first.

    A handle can be cut, or its hole can be filled. Narrow changes come first, in the order of the number of cells that
    they move to the other side. Inside a ring as inside the contact of two rings, the density is about one; only the
    number of cells tells that the contact is thinner.

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
    tried : TriedPlaces, optional
        Where changes were tried in vain before, with no other change of the density since. These places are not tried
        again, and those of this call are added.
    control : Control
        Stops the work when cancelled; the density may have changed then.

    Returns
    -------
    int
        Number of handles removed; the number of components does not increase.
    """
    tried = TriedPlaces() if tried is None else tried
    tried.begin(level)

    def removed(left: int, places: Places, narrowest: int, widest: int) -> int:
        if left <= 0:
            return 0
        return _removed(density, level, left, tried.untried(places, widest), tried, narrowest, widest, control)

    widest = effort.radii
    left = excess - removed(excess, _cheapest_places(density, level, effort, tried), 0, _NARROW)
    if left <= 0:
        return excess - left
    # Then places whose densities are nearest to the level, with wider and wider changes.
    places = _places(density, level, effort, bridges, lids)
    narrow = removed(left, places, 0, _NARROW)
    left -= narrow
    # Where nothing has changed, narrow changes were tried at all of these places.
    wider = (_places(density, level, effort, bridges, lids), 0) if narrow else (places, _NARROW)
    left -= removed(left, *wider, widest)
    if left > 0:
        # Last come saddles that exist only because the isosurface separates cells sharing an edge or a corner.
        between = _places(density, level, effort, bridges_by_faces, lids_by_corners)
        left -= removed(left, between, 0, widest)
    return excess - left


def _removed(
    density: NDArray[np.floating],
    level: float,
    excess: int,
    places: Places,
    tried: TriedPlaces,
    narrowest: int,
    widest: int,
    control: Control,
) -> int:
    """Like `remove_handles`, at given places with the changes of some radii."""
    around = np.pad(density, REACH)
    search = _Search(around, level, narrowest, widest, tried)
    left = excess
    for batch in chunks(len(places.cells), _AT_ONCE):
        control.check()
        left -= search.change(places.chosen(batch), left)
        if left <= 0:
            break
    if left < excess:
        density[...] = around[(slice(REACH, -REACH),) * 3]
    return excess - left


class _Search:
    """A density, padded by the half width of a change, that is modified in place by changes of some radii."""

    def __init__(
        self, around: NDArray[np.floating], level: float, narrowest: int, widest: int, tried: TriedPlaces
    ) -> None:
        self._around, self._level, self._tried = around, level, tried
        self._shapes, self._widths = _SHAPES[narrowest:widest], widest
        # A margin of one cell is enough to connect the outside.
        self._inner = around[(slice(REACH - 1, 1 - REACH),) * 3]
        self._counts: dict[Callable[..., Pieces], int] = {}

    def change(self, places: Places, most: int) -> int:
        """Try changes at places in turn; return how many handles they have removed."""
        cells, wanted = places.cells, places.wanted
        before = self._windows(cells)
        after = before[:, None] * self._factors(cells, wanted)
        gains = self._gains(before, after)
        radii = np.argmax(gains > 0, axis=1)
        flips = (before > self._level) != (after[np.arange(len(cells)), radii] > self._level)
        lowers = wanted < self._level
        is_limb = lowers & (np.count_nonzero(flips, axis=(1, 2, 3)) > _MOST_CUT)
        useful = (gains > 0).any(axis=1) & ~is_limb
        inside = self._inner > self._level
        cuts = Cuts(inside, _flipped(cells, flips, useful & lowers))
        fills = Cuts(~inside, _flipped(cells, flips, useful & ~lowers))
        gone = 0
        # Wider changes than the narrowest one that helps are not tried.
        widths = np.where(useful, 0, self._widths)
        later = np.zeros(len(cells), bool)
        for index in np.flatnonzero(useful):
            if later[index]:
                continue
            # The Euler number cannot tell cutting a handle from splitting a component, or filling one from making a
            # bubble.
            keeps = (cuts if lowers[index] else fills).take(int(index))
            if not (keeps and self._applied(cells[index : index + 1], wanted[index : index + 1], radii[index])):
                widths[index] = len(_RADII)
                continue
            gone += int(gains[index, radii[index]])
            near = are_near(cells, cells[index])
            widths[near] = 0
            self._tried.forget_around(cells[index])
            if gone >= most:
                later[:] = False
                break
            # Gains of overlapping changes have to be computed again.
            later[index + 1 :] |= near[index + 1 :]
        self._tried.add(places.chosen(widths > 0), widths[widths > 0])
        if later.any():
            gone += self.change(places.chosen(later), most - gone)
        return gone

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
        share = wanted / self._around[tuple((cells + REACH).T)] - 1.0
        return 1.0 + share[:, None, None, None, None] * self._shapes

    def _windows(self, cells: NDArray[np.int64]) -> NDArray[np.floating]:
        """Return the density around each cell, (n, 13, 13, 13)."""
        reach = np.arange(2 * REACH + 1)
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
    places = np.stack(offsets, axis=1) + cells[chosen][change] - (REACH - 1)
    ends = np.searchsorted(change, np.arange(len(chosen) + 1))
    return {
        int(index): places[start:end]
        for index, start, end in zip(chosen, ends[:-1], ends[1:], strict=True)
        if end > start
    }


def _span(cell: NDArray[np.int64]) -> tuple[slice, ...]:
    """Return the slices, in the padded density, of the cells that a change at a cell affects."""
    return tuple(slice(int(at), int(at) + 2 * REACH + 1) for at in cell)


def _cheapest_places(density: NDArray[np.floating], level: float, effort: Effort, tried: TriedPlaces) -> Places:
    """Return the places where a narrow change removes a handle, those that move the fewest cells first."""
    thin = [find(density, level * _SLACK, level / effort.false) for find in (bridges, bridges_by_faces)]
    holes = [find(density, level * _DEEPEST, level / _SLACK) for find in (lids, lids_by_corners)]
    found = [np.unique(np.concatenate(cells), axis=0) for cells in (thin, holes)]
    places = tried.untried(Places.of(*found, density, level, effort.places), _NARROW)
    search = _Search(np.pad(density, REACH), level, 0, _NARROW, tried)
    batches = chunks(len(places.cells), _AT_ONCE)
    flips = [search.flips(places.cells[batch], places.wanted[batch]) for batch in batches]
    moved = np.concatenate([np.empty(0, np.int64), *flips])
    order = np.argsort(moved, kind="stable")
    return places.chosen(order[moved[order] >= 0])


def _places(
    density: NDArray[np.floating], level: float, effort: Effort, find_thin: _Finder, find_holes: _Finder
) -> Places:
    """Return saddles of potentially false handles."""
    thin = find_thin(density, level * _SLACK, level / effort.false)
    holes = find_holes(density, level * effort.false, level / _SLACK)
    return Places.of(thin, holes, density, level, effort.places)
