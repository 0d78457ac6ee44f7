# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the points of outlines nearest to others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .closest_points import ClosestPointFinder
from .planar_fill import Boundary


class OutlineFinder:
    """Finds the points of an outline nearest to others of the plane.

    Parameters
    ----------
    outline : Boundary
        The outline, or some of its edges.
    """

    def __init__(self, outline: Boundary) -> None:
        # Edges are degenerate triangles in the plane z = 0.
        corners = np.stack([outline.starts, outline.ends, outline.ends], axis=1)
        self.outline = outline
        self._edges = np.pad(corners, ((0, 0), (0, 0), (0, 1)))
        self._finder = ClosestPointFinder(self._edges)

    def nearest(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the points of the outline nearest to others, (n, 2)."""
        return self._finder.find(np.pad(points, ((0, 0), (0, 1)))).interpolated(self._edges)[:, :2]

    def distances(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distances of points, (n, 2), from the outline, (n,)."""
        return np.linalg.norm(self.nearest(points) - points, axis=1)
