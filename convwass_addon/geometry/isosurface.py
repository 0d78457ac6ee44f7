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
# Steps of the search for it: first by counting cells, which is quick, then by halving, which always gets there.
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
    density = np.asarray(density, dtype=np.float64)
    if not 0.0 < level < float(density.max()):
        raise InputError(
            f"No surface at level {level:.4g}: the densities lie between 0 and {float(density.max()):.4g}."
        )
    low, high = bounding_box(density > level)
    # One more cell on every side belongs to the surface's cubes; beyond the grid it is zero.
    box = np.zeros(high - low + 2)
    source = tuple(slice(max(a - 1, 0), min(b + 1, n)) for a, b, n in zip(low, high, density.shape, strict=True))
    offset = np.array([s.start for s in source]) - (low - 1)
    target = tuple(slice(o, o + s.stop - s.start) for o, s in zip(offset, source, strict=True))
    box[target] = density[source]
    vertices, faces, _, _ = marching_cubes(_excess(box, level), 0.0, gradient_direction="ascent")
    # Marching cubes works on samples at integer coordinates; a sample is the center of its cell.
    return LevelSurface(TriangleMesh.from_arrays(vertices + (low - 1) + 0.5, faces), level)


def surface_enclosing(density: NDArray[np.floating], volume: float, near: float | None = None) -> LevelSurface:
    """Surface of a level of `density` that encloses `volume` cells, as measured on the surface itself.

    Counting cells gives the level to about a cell's width; the remaining difference is taken out by counting a
    corrected number. Where many cells have one value that does not lead there, and the level itself is bisected. Where
    the enclosed volume jumps past the wanted one, the nearest that was found is returned.

    Parameters
    ----------
    density : (nx, ny, nz)
        Not negative.
    volume : float
        In cells.
    near : float, optional
        A level to try first, such as that of a density that differs little.

    Raises
    ------
    InputError
        The volume is not between zero and that of the grid.
    """
    density = np.asarray(density, dtype=np.float64)
    positive = int((density > 0).sum())
    if not 0.0 < volume < positive:
        raise InputError(f"A surface cannot enclose {volume:.4g} of the {positive} cells that hold any mass.")
    # The level that leaves n cells above it, by n; the last one leaves all of them.
    levels = np.append(np.sort(density[density > 0], axis=None)[::-1], 0.0)
    counts = np.arange(positive + 1) + 0.5
    too_full, too_empty = 0.0, float(levels[0])
    count = volume if near is None else float(np.clip((density > near).sum(), counts[0], counts[-1]))
    nearest = None
    for step in range(_COUNTED + _BISECTED):
        level = float(np.interp(count, counts, levels))
        if step >= _COUNTED or not too_full < level < too_empty:
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
        count = float(np.clip(count - excess, counts[0], counts[-1]))
    return nearest


def euler_number_within(window: NDArray[np.float64], level: float) -> float:
    """Vertices - triangles / 2 of the surface at a level within a part of a grid, cut open at the part's walls.

    What changes inside the part changes this as it changes the surface's Euler number: the edges inside are three
    halves of the triangles, and those at the walls stay.
    """
    if not float(window.min()) < level < float(window.max()):
        return 0.0
    vertices, faces, _, _ = marching_cubes((window / level - 1.0).astype(np.float32), 0.0)
    return len(vertices) - len(faces) / 2.0


def _excess(density: NDArray[np.float64], level: float) -> NDArray[np.float32]:
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
