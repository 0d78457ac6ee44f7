# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Match two sampled curves monotonically, by dynamic programming.

T. Sederberg and E. Greenwood, "A Physically Based Approach to 2-D Shape Blending", SIGGRAPH 1992, match the vertices
of two polygons so that the work of stretching and bending one into the other is least. Here pieces of one curve are
matched to pieces of the other of up to six times their number of samples, so that nothing collapses to a point, and
the work is that of bending a piece, and, per length, of turning, moving and stretching it and of changing the shape
around it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from .plane_angles import rotated

# Numbers of samples of both curves that a piece spans.
_STEPS = ((1, 1), (1, 2), (2, 1), (2, 3), (3, 2), (1, 3), (3, 1), (1, 4), (4, 1), (1, 6), (6, 1))


@dataclass(frozen=True)
class MatchWeights:
    """Weights of the parts of the work.

    Attributes
    ----------
    turning : float
        Of 1 - cos a, where a is the angle between two pieces.
    moving : float
        Of the squared distance of their middles.
    stretching : float
        Of the squared logarithm of the ratio of their lengths.
    changing : float
        Of the squared difference of the features of the shape nearby.
    bending : float
        Of the squared difference of the angles, in radians, by which two pieces turn, whatever their lengths.
    """

    turning: float
    moving: float
    stretching: float
    changing: float
    bending: float


@dataclass(frozen=True)
class CurveSamples:
    """Samples of a curve in order.

    Attributes
    ----------
    places : (n,) float64
        Arc lengths in lengths of the curve, increasing.
    points : (n, 2) float64
        Positions; differences of about one are large.
    turns : (n,) float64
        Angles in radians by which the curve turns to the left at each sample.
    shape : (n, k) float64
        Features of the shape nearby that do not change if it is turned.
    """

    places: NDArray[np.float64]
    points: NDArray[np.float64]
    turns: NDArray[np.float64]
    shape: NDArray[np.float64]

    def turned(self, angle: float) -> CurveSamples:
        """Return the samples after a rotation about the origin, by an angle in radians."""
        return replace(self, points=rotated(self.points, angle))

    def twice_around(self) -> CurveSamples:
        """Return the samples of a closed curve, whose last sample is its first, for two rounds."""
        return CurveSamples(
            np.concatenate([self.places, self.places[1:] + 1.0]),
            np.concatenate([self.points, self.points[1:]]),
            np.concatenate([self.turns, self.turns[1:]]),
            np.concatenate([self.shape, self.shape[1:]]),
        )


@dataclass(frozen=True)
class MatchedCurves:
    """Samples of two curves that match.

    Attributes
    ----------
    first, second : (k,) int64
        Indices of matched samples, increasing.
    cost : float
        The work per length.
    """

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    cost: float


def matched_curves(
    one: CurveSamples, other: CurveSamples, starts: range, count: int, weights: MatchWeights
) -> MatchedCurves:
    """Match all samples of a curve to a sequence of samples of another one.

    Parameters
    ----------
    one : CurveSamples
        The first curve, (n + 1,) samples.
    other : CurveSamples
        The second curve; for a closed curve, its samples for two rounds.
    starts : range
        Samples of the second curve that may match the first sample of the first curve.
    count : int
        Number of samples after that one until the sample that matches the last one.
    weights : MatchWeights
        Weights of the work.

    Returns
    -------
    MatchedCurves
        The match of the least work.
    """
    possible = [(own, others) for own, others in _STEPS if others <= count]
    apart = _apart(one.shape[:, None], other.shape)
    # By sample of the first curve, start, and sample of the second curve after it.
    works = [
        sliding_window_view(_works(one, other, (own, others), weights, apart), count + 1 - others, axis=1)[
            :, starts.start : starts.stop
        ]
        for own, others in possible
    ]
    size = len(one.places)
    least = np.full((size, len(starts), count + 1), np.inf)
    least[0, :, 0] = 0.0
    for row in range(1, size):
        for (own, others), work in zip(possible, works, strict=True):
            if own <= row:
                known = least[row, :, others:]
                np.minimum(known, least[row - own, :, : count + 1 - others] + work[row - own], out=known)
    start = int(least[-1, :, count].argmin())
    first, second = [size - 1], [count]
    while first[-1] > 0:
        row, column = first[-1], second[-1]
        reached = [
            least[row - own, start, column - others] + work[row - own, start, column - others]
            if own <= row and others <= column
            else np.inf
            for (own, others), work in zip(possible, works, strict=True)
        ]
        own, others = possible[int(np.argmin(reached))]
        first.append(row - own)
        second.append(column - others)
    return MatchedCurves(np.array(first[::-1]), np.array(second[::-1]) + starts[start], float(least[-1, start, count]))


def match_work(one: CurveSamples, other: CurveSamples, match: MatchedCurves, weights: MatchWeights) -> float:
    """Return the work of a match with other weights than those that it was found with."""
    spans = np.stack([np.diff(match.first), np.diff(match.second)], axis=1)
    total = 0.0
    for own, others in _STEPS:
        chosen = np.flatnonzero((spans == (own, others)).all(axis=1))
        begins = match.first[chosen], match.second[chosen]
        changed = _apart(one.shape[begins[0]], other.shape[begins[1]])
        changed += _apart(one.shape[begins[0] + own], other.shape[begins[1] + others])
        ours, theirs = _Pieces.of(one, own).at(begins[0]), _Pieces.of(other, others).at(begins[1])
        total += float(_work(ours, theirs, weights, changed).sum())
    return total


def _works(
    one: CurveSamples, other: CurveSamples, step: tuple[int, int], weights: MatchWeights, apart: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the work of matching all pieces of given numbers of samples, (n - step[0], m - step[1]).

    It does not depend on the step how far the features of all samples are `apart`, (n, m).
    """
    own, others = step
    changed = apart[:-own, :-others] + apart[own:, others:]
    return _work(_Pieces.of(one, own).at((slice(None), None)), _Pieces.of(other, others), weights, changed)


def _work(ours: _Pieces, theirs: _Pieces, weights: MatchWeights, changed: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the work of matching pieces, whose arrays are broadcast, with the sum of the changes at both ends."""
    work = weights.turning * (1.0 - np.cos(ours.directions - theirs.directions))
    work += weights.moving * _apart(ours.middles, theirs.middles)
    work += weights.stretching * np.square(np.log(ours.lengths / theirs.lengths))
    work += weights.changing * (0.5 * changed)
    return 0.5 * (ours.lengths + theirs.lengths) * work + weights.bending * np.square(ours.turns - theirs.turns)


def _apart(ours: NDArray[np.float64], theirs: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the squared distances of points along the last axis, whose other axes are broadcast."""
    return sum(np.square(ours[..., axis] - theirs[..., axis]) for axis in range(ours.shape[-1]))


@dataclass(frozen=True)
class _Pieces:
    """Pieces of a curve.

    Attributes
    ----------
    lengths, directions, turns : (n,) float64
        Lengths, angles of the lines between their ends, and angles by which they turn.
    middles : (n, 2) float64
        Middles of these lines.
    """

    lengths: NDArray[np.float64]
    directions: NDArray[np.float64]
    turns: NDArray[np.float64]
    middles: NDArray[np.float64]

    @classmethod
    def of(cls, curve: CurveSamples, span: int) -> _Pieces:
        """Return all pieces of a number of samples."""
        along = curve.points[span:] - curve.points[:-span]
        return cls(
            curve.places[span:] - curve.places[:-span],
            np.arctan2(along[:, 1], along[:, 0]),
            _turns(curve, span),
            0.5 * (curve.points[span:] + curve.points[:-span]),
        )

    def at(self, rows: NDArray[np.int64] | tuple[slice, None]) -> _Pieces:
        """Return some of the pieces, or all of them along another axis."""
        return _Pieces(self.lengths[rows], self.directions[rows], self.turns[rows], self.middles[rows])


def _turns(curve: CurveSamples, span: int) -> NDArray[np.float64]:
    """Return the angles by which all pieces of a number of samples turn, with half of those at their ends."""
    total = np.cumsum(curve.turns) - 0.5 * curve.turns
    return total[span:] - total[:-span]
