# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mend what transport tears: crumbs are dropped, bubbles filled, narrow gaps bridged, false handles cut or filled.

The level set of a blend follows every wrinkle of its density. Where a density next to the level would give another
topology, and the shapes have that one, it is raised or lowered a little around the cell that decides. All is counted on
cells; surfaces are drawn to find the level at first, and at the end. That one is meshed evenly.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .connectivity import Connectivity
from .dilation import dilated
from .even_surface import even_surface
from .handle_removal import RAISED, remove_handles
from .isosurface import LevelSurface, as_floats, bounding_box, estimate_shortfall, level_enclosing, surface_enclosing
from .level_topology import euler_number, hollows_below, pieces_above
from .piece_joining import DEEPEST_GAP, join_pieces
from .saddle_smoothing import smoothed_at_saddles

# How often pieces and bubbles are looked for in a row, and how often all is mended and a surface drawn.
_ATTEMPTS = 24
_ROUNDS = 5
_NOTHING = Connectivity(0, 0, 0)
_COUNTED = ("crumbs", "filled", "bridged", "clipped", "unhandled", "smoothed")
# By how many cells places are smoothed whose handles cannot be removed one by one, and how many are too many to try.
# From a ball to a knot at 100 cells, 57 handles of a frame were removed and 10 were left.
_SMOOTHINGS = (1.0, 1.5, 2.0)
_SPONGE = 12


@dataclass(frozen=True)
class Mending:
    """A surface and what was done to get it.

    Attributes
    ----------
    surface : LevelSurface
        Encloses the volume.
    found, most : Connectivity
        What it has, and what it was to have at the most.
    crumbs, filled, bridged, clipped, unhandled : int
        Pieces that were dropped, bubbles that were filled, gaps that were bridged, pieces that were joined in part,
        handles that were cut or filled.
    smoothed : float
        Cells by which spongy places were smoothed before that, where nothing less removes their handles.
    """

    surface: LevelSurface
    found: Connectivity
    most: Connectivity
    crumbs: int
    filled: int
    bridged: int
    clipped: int
    unhandled: int
    smoothed: float = 0.0

    def record(self) -> dict[str, object]:
        """Return all figures, ready for JSON."""
        return {
            "found": asdict(self.found),
            "most": asdict(self.most),
            "mended": {name: getattr(self, name) for name in _COUNTED},
        }


def mended_surface(density: NDArray[np.floating], volume: float, most: Connectivity) -> Mending:
    """Evenly meshed surface that encloses a volume, with no more pieces, handles and bubbles than asked for.

    Only small changes are made. What would take more stays as it is: the record tells.

    Parameters
    ----------
    density : (nx, ny, nz)
        What to take the surface of.
    volume : float
        In cells.
    most : Connectivity
        As many as the shapes have that are blended.

    Raises
    ------
    InputError
        As :func:`surface_enclosing` does.
    """
    density = as_floats(density)
    # What is thinner than the deepest gap plays no part.
    box, low = _box_of_interest(density, volume)
    given = np.array(density[box], order="C")
    work = _Work(given.copy(), volume, most, _SPONGE)
    level = work.level
    best = _settled(work, most)
    # What is no sponge keeps its handles after little smoothing or after any.
    is_sponge = best.mending.found.beyond(most).handles > _SPONGE
    for sigma in _SMOOTHINGS if is_sponge else _SMOOTHINGS[:1]:
        if best.mending.found.beyond(most).handles == 0:
            break
        too_many = None if sigma == _SMOOTHINGS[-1] else _SPONGE
        found = _settled(_Work(smoothed_at_saddles(given, level, sigma), volume, most, too_many), most)
        if found.mending.found.beyond(most) < best.mending.found.beyond(most):
            best = _Settled(replace(found.mending, smoothed=sigma), found.density)
    surface = even_surface(best.mending.surface, best.density)
    return replace(best.mending, surface=LevelSurface(surface.mesh.moved(low), surface.level))


@dataclass(frozen=True)
class _Settled:
    """A surface that is mended, and the density that it was drawn of."""

    mending: Mending
    density: NDArray[np.floating]


def _settled(work: _Work, most: Connectivity) -> _Settled:
    """Mend and draw in turn until nothing is left to mend."""
    best = None
    for _ in range(_ROUNDS):
        changed = work.mend()
        if best is None or changed:
            drawn = work.drawn()
            if best is None or drawn.found.beyond(most) < best.mending.found.beyond(most):
                best = _Settled(drawn, work.density.copy())
        if not changed or best.mending.found.beyond(most) == _NOTHING:
            break
    return best


class _Work:
    """A density that is changed step by step, in place.

    Attributes
    ----------
    density : (nx, ny, nz)
        As it is now.
    level : float
        Of the surface.

    Parameters
    ----------
    density, volume, most
        As for :func:`mended_surface`.
    too_many : int or None
        More handles than that are not removed one by one.
    """

    def __init__(self, density: NDArray[np.floating], volume: float, most: Connectivity, too_many: int | None) -> None:
        self.density, self._volume, self._most, self._too_many = density, volume, most, too_many
        self._shortfall = estimate_shortfall(density, volume)
        self.level = level_enclosing(density, volume, self._shortfall)
        self._crumbs = self._filled = self._bridged = self._clipped = self._unhandled = 0

    def drawn(self) -> Mending:
        """Draw the surface as it is now; what is mended next is seen at its level."""
        surface = surface_enclosing(self.density, self._volume, self._shortfall)
        self.level = surface.level
        return Mending(surface, Connectivity.of(surface), self._most, *self._counts())

    def mend(self) -> bool:
        """Mend what is seen at the present level; return whether there was anything that could be."""
        before = self._counts()
        pieces = self._join_pieces()
        bubbles = self._fill_bubbles()
        handles = pieces + bubbles - euler_number(self.density, self.level) // 2
        excess = handles - self._most.handles
        if excess > 0 and (self._too_many is None or excess <= self._too_many):
            self._unhandled += remove_handles(self.density, self.level, excess)
        return before != self._counts()

    def _counts(self) -> tuple[int, ...]:
        return self._crumbs, self._filled, self._bridged, self._clipped, self._unhandled

    def _join_pieces(self) -> int:
        """Bridge gaps and drop what hangs on by none; return how many pieces are left."""
        for _ in range(_ATTEMPTS):
            pieces = pieces_above(self.density, self.level)
            if pieces.count <= self._most.pieces:
                break
            done = join_pieces(self.density, self.level, pieces, self._most.pieces, self._volume)
            self._bridged += done.bridged
            self._clipped += done.clipped
            self._crumbs += done.dropped
            if not done.any:
                break
        return pieces.count

    def _fill_bubbles(self) -> int:
        """Fill the smallest hollows; return how many are left."""
        for _ in range(_ATTEMPTS):
            hollows = hollows_below(self.density, self.level)
            excess = hollows.count - self._most.bubbles
            if excess <= 0:
                break
            sizes = np.bincount(hollows.labels.ravel())
            smallest = np.zeros(len(sizes), bool)
            smallest[1 + np.argsort(sizes[1:], kind="stable")[:excess]] = True
            # With the cells around them, so that a slightly higher level does not bring them back.
            filled = dilated(smallest[hollows.labels])
            self.density[filled] = np.maximum(self.density[filled], RAISED * self.level)
            self._filled += excess
        return hollows.count


def _box_of_interest(density: NDArray[np.floating], volume: float) -> tuple[tuple[slice, ...], NDArray[np.int64]]:
    """Return the box that holds all that mending may look at, and its low corner."""
    positive = density[density > 0]
    rank = max(len(positive) - 1 - int(volume), 0)
    level = np.partition(positive, rank)[rank] if len(positive) else 0.0
    if level <= 0.0:
        return (slice(None),) * 3, np.zeros(3, np.int64)
    low, high = bounding_box(density > DEEPEST_GAP / 2 * level)
    low, high = np.maximum(low - 1, 0), np.minimum(high + 1, density.shape)
    return tuple(slice(a, b) for a, b in zip(low, high, strict=True)), low
