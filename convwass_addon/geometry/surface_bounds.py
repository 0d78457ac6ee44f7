# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep a level set within a distance of another surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, gaussian_filter

from .isosurface import bounding_box
from .occupancy import occupancy

# Distances are told from whole cells, and smoothed by so many.
_SMOOTH = 1.0
# By how much of the level the density that bounds it falls in a cell, and how far it is raised deep inside.
_SLOPE, _HIGHEST = 0.5, 1.5


@dataclass(frozen=True)
class SurfaceBounds:
    """How far a level set may be from a surface.

    Attributes
    ----------
    distances : (nx, ny, nz) float32
        Signed distances of the cells from the surface, in cells, negative inside of it.
    reach : float
        How far it may be, in cells.
    """

    distances: NDArray[np.float32]
    reach: float

    @classmethod
    def of(cls, corners: NDArray[np.float64], shape: tuple[int, int, int], reach: float) -> SurfaceBounds:
        """Measure the distances from a closed outward surface, (m, 3, 3) in cells, on a grid.

        What lies outside the grid is left out.
        """
        inside = occupancy(corners, shape) > 0.5
        distances = np.full(shape, np.float32(max(shape)))
        if inside.any():
            # Cell centers are half a cell from the faces that they share with the other side.
            outward = distance_transform_edt(~inside).astype(np.float32) - 0.5
            low, high = bounding_box(inside)
            box = tuple(slice(max(a - 1, 0), b + 1) for a, b in zip(low, high, strict=True))
            inward = distance_transform_edt(np.pad(inside[box], 1))[1:-1, 1:-1, 1:-1].astype(np.float32) - 0.5
            distances = outward
            distances[box] = np.where(inside[box], -inward, outward[box])
        return cls(gaussian_filter(distances, _SMOOTH), reach)

    def limited(
        self, density: NDArray[np.floating], level: float, box: tuple[slice, ...] | None = None
    ) -> NDArray[np.floating]:
        """Return a density whose level set at `level` is within reach.

        Parameters
        ----------
        density : (mx, my, mz)
            Not negative.
        level : float
            Of the surface.
        box : tuple of slice, optional
            Where on the grid the density is.
        """
        distances = self.distances if box is None else self.distances[box]
        least, most = (level * np.maximum(1.0 - _SLOPE * (distances + side * self.reach), 0.0) for side in (1.0, -1.0))
        return np.clip(density, np.minimum(least, _HIGHEST * level), most).astype(density.dtype)
