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
_CORRECTIONS = 16


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
    # A value of exactly the level would put vertices of different edges on one point.
    level = float(level) * (1.0 + 1e-7)
    inside = density > level
    low, high = _bounding_box(inside)
    # One more cell on every side belongs to the surface's cubes; beyond the grid it is zero.
    box = np.zeros(high - low + 2, dtype=np.float64)
    source = tuple(slice(max(a - 1, 0), min(b + 1, n)) for a, b, n in zip(low, high, density.shape, strict=True))
    offset = np.array([s.start for s in source]) - (low - 1)
    target = tuple(slice(o, o + s.stop - s.start) for o, s in zip(offset, source, strict=True))
    box[target] = density[source]
    vertices, faces, _, _ = marching_cubes(box, level, gradient_direction="ascent", allow_degenerate=False)
    # Marching cubes works on samples at integer coordinates; a sample is the center of its cell.
    return LevelSurface(TriangleMesh.from_arrays(vertices + (low - 1) + 0.5, faces), level)


def surface_enclosing(density: NDArray[np.floating], volume: float) -> LevelSurface:
    """Surface of a level of `density` that encloses `volume` cells, as measured on the surface itself.

    Counting cells gives the level to about a cell's width; the remaining difference is taken out by counting a
    corrected number, kept between the counts that enclosed too little and too much.

    Raises
    ------
    InputError
        The volume is not between zero and that of the grid.
    """
    positive = int((density > 0).sum())
    if not 0.0 < volume < positive:
        raise InputError(f"A surface cannot enclose {volume:.4g} of the {positive} cells that hold any mass.")
    values = np.sort(density[density > 0], axis=None)[::-1].astype(np.float64)
    low, count, high = 0.5, volume, positive - 0.5
    for _ in range(_CORRECTIONS):
        surface = surface_at_level(density, float(np.interp(count - 0.5, np.arange(positive), values)))
        excess = surface.mesh.volume - volume
        if abs(excess) <= _VOLUME_TOLERANCE * volume:
            break
        low, high = (low, count) if excess > 0 else (count, high)
        count = count - excess if low < count - excess < high else (low + high) / 2
    return surface


def _bounding_box(inside: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    spans = []
    for axis in range(3):
        along = np.flatnonzero(inside.any(axis=tuple(a for a in range(3) if a != axis)))
        spans.append((along[0], along[-1] + 1))
    low, high = np.array(spans).T
    return low, high
