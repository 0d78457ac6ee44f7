# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cavities of sections through the axis of solids of revolution, such as those of cups, vases and bowls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..plane.planar_fill import Boundary
from ..plane.ring_nesting import boundary_rings

# Cavities have at least this share of the volume of the solid that is filled to the rim.
_LEAST = 0.1
# Corners are at the rim if they are lower by at most this share of the height.
_AT_RIM = 1e-4


@dataclass(frozen=True)
class SectionCavity:
    """The cavity of a section that is mirror-symmetric about the axis.

    Attributes
    ----------
    outside : Boundary
        The boundary of the section without the surface of the cavity, from the inner edge of the rim around.
    surface : Boundary
        The surface of the cavity.
    rim : (2,) float64
        The inner edge of the rim: distance from the axis, and place along it.
    side : float
        1 if the cavity is open in the direction of the axis, -1 if it is open in the opposite direction.
    """

    outside: Boundary
    surface: Boundary
    rim: NDArray[np.float64]
    side: float

    @classmethod
    def of(cls, section: Boundary) -> SectionCavity | None:
        """Find the larger cavity of a section that is open along the axis.

        Parameters
        ----------
        section : Boundary
            Distances from the axis, and places along it, on both sides.

        Returns
        -------
        SectionCavity or None
            None if there is none, or if the section has several regions or holes.
        """
        rings = boundary_rings(section)
        if len(rings) != 1:
            return None
        found = [own for side in (1.0, -1.0) if (own := _open_towards(rings[0], side)) is not None]
        largest = max(found, key=lambda own: revolved_volume(own.filled), default=None)
        if largest is None or revolved_volume(section) > (1.0 - _LEAST) * revolved_volume(largest.filled):
            return None
        return largest

    @property
    def filled(self) -> Boundary:
        """The section, filled to the rim."""
        return Boundary.joined([self.outside, Boundary(self.outside.ends[-1:], self.outside.starts[:1])])

    def at_top(self, outline: Boundary) -> NDArray[np.bool_]:
        """Return which edges of an outline at rest are at the height of the rim, (e,)."""
        lowest = self.rim[1] * self.side - _AT_RIM * np.ptp(self.outside.bounds[:, 1])
        return np.minimum(self.side * outline.starts[:, 1], self.side * outline.ends[:, 1]) >= lowest

    @property
    def profile(self) -> NDArray[np.float64]:
        """Points of the surface of the cavity on one side of the axis, from the rim to the axis, (k, 2)."""
        points = np.concatenate([self.surface.starts, self.surface.ends[-1:]])[:: int(self.side)]
        last = int(np.flatnonzero(points[:, 0] > 0.0)[-1])
        inner, beyond = points[last], points[last + 1]
        share = inner[0] / (inner[0] - beyond[0])
        return np.concatenate([points[: last + 1], [(0.0, inner[1] + share * (beyond[1] - inner[1]))]])


def revolved_volume(section: Boundary) -> float:
    """Return the volume of a solid of revolution with a section that is mirror-symmetric about the axis.

    By the divergence theorem, it is the integral of pi r^2 dy along the boundary on one side.
    """
    (first, low), (last, high) = section.starts.T, section.ends.T
    squares = (first**2 + first * last + last**2) / 3.0 * np.sign(first + last)
    return 0.5 * np.pi * float(squares @ (high - low))


def _open_towards(ring: NDArray[np.float64], side: float) -> SectionCavity | None:
    """Return the cavity that is open on one side, or None if the section is highest on the axis there."""
    heights = side * ring[:, 1]
    at_rim = heights >= heights.max() - _AT_RIM * np.ptp(heights)
    right, left = (np.flatnonzero(at_rim & (sign * ring[:, 0] > 0.0)) for sign in (1.0, -1.0))
    if not len(right) or not len(left):
        return None
    rims = right[ring[right, 0].argmin()], left[ring[left, 0].argmax()]
    # Counterclockwise, a cavity that is open upward begins on the right side.
    begin, end = rims[:: int(side)]
    turned = np.roll(ring, -begin, axis=0)
    last = (end - begin) % len(ring)
    # A flat top has no corners between those of its edge.
    if last < 2:
        return None
    outside = np.concatenate([turned[last:], turned[:1]])
    return SectionCavity(
        Boundary(outside[:-1], outside[1:]), Boundary(turned[:last], turned[1 : last + 1]), ring[rims[0]], side
    )
