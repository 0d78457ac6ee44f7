# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments of filled areas of the plane, computed from their boundaries, and consistent boundary orientation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .outlines import ring_area
from .plane_angles import plane_cross
from .ring_nesting import is_within

# If the spreads along the two axes differ by less than this fraction, there is no long axis.
_ROUND = 0.02


@dataclass(frozen=True)
class FlatMoments:
    """Area, center of mass and long axis.

    Attributes
    ----------
    area : float
        The filled area.
    center : (2,) float64
        Center of mass.
    axis : float or None
        Angle of the long axis in radians, pointing to the heavier end (where the third moment along it is negative,
        since the tail is on the other side); None if no axis is longer.
    """

    area: float
    center: NDArray[np.float64]
    axis: float | None

    @classmethod
    def of(cls, starts: NDArray[np.float64], ends: NDArray[np.float64]) -> FlatMoments:
        """Sum the moments of triangles from edges, (e, 2), with the filled side on their left, to a common point."""
        if not len(starts):
            return cls(0.0, np.zeros(2), None)
        middle = starts.mean(axis=0)
        a, b = starts - middle, ends - middle
        doubled = plane_cross(a, b)
        area = 0.5 * float(doubled.sum())
        if area <= 0:
            return cls(0.0, middle, None)
        center = ((a + b) * doubled[:, None]).sum(axis=0) / (6.0 * area)
        a, b = a - center, b - center
        doubled = plane_cross(a, b)
        # Second moments of triangles with one corner at the origin.
        outer = np.einsum("ei,ej->eij", a, a) + np.einsum("ei,ej->eij", b, b)
        outer += 0.5 * (np.einsum("ei,ej->eij", a, b) + np.einsum("ei,ej->eij", b, a))
        spread = np.einsum("e,eij->ij", doubled, outer) / 12.0
        values, directions = np.linalg.eigh(spread)
        if values[1] - values[0] <= _ROUND * values[1]:
            return cls(area, center + middle, None)
        along = directions[:, 1]
        u, v = a @ along, b @ along
        third = float(doubled @ (u**3 + u * u * v + u * v * v + v**3)) / 20.0
        if third > 0:
            along = -along
        return cls(area, center + middle, float(np.arctan2(along[1], along[0])))

    def angle_from(self, other: FlatMoments) -> float:
        """Return the rotation of another shape that aligns its long axis with this one; 0 if either is round."""
        if self.axis is None or other.axis is None:
            return 0.0
        return self.axis - other.axis


def directed(rings: Sequence[NDArray[np.float64]], groups: Sequence[int]) -> tuple[NDArray[np.float64], ...]:
    """Orient closed polygons, (n, 2) each, so that the filled area is where the winding number is not zero.

    The rings of one group are filled together: a ring that lies within an odd number of the others is a hole.
    """
    found = []
    for ring, group in zip(rings, groups, strict=True):
        others = (other for other, own in zip(rings, groups, strict=True) if own == group and other is not ring)
        is_hole = sum(is_within(ring[0], other) for other in others) % 2 == 1
        found.append(ring if (ring_area(ring) < 0) == is_hole else ring[::-1])
    return tuple(found)
