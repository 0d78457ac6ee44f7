# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes: long and narrow flat shapes, such as an S, with two sides along a center line between two ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .closed_curves import ClosedCurve, boundary_of
from .planar_fill import Boundary

# Samples of a curve.
_SAMPLES = 256
# An end is what a chord cuts off whose ends are this many times as far from each other along the curve: 1.57 times for
# half a circle, and between a square end and one with rounded corners.
_AROUND = 1.6
# Points of a chord, without its ends, and the least share of them inside the shape.
_ALONG, _INSIDE = np.linspace(0.15, 0.85, 5), 0.98
# A stroke is at least so many times as long as it is wide on average, and nowhere more than the second number of times
# as wide: a Z has 1.7 to 2.2 in its corners, a T 2.5 and more.
_LEAST_LENGTH, _MOST_WIDTH = 2.0, 2.4
# Where one end of a chord stays, it still moves at this share of the mean speed.
_SLOWEST = 0.05


@dataclass(frozen=True)
class Stroke:
    """A flat shape that chords sweep from one end to the other without becoming long.

    Attributes
    ----------
    curve : ClosedCurve
        Its outline.
    left, right : (k,) float64
        Places of both ends of every chord, at equal distances along the center line. Those on the left increase and
        those on the right decrease. The first end of the stroke is between `right[0]` and `left[0]`, the other one
        between `left[-1]` and `right[-1]` a round later.
    """

    curve: ClosedCurve
    left: NDArray[np.float64]
    right: NDArray[np.float64]

    @classmethod
    def of(cls, curve: ClosedCurve, filled: Boundary) -> Stroke | None:
        """Return a shape as a stroke, None if it is none.

        Of all ways in which a chord can sweep the shape, with one of its ends at a time moving along the curve, the
        one with the least sum of squared lengths is found by dynamic programming.

        Parameters
        ----------
        curve : ClosedCurve
            The outline of the shape.
        filled : Boundary
            The boundary of the shape, with holes.
        """
        spacing = curve.length / _SAMPLES
        points = curve.at(spacing * np.arange(_SAMPLES))
        begin, end = _sweep(points)
        widths = np.linalg.norm(points[end % _SAMPLES] - points[begin % _SAMPLES], axis=1)
        around = spacing * (end - begin)
        inner = np.flatnonzero((around > _AROUND * widths) & (curve.length - around > _AROUND * widths))
        if len(inner) < 2:
            return None
        chosen = slice(inner[0], inner[-1] + 1)
        found = cls(curve, spacing * end[chosen], spacing * begin[chosen])
        return found._without_stops() if found._is_narrow() and found._is_inside(filled) else None

    @property
    def chords(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The ends of all chords on the left and on the right, (k, 2) each."""
        return self.curve.at(self.left), self.curve.at(self.right)

    @property
    def widths(self) -> NDArray[np.float64]:
        """Lengths of all chords, (k,)."""
        left, right = self.chords
        return np.linalg.norm(left - right, axis=1)

    @property
    def length(self) -> float:
        """Length of the center line, the mean of that of both sides."""
        return 0.5 * float(self.left[-1] - self.left[0] + self.right[0] - self.right[-1])

    def _is_narrow(self) -> bool:
        mean = boundary_of([self.curve]).area / self.length
        return self.length >= _LEAST_LENGTH * mean and float(self.widths.max()) <= _MOST_WIDTH * mean

    def _is_inside(self, filled: Boundary) -> bool:
        left, right = self.chords
        points = right[:, None] + (left - right)[:, None] * _ALONG[:, None]
        return float(filled.contains(points.reshape(-1, 2)).mean()) >= _INSIDE

    def _without_stops(self) -> Stroke:
        """Return nearly the same stroke, in which no end of a chord stays where it is, as at the inside of a corner."""
        even = (np.linspace(own[0], own[-1], len(own)) for own in (self.left, self.right))
        sides = zip((self.left, self.right), even, strict=True)
        return Stroke(self.curve, *(own + _SLOWEST * (each - own) for own, each in sides))

    def from_other_end(self) -> Stroke:
        """Return the same stroke from its other end, whose left side is the right one of this."""
        return Stroke(self.curve, self.right[::-1], self.left[::-1] - self.curve.length)

    def at(self, shares: NDArray[np.float64]) -> Stroke:
        """Return the stroke with chords at shares of the center line, (n,), from 0 to 1."""
        own = np.linspace(0.0, 1.0, len(self.left))
        return Stroke(self.curve, np.interp(shares, own, self.left), np.interp(shares, own, self.right))

    def directions(self) -> NDArray[np.float64]:
        """Return directions of the center line between chords, (k - 1,), in radians, without jumps by full turns."""
        left, right = self.chords
        along = np.diff(0.5 * (left + right), axis=0)
        return np.unwrap(np.arctan2(along[:, 1], along[:, 0]))

    def around(self, count: int) -> NDArray[np.float64]:
        """Return places around the curve, increasing: along the left, around the end, along the right and back.

        There are `count` places inside each end; the last place is the first one a round later.
        """
        length = self.curve.length
        last = np.linspace(self.left[-1], self.right[-1] + length, count + 2)[1:-1]
        first = np.linspace(self.right[0], self.left[0], count + 2)[1:-1] + length
        return np.concatenate([self.left, last, self.right[::-1] + length, first, self.left[:1] + length])


def _sweep(points: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return begin and end of the chords that sweep a closed polygon, (n, 2), counterclockwise.

    Each chord cuts off one point more than the one before. Ends are larger than begins and may exceed n.
    """
    count = len(points)
    work = np.square(points - points[:, None]).sum(axis=2)
    rows = np.arange(count)
    least = np.zeros(count)
    grew_back = np.zeros((count, count), bool)
    for size in range(1, count):
        # The chord from row to row + size cuts off what one of those from row + 1 and to row + size - 1 does.
        later = np.roll(least, -1)
        grew_back[:, size] = later < least
        least = np.minimum(later, least) + work[rows, (rows + size) % count]
    begin = int(least.argmin())
    begins = []
    for size in range(count - 1, 0, -1):
        begins.append(begin)
        begin += int(grew_back[begin % count, size])
    found = np.array(begins[::-1])
    return found, found + np.arange(1, count)
