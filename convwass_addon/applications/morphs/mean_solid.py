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

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.grids.boxes import Box, box_around, slabs
from ...geometry.grids.coarser_grid import CoarserGrid
from ...geometry.level_sets.part_fronts import (
    SHORT,
    PartFronts,
    SeparatePart,
    linked_components,
    separate_parts,
    shared_core,
)
from ...geometry.solids.exact_depths import exact_depths
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
# After an offset by more than this, in cells, they are computed exactly where its surface is this close.
_FAR, _NEXT = 0.25, 1.5
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
        :func:`.growing_parts.extend`; also (k, nx, ny).
    weights : (k,)
        Weights of the solids, of sum 1.
    known : float
        Distances up to this one are exact.
    volume : float, optional
        Volume of the mean in cells, reached as far as the solids differ.
    """
    weights = np.asarray(weights, np.float32)
    growth = _Growth.of(depths, weights)
    # All other cells are far from the surface, at every shift.
    result, near, mean = _smallest(depths, weights, growth)
    full = np.count_nonzero(result >= _BAND)
    shift = mean.shift(volume, full)
    rough = np.flatnonzero((np.abs(mean.at(shift)) < _BAND) & (mean.spread > _APART))
    if len(rough):
        mean = mean.corrected(rough, _exact(depths, near[rough], known), weights)
        shift = mean.shift(volume, full)
    found = mean.at(shift)
    if volume is None or abs(volume - full - _volume(found)) <= _MISSING * volume:
        result.ravel()[near] = found
        return result
    for slab, whole in _by_slabs(depths, weights, growth):
        result[slab] = whole.at(shift)
    result.ravel()[near] = found
    offset = _offset(result, volume)
    if abs(offset) > _FAR:
        # The surface has moved to where distances are not exact.
        cells = np.flatnonzero(np.abs(result) < _NEXT)
        mean = _Mean.of(_exact(depths, cells, known), weights, None if growth is None else growth.among(cells))
        result.ravel()[cells] = mean.at(shift) + np.float32(offset)
        _offset(result, volume)
    return result


def _by_slabs(
    depths: NDArray[np.float32], weights: NDArray[np.float32], growth: _Growth | None
) -> Iterator[tuple[Box, _Mean]]:
    """Yield the slabs of the grid, and the mean in each; its arrays would be large for the whole grid."""
    layer = int(np.prod(depths.shape[2:]))
    for slab in slabs(depths.shape[1:]):
        own = None if growth is None else growth.between(slab[0].start * layer, slab[0].stop * layer)
        yield slab, _Mean.of(depths[:, *slab], weights, own)


def _smallest(
    depths: NDArray[np.float32], weights: NDArray[np.float32], growth: _Growth | None
) -> tuple[NDArray[np.float32], NDArray[np.int64], _Mean]:
    """Return the mean at the largest shift; the cells near its surface at some shift, rising; and the mean in these."""
    result, found = np.empty(depths.shape[1:], np.float32), []
    layer = int(np.prod(result.shape[1:]))
    for slab, mean in _by_slabs(depths, weights, growth):
        result[slab] = mean.at(mean.most)
        near = np.flatnonzero((result[slab] < _BAND) & (mean.at(-mean.most) > -_BAND))
        found.append((near + slab[0].start * layer, mean.mean.ravel()[near], mean.spread.ravel()[near]))
    cells, means, spreads = (np.concatenate(own) for own in zip(*found, strict=True))
    return result, cells, _Mean(means, spreads, None if growth is None else growth.among(cells), mean.most)


def _exact(depths: NDArray[np.float32], cells: NDArray[np.int64], known: float) -> NDArray[np.float32]:
    """Return the distances of some cells, (k, n), computed exactly where they exceed the known ones."""
    found = depths.reshape(len(depths), -1).take(cells, axis=1)
    for own, depth in zip(found, depths, strict=True):
        far = np.abs(own) >= known
        own[far] = exact_depths(depth, cells[far])
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
        shape = depths.shape[1:]
        grid = CoarserGrid(shape, _MOST_CELLS)
        solids = [grid.holding(depth > 0.0) for depth in depths]
        beyond, is_long = [], False
        for slab in slabs(shape, grid.cell):
            lowest = depths[:, *slab].min(axis=0)
            is_long |= bool(((depths[:, *slab].max(axis=0) > 0.0) & (lowest < -SHORT * grid.cell)).any())
            beyond.append(-grid.means_in_slab(lowest) / grid.cell)
        core = shared_core(solids) if is_long else None
        if core is None:
            return None
        components = linked_components(core)
        beyond, farthest = np.concatenate(beyond), FARTHEST * max(shape) / grid.cell
        # What solids share, and parts that need no front, are not held back by the fronts of other parts nearby.
        unbounded = core.copy()
        bounds: list[_Growth] = []
        for depth, solid, weight in zip(depths, solids, weights, strict=True):
            parts = separate_parts(solid, core, components, grid.means(depth) / grid.cell, beyond, farthest)
            unbounded |= _without(solid, parts)
            fronts = _Fronts.of(parts, solid, core, float(weight), float(weight / weights.max()), grid.cell)
            bounds.append(cls._of_solid(depth, fronts, grid))
        cells = np.unique(np.concatenate([own.cells for own in bounds]))
        least, most = (np.full(cells.shape, -np.inf, np.float32) for _ in range(2))
        thins = np.zeros(cells.shape, np.float32)
        for own in bounds:
            places = np.searchsorted(cells, own.cells)
            for values, others in ((least, own.least), (most, own.most), (thins, own.thins)):
                values[places] = np.maximum(values[places], others)
        if len(cells):
            at = np.unravel_index(cells, shape)
            box = tuple(slice(int(own.min()), int(own.max()) + 1) for own in at)
            free = grid.interpolated(unbounded.astype(np.float32), box) > 0.5
            most[free[tuple(own - span.start for own, span in zip(at, box, strict=True))]] = np.inf
        return cls(cells, least, most, thins)

    @classmethod
    def _of_solid(cls, depth: NDArray[np.float32], fronts: _Fronts, grid: CoarserGrid) -> _Growth:
        """Return the bounds from the fronts of one solid."""
        near = np.isfinite(fronts.reached)
        if not near.any():
            nothing = np.empty(0, np.float32)
            return cls(np.empty(0, np.int64), nothing, nothing, nothing)
        box = grid.finer_box(box_around(near, 0))
        within = grid.within(near, box)
        reached, ends, thins = (
            grid.interpolated(np.where(near, own, np.float32(0)), box)[within]
            for own in (fronts.reached, fronts.ends, fronts.thins)
        )
        places = [own + span.start for own, span in zip(np.nonzero(within), box, strict=True)]
        cells = np.ravel_multi_index(places, depth.shape)
        return cls(cells, _rounded(depth[box][within], reached, _ROUNDING * grid.cell), ends, thins)

    def between(self, start: int, stop: int) -> _Growth:
        """Return the bounds of cells in a range of indices, with their indices there."""
        first, end = np.searchsorted(self.cells, (start, stop))
        own = slice(first, end)
        return _Growth(self.cells[own] - start, self.least[own], self.most[own], self.thins[own])

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
    """Return what is left of a solid without those of its parts that have fronts."""
    rest = solid.copy()
    for part in parts:
        rest[part.box] &= ~part.fronted
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
        mean[cells], spread[cells] = weights @ depths, np.ptp(depths, axis=0)
        return replace(self, mean=mean, spread=spread)

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


def _offset(depth: NDArray[np.float32], volume: float) -> float:
    """Offset the whole surface, in place, where the solids do not differ enough for their mean to have the volume.

    Returns the offset in cells.
    """
    offset = 0.0
    for _ in range(_OFFSETS):
        enclosed, area = _enclosed(depth, offset)
        missing = volume - enclosed
        if abs(missing) <= _MISSING * volume:
            break
        offset += float(np.clip(missing / max(area, 1), -1.0, 1.0))
    depth += np.float32(offset)
    return offset


def _enclosed(depth: NDArray[np.float32], offset: float) -> tuple[float, int]:
    """Return the volume of a solid whose surface is offset, and the number of cells at the surface."""
    volume, area = 0.0, 0
    for slab in slabs(depth.shape):
        moved = depth[slab] + np.float32(offset)
        area += np.count_nonzero((moved < 0.5) & (moved > -0.5))
        volume += _volume(moved)
    return volume, area


def _volume(depth: NDArray[np.floating]) -> float:
    filled = depth + np.float32(0.5)
    return float(np.clip(filled, 0.0, 1.0, out=filled).sum(dtype=np.float64))
