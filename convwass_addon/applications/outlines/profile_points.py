# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of half a section of a solid of revolution, which move with both halves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.closest_points import ClosestPointFinder
from ...geometry.meshes.mesh import TriangleMesh
from .sheets import AttachedPoints

# The mirror image of a section about the axis.
_MIRROR = (-1.0, 1.0)


@dataclass(frozen=True)
class ProfilePoints:
    """Points given by their distance from the axis and their place along it.

    Attributes
    ----------
    sides : AttachedPoints
        The points on one side of the axis, and then their mirror images.
    """

    sides: AttachedPoints

    @classmethod
    def of(cls, points: NDArray[np.float64], section: TriangleMesh) -> ProfilePoints:
        """Attach points, (n, 2), to the triangles of a section in the plane z = 0."""
        finder = ClosestPointFinder(section.corners)
        return cls(AttachedPoints.of(np.concatenate([points, points * _MIRROR]), section, finder))

    def on(self, moved: TriangleMesh) -> NDArray[np.float64]:
        """Return the points, (n, 2), on a moved section: the means of both sides."""
        right, mirrored = self._both(moved)
        return 0.5 * (right + mirrored)

    def asymmetry(self, moved: TriangleMesh) -> float:
        """Return the largest distance between a point of a moved section and the mirror image of its counterpart."""
        right, mirrored = self._both(moved)
        return float(np.linalg.norm(right - mirrored, axis=1).max())

    def _both(self, moved: TriangleMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        right, left = np.split(self.sides.on(moved), 2)
        return right, left * _MIRROR
