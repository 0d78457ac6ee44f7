# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cubic Bezier pieces for dense rings by Schneider's least squares (Graphics Gems, 1990), in vectorized rounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.integer_ranges import integer_ranges

# How often the curve parameters of the points are corrected.
_CORRECTED = 4
# Above this multiple of the error, correcting parameters does not help, so the piece is split.
_HOPELESS = 16.0
_TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True)
class BezierPieces:
    """Consecutive pieces of one ring.

    Attributes
    ----------
    starts : (n,) int64
        Indices of the ring's points at which pieces begin.
    controls : (n, 4, 2) float64
        Control points of each piece.
    errors : (n,) float64
        Largest distance of each piece from its points.
    """

    starts: NDArray[np.int64]
    controls: NDArray[np.float64]
    errors: NDArray[np.float64]


def fitted_pieces(
    rings: Sequence[NDArray[np.float64]],
    breaks: Sequence[NDArray[np.int64]],
    corners: Sequence[NDArray[np.bool_]],
    arc: float,
    error: float,
) -> list[BezierPieces]:
    """Fit one piece between every two breaks, and split each at its worst point until all are accurate enough.

    Parameters
    ----------
    rings : sequence of (n, 2)
        Closed polygons, without repeating the first point.
    breaks : sequence of (b,) int64
        Ascending indices of the points of every ring at which pieces begin, at least two.
    corners : sequence of (n,) bool
        Points where the tangents of adjacent pieces are independent.
    arc : float
        Arc length over which tangents are estimated, in the rings' units.
    error : float
        Largest allowed distance of a point from its curve.
    """
    points = _RingPoints.of(rings, corners, arc)
    owner = np.repeat(np.arange(len(rings)), [len(own) for own in breaks])
    low = np.concatenate(breaks).astype(np.int64)
    ends = [np.append(own[1:], own[0] + len(ring)) for own, ring in zip(breaks, rings, strict=True)]
    high = np.concatenate(ends).astype(np.int64)
    found = []
    while len(low):
        leaving = points.tangents(owner, low, 1)
        arriving = -points.tangents(owner, high, -1)
        batch = _Batch.of(points, owner, low, high)
        controls, away = batch.best(leaving, arriving, error)
        worst = np.maximum.reduceat(away, batch.firsts)
        short = high - low < 2
        done = (worst <= error) | short
        found.append((owner[done], low[done], controls[done], np.where(short, 0.0, worst)[done]))
        middle = low + np.clip(batch.first_of(away == worst[batch.piece]), 1, np.maximum(high - low - 1, 1))
        going = ~done
        owner = np.concatenate([owner[going], owner[going]])
        low, high = (np.concatenate(ends) for ends in ((low[going], middle[going]), (middle[going], high[going])))
    owner, low, controls, errors = (np.concatenate(parts) for parts in zip(*found, strict=True))
    order = np.lexsort((low, owner))
    chosen = [order[owner[order] == number] for number in range(len(rings))]
    return [
        BezierPieces(low[own] % len(ring), controls[own], errors[own]) for own, ring in zip(chosen, rings, strict=True)
    ]


def basis(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cubic Bernstein polynomials at parameters from 0 to 1, (..., 4)."""
    t, s = places, 1.0 - places
    return np.stack([s**3, 3 * s * s * t, 3 * s * t * t, t**3], axis=-1)


@dataclass(frozen=True)
class _RingPoints:
    """The points of all rings, concatenated."""

    points: NDArray[np.float64]
    is_corner: NDArray[np.bool_]
    offsets: NDArray[np.int64]
    counts: NDArray[np.int64]
    reaches: NDArray[np.int64]
    """Number of points over which tangents are estimated."""

    @classmethod
    def of(cls, rings: Sequence[NDArray[np.float64]], corners: Sequence[NDArray[np.bool_]], arc: float) -> _RingPoints:
        counts = np.array([len(ring) for ring in rings])
        steps = [float(np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1).mean()) for ring in rings]
        reaches = [
            max(1, min(round(arc / 4.0 / max(step, _TINY)), int(count) // 8 or 1))
            for step, count in zip(steps, counts, strict=True)
        ]
        offsets = np.cumsum(counts) - counts
        return cls(np.concatenate(rings), np.concatenate(corners), offsets, counts, np.array(reaches))

    def numbers(self, owner: NDArray[np.int64], place: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return indices of the points of rings, modulo the length of each ring."""
        return self.offsets[owner] + place % self.counts[owner]

    def tangents(self, owner: NDArray[np.int64], place: NDArray[np.int64], side: int) -> NDArray[np.float64]:
        """Tangents at points: central differences; at corners, backward (side -1) or forward (1) differences."""
        one_sided = self.is_corner[self.numbers(owner, place)]
        reach = self.reaches[owner]
        back = np.where(one_sided & (side > 0), 0, reach)
        forth = np.where(one_sided & (side < 0), 0, reach)
        along = self.points[self.numbers(owner, place + forth)] - self.points[self.numbers(owner, place - back)]
        return along / np.maximum(np.linalg.norm(along, axis=1), _TINY)[:, None]


@dataclass(frozen=True)
class _Batch:
    """The points of many pieces, concatenated, each with both of its ends."""

    points: NDArray[np.float64]
    piece: NDArray[np.int64]
    firsts: NDArray[np.int64]
    lasts: NDArray[np.int64]

    @classmethod
    def of(
        cls, points: _RingPoints, owner: NDArray[np.int64], low: NDArray[np.int64], high: NDArray[np.int64]
    ) -> _Batch:
        sizes = high - low + 1
        firsts = np.cumsum(sizes) - sizes
        piece, places = integer_ranges(low, sizes)
        return cls(points.points[points.numbers(owner[piece], places)], piece, firsts, firsts + sizes - 1)

    def part(self, chosen: NDArray[np.bool_]) -> _Batch:
        """Return a subset of the pieces."""
        sizes = (self.lasts - self.firsts + 1)[chosen]
        firsts = np.cumsum(sizes) - sizes
        piece = np.repeat(np.arange(len(sizes)), sizes)
        return _Batch(self.points[chosen[self.piece]], piece, firsts, firsts + sizes - 1)

    def first_of(self, wanted: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Return the index within every piece of its first wanted point; each piece must have one."""
        numbers = np.flatnonzero(wanted)
        _, first = np.unique(self.piece[numbers], return_index=True)
        return numbers[first] - self.firsts

    def best(
        self, leaving: NDArray[np.float64], arriving: NDArray[np.float64], error: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Fit a cubic to each piece; return their controls, (p, 4, 2), and the distances of all points."""
        controls, away = np.empty((len(self.firsts), 4, 2)), np.empty(len(self.points))
        batch, places, lengths = self, *self._along()
        own, points = np.arange(len(self.firsts)), np.arange(len(self.points))
        for attempt in range(_CORRECTED + 1):
            fitted = batch.least_squares(places, leaving[own], arriving[own], lengths[own])
            distances = np.linalg.norm(batch.curve(places, fitted) - batch.points, axis=1)
            controls[own], away[points] = fitted, distances
            worst = np.maximum.reduceat(distances, batch.firsts)
            going = (worst > error) & (worst <= _HOPELESS * error)
            if attempt == _CORRECTED or not going.any():
                break
            kept = going[batch.piece]
            places = batch.corrected(places, fitted)[kept]
            batch, own, points = batch.part(going), own[going], points[kept]
        return controls, away

    def _along(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Parameters of the points by chord length, from 0 to 1 in every piece, and the lengths of the pieces."""
        steps = np.append(0.0, np.linalg.norm(np.diff(self.points, axis=0), axis=1))
        steps[self.firsts] = 0.0
        ways = np.cumsum(steps)
        ways -= ways[self.firsts][self.piece]
        lengths = ways[self.lasts]
        return ways / np.maximum(lengths, _TINY)[self.piece], lengths

    def curve(self, places: NDArray[np.float64], controls: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the curves at the given parameters, (n, 2)."""
        return np.einsum("nc,ncd->nd", basis(places), controls[self.piece])

    def least_squares(
        self,
        places: NDArray[np.float64],
        leaving: NDArray[np.float64],
        arriving: NDArray[np.float64],
        lengths: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Fit the lengths of the two handles of every piece by least squares; return the controls, (p, 4, 2)."""
        weights = basis(places)
        first, last = self.points[self.firsts], self.points[self.lasts]
        near, far = weights[:, :2].sum(axis=1)[:, None], weights[:, 2:].sum(axis=1)[:, None]
        rest = self.points - near * first[self.piece] - far * last[self.piece]
        one, other = weights[:, 1], weights[:, 2]
        x, y = ((rest * side[self.piece]).sum(axis=1) for side in (leaving, arriving))
        terms = np.stack([one * one, one * other, other * other, one * x, other * y])
        aa, ab, bb, x, y = np.add.reduceat(terms, self.firsts, axis=1)
        aa, bb = aa * (leaving**2).sum(axis=1), bb * (arriving**2).sum(axis=1)
        ab = ab * (leaving * arriving).sum(axis=1)
        determinant = aa * bb - ab * ab
        sound = determinant > 1e-12 * aa * bb
        safe = np.where(sound, determinant, 1.0)
        sizes = np.stack([bb * x - ab * y, aa * y - ab * x], axis=1) / safe[:, None]
        # Handles that point backward, or are longer than twice the piece, would make loops.
        sound &= (sizes > 1e-3 * lengths[:, None]).all(axis=1) & (sizes < 2.0 * lengths[:, None]).all(axis=1)
        sizes = np.where(sound[:, None], sizes, lengths[:, None] / 3.0)
        return np.stack([first, first + sizes[:, :1] * leaving, last + sizes[:, 1:] * arriving, last], axis=1)

    def corrected(self, places: NDArray[np.float64], controls: NDArray[np.float64]) -> NDArray[np.float64]:
        """Improve every parameter by one Newton step towards the closest point of the curve."""
        first = 3.0 * np.diff(controls, axis=1)
        second = 2.0 * np.diff(first, axis=1)
        t, s = places, 1.0 - places
        away = self.curve(places, controls) - self.points
        slope = np.einsum("nc,ncd->nd", np.stack([s * s, 2 * s * t, t * t], axis=1), first[self.piece])
        bend = np.einsum("nc,ncd->nd", np.stack([s, t], axis=1), second[self.piece])
        lower = (slope * slope).sum(axis=1) + (away * bend).sum(axis=1)
        certain = np.abs(lower) > 1e-12
        step = np.where(certain, (away * slope).sum(axis=1) / np.where(certain, lower, 1.0), 0.0)
        moved = np.clip(places - step, 0.0, 1.0)
        moved[self.firsts], moved[self.lasts] = 0.0, 1.0
        # Keep parameters ascending; the offset keeps the pieces apart.
        return np.maximum.accumulate(moved + 2.0 * self.piece) - 2.0 * self.piece
