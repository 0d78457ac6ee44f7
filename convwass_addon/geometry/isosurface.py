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
# Rounds of correcting the count of cells, then of halving the interval of levels.
_COUNTED = 8
_BISECTED = 24
# Marching cubes computes in float32: a vertex nearer than this share of the level to a corner may come to lie on it.
_CLEARANCE = 1e-3


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
    if not 0.0 < level < float(density.max()):
        raise InputError(
            f"No surface at level {level:.4g}: the densities lie between 0 and {float(density.max()):.4g}."
        )
    inside = density > level
    low, high = _bounding_box(inside)
    # One more cell on every side belongs to the surface's cubes; beyond the grid it is zero.
    box = np.zeros(high - low + 2, dtype=np.float64)
    source = tuple(slice(max(a - 1, 0), min(b + 1, n)) for a, b, n in zip(low, high, density.shape, strict=True))
    offset = np.array([s.start for s in source]) - (low - 1)
    target = tuple(slice(o, o + s.stop - s.start) for o, s in zip(offset, source, strict=True))
    box[target] = density[source]
    # A value of exactly the level would put vertices of different edges on one point.
    box[(box <= level) & (box > level * (1.0 - _CLEARANCE))] = level * (1.0 - _CLEARANCE)
    box[(box > level) & (box < level * (1.0 + _CLEARANCE))] = level * (1.0 + _CLEARANCE)
    vertices, faces, _, _ = marching_cubes(box, level, gradient_direction="ascent", allow_degenerate=False)
    # Marching cubes works on samples at integer coordinates; a sample is the center of its cell.
    return LevelSurface(TriangleMesh.from_arrays(vertices + (low - 1) + 0.5, faces), level)


def surface_enclosing(density: NDArray[np.floating], volume: float) -> LevelSurface:
    """Surface of a level of `density` that encloses `volume` cells, as measured on the surface itself.

    Counting cells gives the level to about a cell's width; the remaining difference is taken out by counting a
    corrected number. Where many cells have one value that does not lead there, and the level itself is bisected. Where
    the enclosed volume jumps past the wanted one, the nearest that was found is returned.

    Raises
    ------
    InputError
        The volume is not between zero and that of the grid.
    """
    positive = int((density > 0).sum())
    if not 0.0 < volume < positive:
        raise InputError(f"A surface cannot enclose {volume:.4g} of the {positive} cells that hold any mass.")
    values = np.sort(density[density > 0], axis=None)[::-1].astype(np.float64)
    count, too_full, too_empty = volume, 0.0, float(values[0])
    nearest, error = None, np.inf
    for correction in range(_COUNTED + _BISECTED):
        level = float(np.interp(count - 0.5, np.arange(positive), values))
        if correction >= _COUNTED or not too_full < level < too_empty:
            level = (too_full + too_empty) / 2
        surface = surface_at_level(density, level)
        excess = surface.mesh.volume - volume
        if abs(excess) < error:
            nearest, error = surface, abs(excess)
        if error <= _VOLUME_TOLERANCE * volume:
            break
        too_full, too_empty = (level, too_empty) if excess > 0 else (too_full, level)
        count = float(np.clip(count - excess, 0.5, positive - 0.5))
    return nearest


def _bounding_box(inside: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    spans = []
    for axis in range(3):
        along = np.flatnonzero(inside.any(axis=tuple(a for a in range(3) if a != axis)))
        spans.append((along[0], along[-1] + 1))
    low, high = np.array(spans).T
    return low, high
