# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed curves of flat shapes with what they are compared by: positions, corners, axes and the shape nearby."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, map_coordinates

from ...geometry.plane.closed_curves import CORNER, ClosedCurve
from ...geometry.plane.coverage import coverage
from ...geometry.plane.curve_matching import CurveSamples
from ...geometry.plane.curve_symmetry import MirrorAxes
from ...geometry.plane.planar_fill import Boundary
from ...geometry.plane.plane_angles import rotated, signed_angles

# A curve of more corners, such as a traced one, is treated as smooth.
_MOST_CORNERS = 200
# Widths of the Gaussian neighborhoods whose filled fractions are compared, relative to the radius of the curve, and
# cells along the longest side of the grid on which they are measured.
_WIDTHS, _CELLS = (0.14, 0.28), 160
# Samples by which the radius is measured.
_SAMPLES = 160


def sharp_corners(curve: ClosedCurve) -> NDArray[np.float64]:
    """Return the places of the corners of a curve, which maps keep."""
    corners = curve.sharp_places(CORNER)
    return corners if len(corners) <= _MOST_CORNERS else corners[:0]


@dataclass(frozen=True)
class OutlineCurve:
    """A closed curve of the boundary of a flat shape.

    Attributes
    ----------
    curve : ClosedCurve
        The curve.
    filled : Boundary
        The whole boundary.
    center : (2,) float64
        The point that is compared with that of other curves.
    """

    curve: ClosedCurve
    filled: Boundary
    center: NDArray[np.float64]

    @cached_property
    def corners(self) -> NDArray[np.float64]:
        """Places of its corners."""
        return sharp_corners(self.curve)

    @cached_property
    def axes(self) -> MirrorAxes:
        """Axes of symmetry."""
        return MirrorAxes.of(self.curve, self.center, self.corners)

    @cached_property
    def radius(self) -> float:
        """Root mean square distance from the center."""
        points = self.curve.at(np.linspace(0.0, self.curve.length, _SAMPLES, endpoint=False))
        return float(np.sqrt(np.square(points - self.center).sum(axis=1).mean()))

    @cached_property
    def _neighborhoods(self) -> tuple[NDArray[np.float64], float, list[NDArray[np.float64]]]:
        """Lower corner and spacing of a grid, and the filled fractions of neighborhoods of its cells."""
        margin = 3.0 * max(_WIDTHS) * self.radius
        corner, far = self.curve.points.min(axis=0) - margin, self.curve.points.max(axis=0) + margin
        spacing = float((far - corner).max()) / _CELLS
        cells = tuple(np.ceil((far - corner) / spacing).astype(int))
        filled = coverage(self.filled.moved(-corner / spacing, 1.0 / spacing), cells)
        return corner, spacing, [gaussian_filter(filled, width * self.radius / spacing) for width in _WIDTHS]

    def turned(self, angle: float) -> OutlineCurve:
        """Return the curve of the whole shape turned about the center, by an angle in radians; places stay the same."""
        if angle == 0.0:
            return self
        curve, *ends = (
            rotated(points - self.center, angle) + self.center
            for points in (self.curve.points, self.filled.starts, self.filled.ends)
        )
        return OutlineCurve(ClosedCurve(curve), Boundary(*ends), self.center)

    def samples(self, begin: float, end: float, count: int) -> CurveSamples:
        """Sample the curve between two places, at about `count` samples per round, and at corners unless too many."""
        is_closed = end - begin > self.curve.length * (1.0 - 1e-6)
        knots = self.corners if len(self.corners) <= max(count, _MOST_CORNERS) // 2 else self.corners[:0]
        places = self.curve.spread(begin, end, knots, self.curve.length / count)
        points = self.curve.at(places)
        corner, spacing, fields = self._neighborhoods
        where = (points - corner).T / spacing - 0.5
        shape = np.stack([map_coordinates(field, where, order=1, mode="nearest") for field in fields], axis=1)
        return CurveSamples(
            places / self.curve.length, (points - self.center) / self.radius, _turns(points, is_closed), shape
        )


def _turns(points: NDArray[np.float64], is_closed: bool) -> NDArray[np.float64]:
    """Return the angles by which a polygon turns to the left at its points; at the ends of an open one, zero."""
    along = np.diff(points, axis=0)
    turns = signed_angles(along, np.roll(along, -1, axis=0))
    last = turns[-1:] if is_closed else np.zeros(1)
    return np.concatenate([last, turns[:-1], last])
