# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep a level set within a distance of another surface."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ..grids.boxes import Box, box_around
from ..grids.near import capped_distances
from ..meshes.closest_points import ClosestPointFinder
from .occupancy import occupancy

# Deviation, in cells, of the Gaussian that smooths the distances, which are computed from whole cells.
_SMOOTH = 1.0
# Decrease of the bounding density per cell, and its largest value deep inside, both as fractions of the level.
_SLOPE, _HIGHEST = 0.5, 1.5
# Distances are measured so many cells beyond the reach: to where the bounding density is zero, and two deviations more.
_BEYOND = 1.0 / _SLOPE + 2.0 * _SMOOTH
# Smoothed distances of whole cells are at most about this wrong, in cells; most at tips, which they blunt.
_ERROR = 0.7
# A level set that moves by more than this many cells along a line between two centers has changed.
_MOVED = 0.25


@dataclass(frozen=True)
class SurfaceBounds:
    """Limits of the distance between a level set and a surface.

    Attributes
    ----------
    corners : (m, 3, 3) float64
        Triangles of the surface, in cells.
    distances : (nx, ny, nz) float32
        Approximate signed distances of the cells from the surface, in cells, negative inside; limited to a little more
        than `reach`.
    reach : float
        Largest distance, in cells.
    """

    corners: NDArray[np.float64]
    distances: NDArray[np.float32]
    reach: float

    @classmethod
    def of(cls, corners: NDArray[np.float64], shape: tuple[int, int, int], reach: float) -> SurfaceBounds:
        """Measure the distances from a closed outward surface, (m, 3, 3) in cells, on a grid.

        Parts outside the grid are ignored; a surface that encloses nothing inside the grid sets no limits.
        """
        # Flattened onto the boundary, parts outside enclose nothing.
        inside = occupancy(np.clip(corners, 1.0, np.array(shape) - 1.0), shape) > 0.5
        if not inside.any():
            return cls(corners, np.zeros(shape, np.float32), np.inf)
        outward, inward = (capped_distances(cells, reach + _BEYOND) for cells in (inside, ~inside))
        return cls(corners, gaussian_filter(np.where(inside, -inward, outward), _SMOOTH), reach)

    def limited(self, density: NDArray[np.floating], level: float, box: Box | None = None) -> NDArray[np.floating]:
        """Return a density whose level set at `level` stays within reach of the surface.

        Parameters
        ----------
        density : (mx, my, mz)
            Nonnegative.
        level : float
            Level of the surface.
        box : Box, optional
            Part of the grid that the density covers.
        """
        distances = self.distances if box is None else self.distances[box]
        corner = np.zeros(3) if box is None else np.array([side.start for side in box])
        result = density.copy()
        cells = np.nonzero(_clipped(density, distances, level, self.reach - _ERROR) != density)
        if len(cells[0]):
            points = np.stack(cells, axis=1) + (corner + 0.5)
            exact = np.copysign(self._finder.find_about(points).distances, distances[cells])
            result[cells] = _clipped(density[cells], exact, level, self.reach)
        return result

    @cached_property
    def _finder(self) -> ClosestPointFinder:
        return ClosestPointFinder(self.corners)


def cells_changed(before: NDArray[np.floating], after: NDArray[np.floating], level: float) -> int:
    """Count the cells that are on another side of a level set, or beside which it has moved; two (nx, ny, nz)."""
    different = before != after
    if not different.any():
        return 0
    box = box_around(different, 1)
    before, after = before[box] - level, after[box] - level
    changed = (before > 0.0) != (after > 0.0)
    for axis in range(before.ndim):
        along, old, new = (np.moveaxis(values, axis, 0) for values in (changed, before, after))
        crossed = ((old[:-1] > 0.0) != (old[1:] > 0.0)) & ((new[:-1] > 0.0) != (new[1:] > 0.0))
        places = [values[:-1][crossed] / (values[:-1][crossed] - values[1:][crossed]) for values in (old, new)]
        along[:-1][crossed] |= np.abs(places[1] - places[0]) > _MOVED
    return int(np.count_nonzero(changed))


def _clipped(
    density: NDArray[np.floating], distances: NDArray[np.floating], level: float, reach: float
) -> NDArray[np.floating]:
    """Bound the densities of cells by what their signed distances from the surface allow."""
    least, most = (level * np.maximum(1.0 - _SLOPE * (distances + side * reach), 0.0) for side in (1.0, -1.0))
    return np.clip(density, np.minimum(least, _HIGHEST * level), most).astype(density.dtype)
