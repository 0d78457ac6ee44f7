# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep a level set within a distance of another surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from .near import capped_distances
from .occupancy import occupancy

# Deviation, in cells, of the Gaussian that smooths the distances, which are computed from whole cells.
_SMOOTH = 1.0
# Decrease of the bounding density per cell, and its largest value deep inside, both as fractions of the level.
_SLOPE, _HIGHEST = 0.5, 1.5
# Distances are measured so many cells beyond the reach: to where the bounding density is zero, and two deviations more.
_BEYOND = 1.0 / _SLOPE + 2.0 * _SMOOTH


@dataclass(frozen=True)
class SurfaceBounds:
    """Limits of the distance between a level set and a surface.

    Attributes
    ----------
    distances : (nx, ny, nz) float32
        Signed distances of the cells from the surface, in cells, negative inside; limited to a little more than
        `reach`.
    reach : float
        Largest distance, in cells.
    """

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
            return cls(np.zeros(shape, np.float32), np.inf)
        outward, inward = (capped_distances(cells, reach + _BEYOND) for cells in (inside, ~inside))
        return cls(gaussian_filter(np.where(inside, -inward, outward), _SMOOTH), reach)

    def limited(
        self, density: NDArray[np.floating], level: float, box: tuple[slice, ...] | None = None
    ) -> NDArray[np.floating]:
        """Return a density whose level set at `level` stays within reach of the surface.

        Parameters
        ----------
        density : (mx, my, mz)
            Nonnegative.
        level : float
            Level of the surface.
        box : tuple of slice, optional
            Part of the grid that the density covers.
        """
        distances = self.distances if box is None else self.distances[box]
        least, most = (level * np.maximum(1.0 - _SLOPE * (distances + side * self.reach), 0.0) for side in (1.0, -1.0))
        return np.clip(density, np.minimum(least, _HIGHEST * level), most).astype(density.dtype)
