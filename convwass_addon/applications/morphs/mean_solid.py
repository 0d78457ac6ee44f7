# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean of solids by their signed distances, with slender parts that grow and retract evenly, and a given volume.

The weighted mean of the distances d_i is right where surfaces lie side by side. It loses slender parts that only one
solid has: at its weight w, a part of half thickness r has the length r w / (1 - w), so long parts vanish within a
frame or two. Such parts are included up to a front instead, which advances evenly (:mod:`...geometry.part_fronts`).
Parts that link what the solids share are whole while their solid has the largest weight, so that the mean is connected:
the bar of an H opens when the arc of the U below it is closed. Both together have too much volume and become thinner.

The volume of the mean is not that of the solids. If the whole surface were offset, thin parts would vanish. The surface
therefore moves only where the solids differ, in proportion to the spread of the distances: as if the parts that only
some of the solids have were a little earlier or later.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.coarser_grid import CoarserGrid
from ...geometry.exact_depths import exact_depths
from ...geometry.part_fronts import SHORT, PartFronts, SeparatePart, linked_components, separate_parts, shared_core
from .growing_parts import FARTHEST

# Radius with which a part is rounded at its front, in cells of the grid on which fronts are measured.
_ROUNDING = 3.0
# Largest shift relative to the smallest weight.
_MOST_SHIFT = 0.5
# Links are thinned by at most this fraction of their thickness.
_MOST_THINNED = 0.6
# Steps of the bisection for the volume.
_STEPS = 9
# A mean whose volume differs by more than this is offset, in at most so many steps of at most a cell.
_MISSING, _OFFSETS = 0.01, 12
# Distances are computed exactly where the mean solid's surface is this close and distances differ by more than this.
_BAND, _APART = 3.0, 1.0
# Fronts are measured on a coarser grid if the longest side has more cells; so finer grids have the same fronts.
_MOST_CELLS = 144


def mean_solid(
    depths: NDArray[np.float32], weights: Sequence[float], known: float, volume: float | None = None
) -> NDArray[np.float32]:
    """Return the signed distance to the mean of solids, exact only next to its surface.

    Parameters
    ----------
    depths : (k, nx, ny, nz) float32
        Signed distance to the surface of every solid in cells, positive inside, clipped as by
        :func:`.growing_parts.extended`; also (k, nx, ny).
    weights : (k,)
        Weights of the solids, of sum 1.
    known : float
        Distances up to this one are exact.
    volume : float, optional
        Volume of the mean in cells, reached as far as the solids differ.
    """
    weights = np.asarray(weights, np.float32)
    whole = _Mean.of(depths, weights, _Growth.of(depths, weights))
    smallest = whole.at(whole.most)
    # All other cells are far from the surface, at every shift.
    near = np.flatnonzero((smallest < _BAND) & (whole.at(-whole.most) > -_BAND))
    full = np.count_nonzero(smallest >= _BAND)
    mean = whole.cells(near)
    shift = mean.shift(volume, full)
    rough = np.flatnonzero((np.abs(mean.at(shift)) < _BAND) & (mean.spread > _APART))
    if len(rough):
        exact = np.stack([_exact(depth, near[rough], known) for depth in depths])
        mean = mean.corrected(rough, exact, weights)
        shift = mean.shift(volume, full)
    found = mean.at(shift)
    if volume is None or abs(volume - full - _volume(found)) <= _MISSING * volume:
        smallest.ravel()[near] = found
        return smallest
    result = whole.at(shift)
    result.ravel()[near] = found
    # On fine grids, these are large.
    del whole, smallest
    return _offset(result, volume)


def _exact(depth: NDArray[np.float32], cells: NDArray[np.int64], known: float) -> NDArray[np.float32]:
    """Return the distances of some cells, computed exactly where they exceed the known ones."""
    found = depth.ravel()[cells]
    far = np.abs(found) >= known
    found[far] = exact_depths(depth, cells[far])
    return found


@dataclass(frozen=True)
class _Growth:
    """What the fronts of slender parts include and exclude: bounds on the signed distance of some cells.

    Attributes
    ----------
    cells : (n,) int64
        Rising indices of cells in the flattened grid.
    least, most : (n,) float32
        Bounds of their distances.
    thins : (n,) float32
        By how much links can be thinned from each side, 0 elsewhere.
    """

    cells: NDArray[np.int64]
    least: NDArray[np.float32]
    most: NDArray[np.float32]
    thins: NDArray[np.float32]

    @classmethod
    def of(cls, depths: NDArray[np.float32], weights: NDArray[np.float32]) -> _Growth | None:
        """Return the bounds; None if the solids share nothing, or if no part is long."""
        lowest = depths.min(axis=0)
        grid = CoarserGrid(lowest.shape, _MOST_CELLS)
        if not ((depths.max(axis=0) > 0.0) & (lowest < -SHORT * grid.cell)).any():
            return None
        solids = [grid.holding(depth > 0.0) for depth in depths]
        core = shared_core(solids)
        if core is None:
            return None
        components = linked_components(core)
        beyond = -grid.means(lowest) / grid.cell
        farthest = FARTHEST * max(lowest.shape) / grid.cell
        least, most = (np.full(lowest.shape, -np.inf, np.float32) for _ in range(2))
        thins = np.zeros(lowest.shape, np.float32)
        del lowest
        # What solids share, and parts that need no front, are not held back by the fronts of other parts nearby.
        unbounded = core.copy()
        for depth, solid, weight in zip(depths, solids, weights, strict=True):
            parts = separate_parts(solid, core, components, grid.means(depth) / grid.cell, beyond, farthest)
            unbounded |= _without(solid, parts)
            fronts = _Fronts.of(parts, solid, core, float(weight), float(weight / weights.max()), grid.cell)
            near = np.isfinite(fronts.reached)
            within = grid.within(near)
            reached, ending, thinning = (
                grid.interpolated(np.where(near, own, np.float32(0)))[within]
                for own in (fronts.reached, fronts.ends, fronts.thins)
            )
            least[within] = np.maximum(least[within], _rounded(depth[within], reached, _ROUNDING * grid.cell))
            most[within] = np.maximum(most[within], ending)
            thins[within] = np.maximum(thins[within], thinning)
        most[grid.interpolated(unbounded.astype(np.float32)) > 0.5] = np.inf
        cells = np.flatnonzero(np.isfinite(least))
        return cls(cells, least.ravel()[cells], most.ravel()[cells], thins.ravel()[cells])

    def among(self, cells: NDArray[np.int64]) -> _Growth:
        """Return the bounds of those cells that are among some, (m,), rising, with their indices there."""
        places = np.searchsorted(cells, self.cells)
        found = np.flatnonzero(np.append(cells, -1)[places] == self.cells)
        return _Growth(places[found], self.least[found], self.most[found], self.thins[found])

    def bound(self, depth: NDArray[np.float32], thinned: float) -> None:
        """Apply the bounds to distances in place, (nx, ny, nz) or (m,), C-contiguous, and thin links by a fraction."""
        flat = depth.reshape(-1)
        least = self.least - np.float32(thinned) * self.thins
        flat[self.cells] = np.maximum(np.minimum(flat[self.cells], self.most), least)


def _without(solid: NDArray[np.bool_], parts: Sequence[SeparatePart]) -> NDArray[np.bool_]:
    """Return what is left of a solid without some of its parts."""
    rest = solid.copy()
    for part in parts:
        rest[part.box] &= ~part.cells
    return rest


@dataclass(frozen=True)
class _Fronts:
    """The fronts of a solid's parts on the coarser grid, in cells of the finer one.

    Attributes
    ----------
    reached, ends : (nx, ny, nz) float32
        By how much the fronts, and where they end, are beyond every cell; minus infinity far from all parts. Parts that
        are not connected to the core have no front.
    thins : (nx, ny, nz) float32
        By how much parts can be thinned; see :class:`...geometry.part_fronts.PartFronts`.
    """

    reached: NDArray[np.float32]
    ends: NDArray[np.float32]
    thins: NDArray[np.float32]

    @classmethod
    def of(
        cls,
        parts: Sequence[SeparatePart],
        solid: NDArray[np.bool_],
        core: NDArray[np.bool_],
        weight: float,
        link_weight: float,
        cell: int,
    ) -> _Fronts:
        reached, ends = (np.full(core.shape, -np.inf, np.float32) for _ in range(2))
        thins = np.zeros(core.shape, np.float32)
        for part in parts:
            fronts = PartFronts.of(solid, core, part)
            # A part is whole at a weight of 1, and thins at its tip before it retracts.
            near = fronts.near
            height, hold = cell * fronts.heights(weight, link_weight, _ROUNDING)[near], cell * fronts.hold[near]
            own_reached, own_ends, own_thins = (values[part.box] for values in (reached, ends, thins))
            held = np.where(fronts.loose[near], np.float32(-1.0), height - hold)
            own_reached[near] = np.maximum(own_reached[near], held)
            own_ends[near] = np.maximum(own_ends[near], height + 2.0 * hold)
            own_thins[near] = np.maximum(own_thins[near], cell * fronts.thins[near])
        return cls(reached, ends, thins)


@dataclass(frozen=True)
class _Mean:
    """The mean of signed distances, their spread, the bounds from slender parts, and the largest shift."""

    mean: NDArray[np.float32]
    spread: NDArray[np.float32]
    growth: _Growth | None
    most: float

    @classmethod
    def of(cls, depths: NDArray[np.float32], weights: NDArray[np.float32], growth: _Growth | None) -> _Mean:
        return cls(np.tensordot(weights, depths, 1), np.ptp(depths, axis=0), growth, _MOST_SHIFT * float(weights.min()))

    def corrected(self, cells: NDArray[np.int64], depths: NDArray[np.float32], weights: NDArray[np.float32]) -> _Mean:
        """Return the mean with other distances of the solids at some cells, (k, n)."""
        mean, spread = self.mean.copy(), self.spread.copy()
        mean.ravel()[cells], spread.ravel()[cells] = weights @ depths, np.ptp(depths, axis=0)
        return replace(self, mean=mean, spread=spread)

    def cells(self, cells: NDArray[np.int64]) -> _Mean:
        """Return the mean at some cells."""
        growth = None if self.growth is None else self.growth.among(cells)
        return replace(self, mean=self.mean.ravel()[cells], spread=self.spread.ravel()[cells], growth=growth)

    def at(self, shift: float) -> NDArray[np.float32]:
        """Subtract a shift from the weight of what only some solids have."""
        mean = self.mean - np.float32(shift) * self.spread
        # Slender parts end at their fronts, so that nothing hangs free beyond them.
        if self.growth is not None:
            self.growth.bound(mean, _MOST_THINNED * max(shift, 0.0) / self.most)
        return mean

    def shift(self, volume: float | None, full: int) -> float:
        """Return the shift at which these cells and some full ones have a volume, as far as shifts reach."""
        if volume is None:
            return 0.0
        low, high = -self.most, self.most
        for _ in range(_STEPS):
            middle = (low + high) / 2.0
            low, high = (middle, high) if full + _volume(self.at(middle)) > volume else (low, middle)
        return (low + high) / 2.0


def _rounded(depth: NDArray[np.floating], front: NDArray[np.floating], radius: float) -> NDArray[np.float32]:
    """Intersect a part with what its front has reached, with an edge rounded by a radius in cells."""
    below, behind = np.maximum(radius - depth, 0.0), np.maximum(radius - front, 0.0)
    nearest = np.minimum(depth, front)
    return np.where(nearest > radius, nearest, np.minimum(radius - np.hypot(below, behind), nearest)).astype(np.float32)


def _offset(depth: NDArray[np.float32], volume: float) -> NDArray[np.float32]:
    """Offset the whole surface where the solids do not differ enough for their mean to have the volume."""
    offset = 0.0
    for _ in range(_OFFSETS):
        moved = depth + np.float32(offset)
        missing = volume - _volume(moved)
        if abs(missing) <= _MISSING * volume:
            break
        area = np.count_nonzero((moved < 0.5) & (moved > -0.5))
        offset += float(np.clip(missing / max(area, 1), -1.0, 1.0))
    return depth + np.float32(offset) if offset else depth


def _volume(depth: NDArray[np.floating]) -> float:
    filled = depth + np.float32(0.5)
    return float(np.clip(filled, 0.0, 1.0, out=filled).sum(dtype=np.float64))
