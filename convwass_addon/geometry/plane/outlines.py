# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of flat shapes: regions with holes, bounded by rings that do not cross."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rule = Literal["non-zero", "even-odd"]
"""Fill rule: a point is inside if its winding number is not zero, or if it is odd."""


@dataclass(frozen=True)
class FlatRegion:
    """A connected region.

    Attributes
    ----------
    outer : (n, 2) float64
        Corners of a closed polygon, counterclockwise, without repeating the first.
    holes : tuple of (m, 2) float64
        Like `outer`, clockwise.
    """

    outer: NDArray[np.float64]
    holes: tuple[NDArray[np.float64], ...] = ()

    @property
    def rings(self) -> tuple[NDArray[np.float64], ...]:
        """All rings, the outer one first."""
        return (self.outer, *self.holes)

    def without_holes_below(self, area: float) -> FlatRegion:
        """Return the region with all holes smaller than `area` filled."""
        return FlatRegion(self.outer, tuple(hole for hole in self.holes if -ring_area(hole) >= area))


@dataclass(frozen=True)
class Outline:
    """The regions of a flat shape, the largest first.

    Attributes
    ----------
    regions : tuple of FlatRegion
        Disjoint regions.
    """

    regions: tuple[FlatRegion, ...]

    @property
    def rings(self) -> tuple[NDArray[np.float64], ...]:
        """All rings, each outer one before its holes."""
        return tuple(ring for region in self.regions for ring in region.rings)

    @property
    def points(self) -> NDArray[np.float64]:
        """Corners of all rings in order, (n, 2)."""
        return np.concatenate([np.zeros((0, 2)), *self.rings])

    @property
    def area(self) -> float:
        """The filled area."""
        return float(sum(ring_area(ring) for ring in self.rings))

    @property
    def holes(self) -> int:
        """Number of holes."""
        return sum(len(region.holes) for region in self.regions)

    def moved(self, offset: ArrayLike, factor: float = 1.0) -> Outline:
        """Return the outline scaled and then translated."""
        return self.with_rings([ring * factor + np.asarray(offset) for ring in self.rings])

    def with_rings(self, rings: Sequence[NDArray[np.float64]]) -> Outline:
        """Return an outline with other rings in the same arrangement."""
        given = iter(rings)
        return Outline(
            tuple(FlatRegion(next(given), tuple(next(given) for _ in region.holes)) for region in self.regions)
        )


def ring_area(ring: NDArray[np.float64]) -> float:
    """Signed area of a closed polygon, (n, 2), positive if counterclockwise."""
    x, y = (ring - ring.mean(axis=0)).T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
