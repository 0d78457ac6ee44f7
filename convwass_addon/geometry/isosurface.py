# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""From a density on a grid to a closed surface, at a level chosen by value or by the volume it encloses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skimage.measure import marching_cubes

from ..errors import InputError
from .mesh import TriangleMesh

# The volume of the surface follows the wanted one to this fraction.
_VOLUME_TOLERANCE = 2e-3
# Steps of the search for it: of the estimate, which needs no surface; with the estimate corrected by what a surface
# showed; by counting cells; and by halving, which always gets there.
_ESTIMATED = 3
_CORRECTED = 2
_COUNTED = 8
_BISECTED = 40
# Vertices keep this share of a grid edge away from its ends. Coordinates come as float32, to 6e-5 in 1024 cells.
_CLEARANCE = 2.5e-4
# Cells inside count for this much more. Where their values mirror those outside, the topology would be left to
# rounding, and neighboring cubes would decide it differently.
_ASYMMETRY = 1e-5


@dataclass(frozen=True)
class LevelSurface:
    """A surface and the level it was taken at.

    Attributes
    ----------
    mesh : TriangleMesh
        In cells: voxel (i, j, k) is the unit cube whose low corner is (i, j, k). Closed, outward.
    level : float
        Density on the surface.
    """

    mesh: TriangleMesh
    level: float


def surface_at_level(density: NDArray[np.floating], level: float) -> LevelSurface:
    """Surface of the set where `density`, (nx, ny, nz), exceeds `level`: marching cubes (Lewiner et al. 2003).

    The grid counts as surrounded by zeros, so the surface is closed even where the set touches the walls.

    Raises
    ------
    InputError
        No cell, or every value, lies above the level.
    """
    density = as_floats(density)
    if not 0.0 < level < float(density.max()):
        raise InputError(
            "No surface at level {level:.4g}: the densities lie between 0 and {largest:.4g}.",
            level=level,
            largest=float(density.max()),
        )
    low, high = bounding_box(density > level)
    # One more cell on every side belongs to the surface's cubes; beyond the grid it is zero.
    box = np.zeros(high - low + 2, density.dtype)
    source = tuple(slice(max(a - 1, 0), min(b + 1, n)) for a, b, n in zip(low, high, density.shape, strict=True))
    offset = np.array([s.start for s in source]) - (low - 1)
    target = tuple(slice(o, o + s.stop - s.start) for o, s in zip(offset, source, strict=True))
    box[target] = density[source]
    vertices, faces, _, _ = marching_cubes(_excess(box, level), 0.0, gradient_direction="ascent")
    # Marching cubes works on samples at integer coordinates; a sample is the center of its cell.
    return LevelSurface(TriangleMesh.from_arrays(vertices + (low - 1) + 0.5, faces), level)


def surface_enclosing(density: NDArray[np.floating], volume: float, shortfall: float | None = None) -> LevelSurface:
    """Surface of a level of `density` that encloses `volume` cells, as measured on the surface itself.

    The level is estimated, and estimated again with what the surface showed. Where many cells have one value that does
    not lead there, a corrected number of cells is counted, and then the level itself is bisected. Where the enclosed
    volume jumps past the wanted one, the nearest that was found is returned.

    Parameters
    ----------
    density : (nx, ny, nz)
        Not negative.
    volume : float
        In cells.
    shortfall : float, optional
        The :func:`estimate_shortfall` of a density that differs little, which saves drawing a surface for it.

    Raises
    ------
    InputError
        The volume is not between zero and that of the grid.
    """
    density = as_floats(density)
    ranks = _Ranks.of(density, volume)
    too_full, too_empty = 0.0, ranks.highest
    aim = volume + (shortfall or 0.0)
    level = _estimated(density, aim, ranks)
    count, nearest = 0.0, None
    for step in range(_CORRECTED + _COUNTED + _BISECTED):
        if step >= _CORRECTED + _COUNTED or not too_full < level < too_empty:
            level = (too_full + too_empty) / 2
        surface = surface_at_level(density, level)
        excess = surface.mesh.volume - volume
        if nearest is None or abs(excess) < abs(nearest.mesh.volume - volume):
            nearest = surface
        too_full, too_empty = (level, too_empty) if excess > 0 else (too_full, level)
        # Marching cubes works on float32, which tells no levels apart that are closer.
        jumps = too_empty - too_full <= np.finfo(np.float32).eps * too_empty
        if jumps or abs(excess) <= _VOLUME_TOLERANCE * volume:
            break
        aim -= excess
        if step < _CORRECTED:
            level = _estimated(density, aim, ranks)
        else:
            count = ranks.nearest((ranks.above(level) if step == _CORRECTED else count) - excess)
            level = ranks.level(count)
    return nearest


def level_enclosing(density: NDArray[np.floating], volume: float, shortfall: float = 0.0) -> float:
    """Estimate the level of a density, (nx, ny, nz), that :func:`surface_enclosing` looks for; errors are the same."""
    density = as_floats(density)
    return _estimated(density, volume + shortfall, _Ranks.of(density, volume))


def estimate_shortfall(density: NDArray[np.floating], volume: float) -> float:
    """Volume that the surface at the estimated level lacks, since triangles cut corners; zero where it does not matter.

    Raises
    ------
    InputError
        As :func:`surface_enclosing` does.
    """
    shortfall = volume - surface_at_level(density, level_enclosing(density, volume)).mesh.volume
    return shortfall if abs(shortfall) > _VOLUME_TOLERANCE * volume else 0.0


def as_floats(density: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return a density of any shape in the precision that it has, float32 or float64."""
    density = np.asarray(density)
    return density if density.dtype == np.float32 else density.astype(np.float64, copy=False)


@dataclass(frozen=True)
class _Ranks:
    """The levels that leave 0, 1, ... cells above them.

    Attributes
    ----------
    levels : (n + 1,)
        The last one leaves all cells that hold anything.
    """

    levels: NDArray[np.floating]

    @classmethod
    def of(cls, density: NDArray[np.floating], volume: float) -> _Ranks:
        positive = density[density > 0]
        if not 0.0 < volume < len(positive):
            raise InputError(
                "A surface cannot enclose {volume:.4g} of the {cells} cells that hold any mass.",
                volume=volume,
                cells=len(positive),
            )
        positive.sort()
        return cls(np.append(positive[::-1], positive.dtype.type(0.0)))

    @property
    def highest(self) -> float:
        return float(self.levels[0])

    def above(self, level: float) -> float:
        """Return how many cells are above a level, at least the first half and at most all but the last."""
        return self.nearest(float(len(self.levels) - np.searchsorted(self.levels[::-1], level, side="right")))

    def nearest(self, count: float) -> float:
        return float(np.clip(count, 0.5, len(self.levels) - 0.5))

    def level(self, count: float) -> float:
        """Return the level for a number of cells, interpolated: half of its cell counts where a level is its own."""
        place = min(max(count - 0.5, 0.0), len(self.levels) - 1.0)
        index = min(int(place), len(self.levels) - 2)
        lower, upper = float(self.levels[index]), float(self.levels[index + 1])
        return lower + (upper - lower) * (place - index)


def _estimated(density: NDArray[np.floating], volume: float, ranks: _Ranks) -> float:
    """Find a level by volumes that need no surface: the mean of the lengths of all grid lines inside, axis by axis."""
    around = np.pad(density, 1)
    cells = around.ravel()
    count = ranks.nearest(volume)
    for _ in range(_ESTIMATED):
        level = ranks.level(count)
        inside = cells > level
        # Lines end in the zeros around, so that what comes next in memory is apart.
        beyond = sum(_beyond_centers(cells, inside, stride // around.itemsize, level) for stride in around.strides)
        enclosed = np.count_nonzero(inside) + beyond / 3.0
        count = ranks.nearest(count + volume - enclosed)
    return ranks.level(count)


def _beyond_centers(cells: NDArray[np.floating], inside: NDArray[np.bool_], stride: int, level: float) -> float:
    """Sum up by how much more than half a cell the lines along an axis go on from the last centers inside."""
    ends = np.flatnonzero(inside[:-stride] != inside[stride:])
    first, second = cells[ends], cells[ends + stride]
    highest = np.maximum(first, second)
    return float(((highest - level) / np.abs(first - second) - 0.5).sum(dtype=np.float64))


def _excess(density: NDArray[np.floating], level: float) -> NDArray[np.float32]:
    """By which share of `level` the density exceeds it, changed slightly so that every vertex has its own place.

    A sample at the level would draw the vertices of all its grid edges onto itself. It is therefore kept from zero, by
    `_CLEARANCE` of the largest value on the other side of the surface next to it.
    """
    # Beyond the grid there is nothing, so no excess outside is below -1, and none inside need be above this.
    most = 1.0 / _CLEARANCE
    excess = ((np.minimum(density, level * most) - level) / level).astype(np.float32)
    is_inside = excess > 0.0
    inside = np.where(is_inside, np.maximum(excess, _CLEARANCE) * (1.0 + _ASYMMETRY), 0.0)
    highest = np.ones_like(inside)
    for axis in range(3):
        for shift in (-1, 1):
            np.maximum(highest, np.roll(inside, shift, axis), out=highest)
    return np.where(is_inside, inside, np.minimum(excess, -_CLEARANCE * highest))


def bounding_box(inside: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first cell along each axis, (3,), and the one after the last, (3,), of those that are True."""
    spans = []
    for axis in range(3):
        along = np.flatnonzero(inside.any(axis=tuple(a for a in range(3) if a != axis)))
        spans.append((along[0], along[-1] + 1))
    low, high = np.array(spans).T
    return low, high
