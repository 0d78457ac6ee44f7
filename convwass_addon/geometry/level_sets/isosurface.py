# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed isosurfaces of a density on a grid, at a given level or enclosing a given volume."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skimage.measure import marching_cubes

from ...errors import InputError
from ..grids.boxes import padded_box
from ..meshes.mesh import TriangleMesh

# Relative tolerance of the enclosed volume.
_VOLUME_TOLERANCE = 2e-3
# Steps of the search for the level: refinements of the estimate, which needs no surface; estimates corrected by the
# volume of a surface; corrections of a cell count; and bisection, which always converges.
_ESTIMATED = 3
_CORRECTED = 2
_COUNTED = 8
_BISECTED = 40
# Least distance of a vertex from the ends of its grid edge. Coordinates are float32, accurate to 6e-5 in 1024 cells.
_CLEARANCE = 2.5e-4
# Relative increase of values inside. Where values inside and outside are symmetric, rounding would decide the topology,
# possibly differently in neighboring cubes.
_ASYMMETRY = 1e-5


@dataclass(frozen=True)
class LevelSurface:
    """A surface and its level.

    Attributes
    ----------
    mesh : TriangleMesh
        In cells: voxel (i, j, k) is the unit cube whose lower corner is (i, j, k). Closed, oriented outward.
    level : float
        Density on the surface.
    """

    mesh: TriangleMesh
    level: float


def surface_at_level(density: NDArray[np.floating], level: float) -> LevelSurface:
    """Isosurface of `density`, (nx, ny, nz), at `level`: marching cubes (Lewiner et al. 2003).

    The density is zero outside the grid, so the surface is closed even where it reaches the boundary.

    Raises
    ------
    InputError
        No value lies above the level, or the level is not positive.
    """
    density = as_floats(density)
    if not 0.0 < level < float(density.max()):
        raise InputError(
            "No surface at level {level:.4g}: the densities lie between 0 and {largest:.4g}.",
            level=level,
            largest=float(density.max()),
        )
    # The surface extends one cell further on every side.
    box, low = padded_box(density, density > level, 1, 0.0)
    vertices, faces, _, _ = marching_cubes(_excess(box, level), 0.0, gradient_direction="ascent")
    # Marching cubes places samples at integer coordinates; here a sample is the center of its cell.
    return LevelSurface(TriangleMesh.from_arrays(vertices + low + 0.5, faces), level)


def surface_enclosing(density: NDArray[np.floating], volume: float, shortfall: float | None = None) -> LevelSurface:
    """Isosurface of `density` that encloses `volume` cells, as measured on the surface itself.

    The level is estimated, and estimated again with corrections from the surface. Where this fails because many cells
    have the same value, a corrected cell count is used, and finally bisection. If the enclosed volume jumps past the
    target, the closest surface found is returned.

    Parameters
    ----------
    density : (nx, ny, nz)
        Nonnegative.
    volume : float
        In cells.
    shortfall : float, optional
        The shortfall of the :class:`EstimatedSurface` of a similar density, which saves one surface extraction.

    Raises
    ------
    InputError
        The volume is not between zero and the number of cells that have mass.
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
        # Marching cubes computes in float32 and cannot resolve closer levels.
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
    """Estimate the level that :func:`surface_enclosing` finds in a density, (nx, ny, nz); raises the same errors."""
    density = as_floats(density)
    return _estimated(density, volume + shortfall, _Ranks.of(density, volume))


@dataclass(frozen=True)
class EstimatedSurface:
    """The surface at the level that :func:`level_enclosing` estimates without a shortfall.

    Attributes
    ----------
    surface : LevelSurface
    shortfall : float
        Volume missing from it, since triangles cut corners; zero if negligible. Then it is the surface of
        :func:`surface_enclosing`.
    """

    surface: LevelSurface
    shortfall: float

    @classmethod
    def of(cls, density: NDArray[np.floating], volume: float) -> EstimatedSurface:
        """Extract the surface; raises the same errors as :func:`surface_enclosing`."""
        surface = surface_at_level(density, level_enclosing(density, volume))
        shortfall = volume - surface.mesh.volume
        return cls(surface, shortfall if abs(shortfall) > _VOLUME_TOLERANCE * volume else 0.0)


def as_floats(density: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return a density of any shape as float32 if that is its type, otherwise as float64."""
    density = np.asarray(density)
    return density if density.dtype == np.float32 else density.astype(np.float64, copy=False)


@dataclass(frozen=True)
class _Ranks:
    """The levels with 0, 1, ... cells above them.

    Attributes
    ----------
    levels : (n + 1,)
        The last level is below all positive cells.
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
        """Return the number of cells above a level, at least one half."""
        return self.nearest(float(len(self.levels) - np.searchsorted(self.levels[::-1], level, side="right")))

    def nearest(self, count: float) -> float:
        return float(np.clip(count, 0.5, len(self.levels) - 0.5))

    def level(self, count: float) -> float:
        """Return the interpolated level for a number of cells; a cell at the level counts half."""
        place = min(max(count - 0.5, 0.0), len(self.levels) - 1.0)
        index = min(int(place), len(self.levels) - 2)
        lower, upper = float(self.levels[index]), float(self.levels[index + 1])
        return lower + (upper - lower) * (place - index)


def _estimated(density: NDArray[np.floating], volume: float, ranks: _Ranks) -> float:
    """Estimate the level without a surface, from the lengths of grid lines inside, averaged over the axes."""
    around = np.pad(density, 1)
    cells = around.ravel()
    count = ranks.nearest(volume)
    for _ in range(_ESTIMATED):
        level = ranks.level(count)
        inside = cells > level
        # Zero padding ends every line, so that cells adjacent only in memory do not count.
        beyond = sum(_beyond_centers(cells, inside, stride // around.itemsize, level) for stride in around.strides)
        enclosed = np.count_nonzero(inside) + beyond / 3.0
        count = ranks.nearest(count + volume - enclosed)
    return ranks.level(count)


def _beyond_centers(cells: NDArray[np.floating], inside: NDArray[np.bool_], stride: int, level: float) -> float:
    """Sum up by how much more than half a cell the lines along an axis extend beyond the last centers inside."""
    ends = np.flatnonzero(inside[:-stride] != inside[stride:])
    first, second = cells[ends], cells[ends + stride]
    highest = np.maximum(first, second)
    return float(((highest - level) / np.abs(first - second) - 0.5).sum(dtype=np.float64))


def _excess(density: NDArray[np.floating], level: float) -> NDArray[np.float32]:
    """Excess of the density over `level`, relative to `level`, adjusted so that no two vertices coincide.

    The memory of the density is used for other values.

    A sample exactly at the level would pull the vertices of all its grid edges onto itself. Values are therefore kept
    away from zero, by `_CLEARANCE` times the largest value on the other side of the surface next to them.
    """
    # The excess outside is at least -1, so inside no more than this is needed.
    most = 1.0 / _CLEARANCE
    excess = np.minimum(density, level * most, out=density)
    excess -= level
    excess /= level
    excess = excess.astype(np.float32, copy=False)
    is_inside = excess > 0.0
    inside = np.maximum(excess, np.float32(_CLEARANCE))
    inside *= np.float32(1.0 + _ASYMMETRY)
    inside[~is_inside] = 0.0
    highest = np.ones_like(inside)
    for axis in range(3):
        lower, upper = ((slice(None),) * axis + (part,) for part in (slice(None, -1), slice(1, None)))
        np.maximum(highest[lower], inside[upper], out=highest[lower])
        np.maximum(highest[upper], inside[lower], out=highest[upper])
    highest *= np.float32(-_CLEARANCE)
    np.minimum(excess, highest, out=highest)
    np.copyto(highest, inside, where=is_inside)
    return highest
