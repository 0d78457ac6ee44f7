# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Match sections of solids of revolution of which one has a cavity: its rim, and the edge of the other one's top."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.plane.closed_curves import ClosedCurve
from ...geometry.plane.curve_maps import smooth_map
from ...geometry.plane.curve_matching import CurveSamples, matched_curves
from .cavity_points import OPEN
from .matched_outlines import AS_PLACED, FINE, MatchedOutlines
from .outline_curves import OutlineCurve

# The top is what is lower by at most this share of the height.
_TOP = 0.01
# Places this close to each other, relative to the length of the curve, are the same.
_SAME = 1e-6
# Points of each part of a top, which are matched evenly.
_POINTS = 9


@dataclass(frozen=True)
class RimMatcher:
    """Matches curves around sections that are mirror-symmetric about the axis x = 0, and keeps the rims of vessels.

    By the work alone, the lid of a wide vessel matches more than the top of another solid, such as the shoulders of a
    bottle, whose neck would grow out of the cavity. So the mouth narrows, and the rim stays as broad as it is.

    Attributes
    ----------
    rims : tuple of (2,) float64
        Inner edges of the rims of vessels, at positive distances from the axis; the curves lead along their lids.
    side : float
        1 if these are where the second coordinate is largest, -1 if they are where that is smallest.
    """

    rims: tuple[NDArray[np.float64], ...]
    side: float

    def __call__(self, one: OutlineCurve, other: OutlineCurve) -> list[MatchedOutlines]:
        """Match two curves; see :data:`.outline_pairs.CurveMatcher`."""
        curves = one, other
        halves = [_Half.of(own.curve, self.side) for own in curves]
        breadth = max(self._breadth(own.curve, half) for own, half in zip(curves, halves, strict=True))
        parts = _equally_high(
            [own.samples(half.bottom, half.edge, FINE) for own, half in zip(curves, halves, strict=True)]
        )
        found = matched_curves(*parts, range(1), len(parts[1].places) - 1, AS_PLACED)
        tops = [half.along_top(breadth) for half in halves]
        places, images = (
            _around(np.append(own.curve.length * part.places[rows], top))
            for own, part, rows, top in zip(curves, parts, (found.first, found.second), tops, strict=True)
        )
        rims = np.array([halves[0].edge, halves[0].rim(breadth)])
        corners = np.concatenate([one.corners, rims, 2.0 * halves[0].top - rims])
        matched = smooth_map((one.curve, other.curve), (corners, other.corners), places, images)
        # Per length of the whole curve.
        return [MatchedOutlines(matched, 2.0 * found.cost, 0.0, swings=False)]

    def _breadth(self, curve: ClosedCurve, half: _Half) -> float:
        """Return the breadth of the rim of a vessel; 0 for other solids."""
        places, distances = curve.nearest(np.stack(self.rims) * (self.side, 1.0))
        nearest = int(distances.argmin())
        own = distances[nearest] < _SAME * curve.length
        return float(np.mod(places[nearest] - half.edge, curve.length)) if own else 0.0


@dataclass(frozen=True)
class _Half:
    """Places on half of a curve: where it crosses the axis, at the edge of the top, and in the middle of the top."""

    bottom: float
    edge: float
    top: float

    @classmethod
    def of(cls, curve: ClosedCurve, side: float) -> _Half:
        """Find these places, in the direction of the curve."""
        beyond = np.roll(curve.points, -1, axis=0)
        crossing = np.flatnonzero((curve.points[:, 0] > 0.0) != (beyond[:, 0] > 0.0))
        shares = curve.points[crossing, 0] / (curve.points[crossing, 0] - beyond[crossing, 0])
        middles = curve.starts[crossing] + shares * np.diff(curve.starts)[crossing]
        middles = middles[np.argsort(side * curve.at(middles)[:, 1])]
        bottom, top = middles[0], middles[0] + np.mod(middles[-1] - middles[0], curve.length)
        places = curve.spread(bottom, top, curve.starts[:-1], curve.length / 1000)
        points = curve.at(places)
        heights = side * points[:, 1]
        at_top = heights >= heights.max() - _TOP * np.ptp(heights)
        return cls(bottom, places[at_top][np.abs(points[at_top, 0]).argmax()], top)

    def rim(self, breadth: float) -> float:
        """Return the place of the inner edge of a rim of a breadth."""
        return self.edge + min(breadth, (1.0 - OPEN) * (self.top - self.edge))

    def along_top(self, breadth: float) -> NDArray[np.float64]:
        """Return places after the edge: along a rim of a breadth, and from there to the middle."""
        rim, steps = self.rim(breadth), np.linspace(0.0, 1.0, _POINTS)[1:]
        return np.concatenate([self.edge + (rim - self.edge) * steps, rim + (self.top - rim) * steps])


def _equally_high(parts: Sequence[CurveSamples]) -> list[CurveSamples]:
    """Stretch curves along the axis so that they begin and end at the same heights.

    Otherwise a neck that is higher than a mug would match the edge of its rim alone.
    """
    tall = [own.points[-1, 1] - own.points[0, 1] for own in parts]
    found = []
    for own, height in zip(parts, tall, strict=True):
        along = (own.points[:, 1] - own.points[0, 1]) * (np.mean(tall) / height)
        found.append(replace(own, points=np.column_stack([own.points[:, 0], along])))
    return found


def _around(half: NDArray[np.float64]) -> NDArray[np.float64]:
    """Complete places on half of a curve by those of the other half, backward."""
    return np.concatenate([half, 2.0 * half[-1] - half[-2::-1]])
