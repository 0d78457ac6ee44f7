# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of flat shapes: regions with holes, whose rings do not cross."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rule = Literal["non-zero", "even-odd"]
"""Which points are inside of rings: around which they turn other than zero times, or an odd number of times."""


@dataclass(frozen=True)
class FlatRegion:
    """What hangs together.

    Attributes
    ----------
    outer : (n, 2) float64
        Corners of a closed polygon, counterclockwise, the first not repeated.
    holes : tuple of (m, 2) float64
        The same, clockwise.
    """

    outer: NDArray[np.float64]
    holes: tuple[NDArray[np.float64], ...] = ()

    @property
    def rings(self) -> tuple[NDArray[np.float64], ...]:
        """All of them, the outer one first."""
        return (self.outer, *self.holes)

    def without_holes_below(self, area: float) -> FlatRegion:
        """Return the region with all holes of less than an area filled."""
        return FlatRegion(self.outer, tuple(hole for hole in self.holes if -ring_area(hole) >= area))


@dataclass(frozen=True)
class Outline:
    """The regions of a flat shape, the largest first.

    Attributes
    ----------
    regions : tuple of FlatRegion
        Apart from each other.
    """

    regions: tuple[FlatRegion, ...]

    @property
    def rings(self) -> tuple[NDArray[np.float64], ...]:
        """All rings, each outer one before its holes."""
        return tuple(ring for region in self.regions for ring in region.rings)

    @property
    def points(self) -> NDArray[np.float64]:
        """All corners in the order of the rings, (n, 2)."""
        return np.concatenate([np.zeros((0, 2)), *self.rings])

    @property
    def area(self) -> float:
        """What all regions enclose."""
        return float(sum(ring_area(ring) for ring in self.rings))

    @property
    def holes(self) -> int:
        """How many holes there are."""
        return sum(len(region.holes) for region in self.regions)

    @property
    def euler_number(self) -> int:
        """Regions minus holes."""
        return len(self.regions) - self.holes

    def moved(self, offset: ArrayLike, factor: float = 1.0) -> Outline:
        """Return the outline scaled and then moved."""
        return self.with_rings([ring * factor + np.asarray(offset) for ring in self.rings])

    def with_rings(self, rings: Sequence[NDArray[np.float64]]) -> Outline:
        """Return other rings, which belong together as those of this outline do."""
        given = iter(rings)
        return Outline(
            tuple(FlatRegion(next(given), tuple(next(given) for _ in region.holes)) for region in self.regions)
        )


def ring_area(ring: NDArray[np.float64]) -> float:
    """Signed area of a closed polygon, (n, 2), positive where it runs counterclockwise."""
    x, y = (ring - ring.mean(axis=0)).T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
