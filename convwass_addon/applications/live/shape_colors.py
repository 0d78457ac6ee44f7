# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors of shapes near points, from samples spread over their surfaces: fast, and no finer than color fields need."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.meshes.spread_points import spread_points
from ..morphs.appearance import Appearance
from ..motions.motion import MovedShape

# Number of samples of a shape: several per coarse cell on the surface of a shape of 64 cells.
_SAMPLES = 8000
# The color near a point is the mean of this many samples.
_NEIGHBORS = 4


@dataclass(frozen=True)
class ShapeColors:
    """Samples of the colors of a shape.

    Attributes
    ----------
    points : (s, 3) float64
        In scene space.
    colors : (s, 3) float32
        RGB, scene linear.
    """

    points: NDArray[np.float64]
    colors: NDArray[np.float32]

    @classmethod
    def of(cls, appearance: Appearance) -> ShapeColors:
        """Sample a shape at rest."""
        places = spread_points(appearance.corners, _SAMPLES)
        return cls(places.interpolated(appearance.corners), appearance.seen(places).colors[:, :3])

    def moved(self, shape: MovedShape) -> ShapeColors:
        """Return the samples on the moved shape."""
        corners = shape.rest.corners
        places = spread_points(corners, _SAMPLES)
        return ShapeColors(places.interpolated(shape.mesh.corners), self.near(places.interpolated(corners)))

    def near(self, points: NDArray[np.floating]) -> NDArray[np.float32]:
        """Return the colors near some points, (n, 3) each."""
        if (self.colors == self.colors[0]).all():
            return np.tile(self.colors[0], (len(points), 1))
        nearest = cKDTree(self.points).query(points, _NEIGHBORS)[1]
        return self.colors[nearest].mean(axis=1)
