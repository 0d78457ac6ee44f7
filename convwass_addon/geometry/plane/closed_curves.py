# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed polygons in the plane, parametrized by arc length."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays.integer_ranges import integer_ranges
from .nearest_edges import nearest_edges
from .planar_fill import Boundary
from .plane_angles import signed_angles

CORNER = np.radians(20.0)
"""A corner turns by more than this angle, in radians."""

# Points this close to a curve, relative to its length, are on it.
_ON_CURVE = 1e-9


@dataclass(frozen=True)
class ClosedCurve:
    """A closed polygon. Places on it are arc lengths from its first point, modulo its length.

    Attributes
    ----------
    points : (n, 2) float64
        Its corners in order, the area on their left.
    """

    points: NDArray[np.float64]

    @cached_property
    def starts(self) -> NDArray[np.float64]:
        """Places of the points, and the length of the curve, (n + 1,)."""
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(self._sides, axis=1))])

    @cached_property
    def _sides(self) -> NDArray[np.float64]:
        return np.roll(self.points, -1, axis=0) - self.points

    @property
    def length(self) -> float:
        """Length of the curve."""
        return float(self.starts[-1])

    def at(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the points at any places, (k, 2)."""
        along = np.mod(places, self.length)
        edge = np.clip(np.searchsorted(self.starts, along, side="right") - 1, 0, len(self.points) - 1)
        lengths = np.maximum(np.diff(self.starts), np.finfo(np.float64).tiny)
        share = (along - self.starts[edge]) / lengths[edge]
        return self.points[edge] + share[:, None] * self._sides[edge]

    def sharp_places(self, angle: float) -> NDArray[np.float64]:
        """Return the places of all points at which the curve turns by more than an angle in radians."""
        turns = signed_angles(np.roll(self._sides, 1, axis=0), self._sides)
        return self.starts[:-1][np.abs(turns) > angle]

    def places_of(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the places of those points, (k, 2), that are on the curve."""
        places, away = self.nearest(points)
        return places[away <= _ON_CURVE * self.length]

    def nearest(self, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the places nearest to points, (k, 2), and their distances, (k,)."""
        found = nearest_edges(points, self.points, self._sides)
        lengths = np.linalg.norm(self._sides[found.edges], axis=1)
        return self.starts[found.edges] + found.shares * lengths, found.distances

    def nearest_between(self, point: NDArray[np.float64], low: float, high: float) -> float:
        """Return the place between two others, the second one larger by at most a round, nearest to a point, (2,)."""
        places = self.spread(low, high, self.starts[:-1], np.inf)
        corners = self.at(places)
        found = nearest_edges(point[None], corners[:-1], np.diff(corners, axis=0))
        (edge,), (share,) = found.edges, found.shares
        return float(places[edge] + share * (places[edge + 1] - places[edge]))

    def spread(self, begin: float, end: float, knots: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
        """Return places from `begin` to `end`, both included, evenly spaced between knots.

        Parameters
        ----------
        begin, end : float
            Places, the second one larger and by at most a round.
        knots : (k,)
            Places of points that are included if they lie between these two.
        spacing : float
            Approximate distance along the curve.
        """
        near = 1e-6 * self.length
        inner = np.sort(begin + np.mod(knots - begin, self.length))
        inner = inner[(inner > begin + near) & (inner < end - near)]
        inner = inner[np.diff(inner, prepend=-np.inf) > near]
        ends = np.concatenate([[begin], inner, [end]])
        counts = np.maximum(np.rint(np.diff(ends) / spacing).astype(int), 1)
        piece, number = integer_ranges(0, counts)
        return np.append(ends[piece] + np.diff(ends)[piece] * number / counts[piece], end)

    def resampled(self, knots: NDArray[np.float64], spacing: float) -> ClosedCurve:
        """Return the polygon through points that are evenly spaced between knots, as for :meth:`spread`."""
        begin = float(knots[0]) if len(knots) else 0.0
        return ClosedCurve(self.at(self.spread(begin, begin + self.length, knots, spacing)[:-1]))

    def differences(self, places: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far along the curve other places, (k,), are from places, (...,), at most half of it: (..., k)."""
        return np.mod(others - places[..., None] + 0.5 * self.length, self.length) - 0.5 * self.length

    def to_nearest(self, places: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far the nearest of other places, (k,), is from places, (...,); infinite if there is none."""
        if not len(others):
            return np.full(places.shape, np.inf)
        away = self.differences(places, others)
        return np.take_along_axis(away, np.abs(away).argmin(axis=-1)[..., None], axis=-1)[..., 0]

    def with_places(self, places: NDArray[np.float64]) -> ClosedCurve:
        """Return the same curve with more points on it."""
        knots = np.concatenate([self.starts[:-1], places])
        return ClosedCurve(self.at(self.spread(0.0, self.length, knots, np.inf)[:-1]))


def opened_curve(outer: ClosedCurve, hole: ClosedCurve, places: tuple[float, float], width: float) -> ClosedCurve:
    """Return the curve around a region whose hole is connected to the outside by a slit.

    Parameters
    ----------
    outer, hole : ClosedCurve
        Around the region, and around its hole.
    places : (float, float)
        Places on both between which the straight slit is.
    width : float
        Width of the slit at both ends.
    """
    parts = []
    for curve, place in zip((outer, hole), places, strict=True):
        begin, end = place + 0.5 * width, place - 0.5 * width + curve.length
        parts.append(curve.at(curve.spread(begin, end, curve.starts[:-1], np.inf)))
    return ClosedCurve(np.concatenate(parts))


def boundary_of(curves: Sequence[ClosedCurve]) -> Boundary:
    """Return the boundary that consists of closed curves."""
    return Boundary.of_rings([curve.points for curve in curves])
