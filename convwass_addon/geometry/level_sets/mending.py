# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Repair the topology of blends: drop crumbs, fill bubbles, bridge narrow gaps, cut or fill false handles.

The level set of a blend follows every detail of its density. Where densities close to the level would give another
topology, one that the input shapes have, the density is raised or lowered slightly around the deciding cell. Topology
is counted on cells; surfaces are extracted only to find the level and at the end. The final surface is meshed evenly.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..grids.boxes import Box, box_around
from ..grids.dilation import dilated
from .connectivity import Connectivity
from .even_surface import even_surface
from .handle_places import RAISED, TriedPlaces
from .handle_removal import GENTLE, Effort, remove_handles
from .isosurface import EstimatedSurface, LevelSurface, as_floats, level_enclosing, surface_enclosing
from .level_topology import euler_number, hollows_below, pieces_above
from .piece_joining import DEEPEST_GAP, join_pieces
from .saddle_smoothing import smoothed_at_saddles

# How often components and bubbles are searched in a row, and how often everything is repaired and a surface extracted.
_ATTEMPTS = 24
_ROUNDS = 5
_NOTHING = Connectivity(0, 0, 0)
_COUNTED = ("crumbs", "filled", "bridged", "clipped", "unhandled", "smoothed")
# Blur, in cells, of places whose handles cannot be removed one by one, and the number of handles above which that is
# not tried. From a ball to a knot at 100 cells, 57 handles of a frame were removed and 10 were left.
_SMOOTHINGS = (1.0, 1.5, 2.0)
_SPONGE = 12


@dataclass(frozen=True)
class Mending:
    """A surface and how it was repaired.

    Attributes
    ----------
    surface : LevelSurface
        The surface that encloses the volume.
    found, most : Connectivity
        Its topology, and the largest numbers allowed.
    crumbs, filled, bridged, clipped, unhandled : int
        Numbers of dropped components, filled bubbles, bridged gaps, partially joined components, and removed handles.
    density : (nx, ny, nz)
        The repaired density.
    smoothed : float
        Blur in cells of spongy places, if their handles could not be removed otherwise.
    """

    surface: LevelSurface
    found: Connectivity
    most: Connectivity
    crumbs: int
    filled: int
    bridged: int
    clipped: int
    unhandled: int
    density: NDArray[np.floating] = field(repr=False, compare=False)
    smoothed: float = 0.0

    def record(self) -> dict[str, object]:
        """Return all figures, ready for JSON."""
        return {
            "found": asdict(self.found),
            "most": asdict(self.most),
            "mended": {name: getattr(self, name) for name in _COUNTED},
        }


def mended_surface(
    density: NDArray[np.floating],
    volume: float,
    most: Connectivity,
    effort: Effort = GENTLE,
    control: Control = UNINTERRUPTED,
) -> Mending:
    """Extract an evenly meshed surface that encloses a volume, with bounded numbers of components, handles and bubbles.

    Only small changes are made. Defects that would need larger ones remain and are listed in the record.

    Parameters
    ----------
    density : (nx, ny, nz)
        The density of the blend.
    volume : float
        In cells.
    most : Connectivity
        Largest numbers of components, handles and bubbles: those of the input shapes.
    effort : Effort
        How large the changes are that remove handles.
    control : Control
        Stops the work when cancelled.

    Raises
    ------
    InputError
        As for :func:`surface_enclosing`.
    """
    density = as_floats(density)
    # Parts thinner than the deepest gap are irrelevant.
    box = _box_of_interest(density, volume)
    work = _Work(np.array(density[box], order="C"), volume, most, _SPONGE, effort, control)
    level = work.level
    best = _repair_until_stable(work, most)
    # Where there is no sponge, more smoothing removes no more handles than a little.
    is_sponge = best.mending.found.beyond(most).handles > _SPONGE
    for sigma in _SMOOTHINGS if is_sponge else _SMOOTHINGS[: effort.smoothings]:
        if best.mending.found.beyond(most).handles == 0:
            break
        too_many = None if sigma == _SMOOTHINGS[-1] else _SPONGE
        smoothed = smoothed_at_saddles(np.array(density[box], order="C"), level, sigma)
        found = _repair_until_stable(_Work(smoothed, volume, most, too_many, effort, control), most)
        if found.mending.found.beyond(most) < best.mending.found.beyond(most):
            best = _Settled(replace(found.mending, smoothed=sigma), found.density)
    surface = even_surface(best.mending.surface, best.density)
    repaired = density
    # On fine grids, copies are large.
    if not np.array_equal(best.density, density[box]):
        repaired = density.copy()
        repaired[box] = best.density
    placed = LevelSurface(surface.mesh.moved([span.start for span in box]), surface.level)
    return replace(best.mending, surface=placed, density=repaired)


@dataclass(frozen=True)
class _Settled:
    """A repaired surface and its density."""

    mending: Mending
    density: NDArray[np.floating]


def _repair_until_stable(work: _Work, most: Connectivity) -> _Settled:
    """Alternate between repairing and extracting until nothing changes."""
    best = None
    for _ in range(_ROUNDS):
        level = work.level
        changed = work.mend()
        if best is None or changed:
            drawn = work.drawn()
            if best is None or drawn.found.beyond(most) < best.mending.found.beyond(most):
                best = _Settled(drawn, work.density)
        # The first level is only an estimate; at that of the extracted surface, there may be defects that it lacks.
        stable = not changed and work.level == level
        if stable or best.mending.found.beyond(most) == _NOTHING:
            break
        if best.density is work.density:
            work.density = work.density.copy()
    return best


class _Work:
    """A density that is repaired step by step, in place.

    Attributes
    ----------
    density : (nx, ny, nz)
        Its current state, which repairs change in place.
    level : float
        Level of the surface.

    Parameters
    ----------
    density, volume, most, effort, control
        As for :func:`mended_surface`.
    too_many : int or None
        If there are more excess handles than this, none is removed.
    """

    def __init__(
        self,
        density: NDArray[np.floating],
        volume: float,
        most: Connectivity,
        too_many: int | None,
        effort: Effort,
        control: Control,
    ) -> None:
        self.density, self._volume, self._most, self._too_many = density, volume, most, too_many
        self._effort, self._control = effort, control
        estimated = EstimatedSurface.of(density, volume)
        self._shortfall = estimated.shortfall
        # The surface of the density as long as that is not changed, if it is known.
        self._surface = None if estimated.shortfall else estimated.surface
        self.level = level_enclosing(density, volume, self._shortfall) if self._shortfall else estimated.surface.level
        self._crumbs = self._filled = self._bridged = self._clipped = self._unhandled = 0
        self._tried = TriedPlaces()

    def drawn(self) -> Mending:
        """Extract the current surface; the next repairs use its level."""
        surface = self._surface or surface_enclosing(self.density, self._volume, self._shortfall)
        self.level = surface.level
        return Mending(surface, Connectivity.of(surface), self._most, *self._counts(), self.density)

    def mend(self) -> bool:
        """Repair defects at the current level; return whether anything was repaired."""
        before = self._counts()
        pieces = self._join_pieces()
        bubbles = self._fill_bubbles()
        if before != self._counts():
            self._tried = TriedPlaces()
        handles = pieces + bubbles - euler_number(self.density, self.level) // 2
        excess = handles - self._most.handles
        if excess > 0 and (self._too_many is None or excess <= self._too_many):
            self._surface = None
            self._unhandled += remove_handles(
                self.density, self.level, excess, self._effort, self._tried, self._control
            )
        return before != self._counts()

    def _counts(self) -> tuple[int, ...]:
        return self._crumbs, self._filled, self._bridged, self._clipped, self._unhandled

    def _join_pieces(self) -> int:
        """Bridge gaps and drop components that no gap connects; return the number of components left."""
        for _ in range(_ATTEMPTS):
            self._control.check()
            pieces = pieces_above(self.density, self.level)
            if pieces.count <= self._most.pieces:
                break
            self._surface = None
            done = join_pieces(self.density, self.level, pieces, self._most.pieces, self._volume)
            self._bridged += done.bridged
            self._clipped += done.clipped
            self._crumbs += done.dropped
            if not done.any:
                break
        return pieces.count

    def _fill_bubbles(self) -> int:
        """Fill the smallest hollows; return the number left."""
        for _ in range(_ATTEMPTS):
            self._control.check()
            hollows = hollows_below(self.density, self.level)
            excess = hollows.count - self._most.bubbles
            if excess <= 0:
                break
            sizes = np.bincount(hollows.labels.ravel())
            smallest = np.zeros(len(sizes), bool)
            smallest[1 + np.argsort(sizes[1:], kind="stable")[:excess]] = True
            # Include adjacent cells, so that a slightly higher level does not reopen the hollows.
            filled = dilated(smallest[hollows.labels])
            self._surface = None
            self.density[filled] = np.maximum(self.density[filled], RAISED * self.level)
            self._filled += excess
        return hollows.count


def _box_of_interest(density: NDArray[np.floating], volume: float) -> Box:
    """Return the box of all cells that repairs can depend on."""
    positive = density[density > 0]
    rank = max(len(positive) - 1 - int(volume), 0)
    level = np.partition(positive, rank)[rank] if len(positive) else 0.0
    if level <= 0.0:
        return tuple(slice(0, size) for size in density.shape)
    return box_around(density > DEEPEST_GAP / 2 * level, 1)
