# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Match two outlines point by point, as they stand or turned, and symmetrically where both are symmetric.

Outlines determine flat shapes completely, so that a map between them leaves nothing to transport, keeps corners sharp,
and takes a fraction of a second.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.plane.curve_maps import CurveMap, smooth_map
from ...geometry.plane.curve_matching import CurveSamples, MatchedCurves, MatchWeights, match_work, matched_curves
from ...geometry.plane.curve_symmetry import MirrorAxes
from ...geometry.plane.plane_angles import best_turn
from .outline_curves import OutlineCurve

FINE = 160
"""Samples of an outline for the final match."""

# Samples of an outline for a rough match, by which turns are compared.
_ROUGH = 64
# A final match begins within this share of the curve from where a rough one does.
_NEAR = 0.05
# Turns that are tried, as fractions of a full one; the largest turn, in radians, after which curves still stand; and
# the work, and its share of that as they stand, below which they are turned.
_TURNS, _STANDING, _SIMILAR, _CLEARLY = 12, np.radians(10.0), 0.5, 0.45
# Curves that match with less work are alike. As they stand, they are not turned, which rounding or neighbors would
# decide. Of all pairs of 30 letters and digits, those that turn have at least 0.27 as they stand.
_ALIKE = 0.05
AS_PLACED = MatchWeights(0.3, 2.0, 0.2, 8.0, 0.02)
"""Weights of the work for curves as they are placed, chosen by eye."""

# Those for limbs that swing, with places that count less and hardly at all, and the share of the strain as they are
# placed below which limbs may swing.
_SWINGING = MatchWeights(0.1, 0.6, 0.2, 8.0, 0.02), MatchWeights(0.0, 0.1, 0.2, 8.0, 0.02)
_LESS_STRAIN = 0.97
# A mirrored corner is a corner if there is one this close to it, relative to the length of the curve.
_AT_CORNER = 0.004
# Of two turns after which curves match equally well, the smaller one is taken: additional work per radian.
_TURN_WORK = 0.01
# Smaller turns are not reported.
_TURNED = np.radians(20.0)
# A curve with more axes is round, and has one in every direction.
_MOST_AXES = 16
# Difference of angles, in radians, below which axes are equally good.
_EQUAL = 0.02


@dataclass(frozen=True)
class MatchedOutlines:
    """Two closed curves that are mapped onto each other.

    Attributes
    ----------
    map : CurveMap
        The map.
    cost : float
        The work per length; see :mod:`.curve_matching`.
    turn : float
        Angle in radians by which the first curve turns as a whole; zero if it is small, or if limbs swing.
    swings : bool
        Whether limbs swing, so that the places of pieces were disregarded.
    unrolled : float
        If they are matched as strokes: how large these are on the way, at most, relative to the larger one. Otherwise
        zero.
    """

    map: CurveMap
    cost: float
    turn: float
    swings: bool
    unrolled: float = 0.0


@dataclass(frozen=True)
class _Pose:
    """A way to match two curves: after a turn of the first one, and about an axis of each, if they are symmetric.

    Attributes
    ----------
    turn : float
        Angle in radians, from -pi to pi.
    ends : (2, k) float64 or None
        Places at which the axis crosses each curve: the first one, the second one and, a round later, the first one
        again. If both curves have an axis across that one, too, the place where they cross it comes after the first.
    axis : float
        Direction of the axis in radians.
    """

    turn: float
    ends: NDArray[np.float64] | None = None
    axis: float = 0.0


@dataclass(frozen=True)
class _Match:
    """Places on two curves that match, increasing, from a place to the same place, or to the other end of an axis.

    Attributes
    ----------
    places, images : (k,) float64
        Places on both curves.
    cost : float
        The work per length.
    strain : float
        The part of the work that does not change if pieces are moved and turned.
    """

    places: NDArray[np.float64]
    images: NDArray[np.float64]
    cost: float
    strain: float

    @classmethod
    def of(
        cls,
        curves: tuple[OutlineCurve, OutlineCurve],
        samples: tuple[CurveSamples, CurveSamples],
        found: MatchedCurves,
        share: float,
    ) -> _Match:
        """Return the match of samples of a share of both curves."""
        chosen = zip(curves, samples, (found.first, found.second), strict=True)
        places, images = (curve.curve.length * own.places[rows] for curve, own, rows in chosen)
        strain = match_work(*samples, found, replace(AS_PLACED, turning=0.0, moving=0.0))
        return cls(places, images, found.cost / share, strain / share)

    def mirrored(self, curves: tuple[OutlineCurve, OutlineCurve], ends: NDArray[np.float64]) -> _Match:
        """Complete the match of halves or quarters of two curves by their mirror images; see :class:`_Pose`."""
        both = []
        for part, stops, curve in zip((self.places, self.images), ends[:, 2:], curves, strict=True):
            whole = part
            for stop in stops:
                rest = (stop - whole[-1]) / (whole[-1] - whole[0])
                whole = np.concatenate([whole, whole[-1] + (whole[-1] - whole[-2::-1]) * rest])
            both.append(_at_corners(whole, len(part), curve))
        return _Match(*both, self.cost, self.strain)


@dataclass(frozen=True)
class _Candidate:
    """A pose, the weights of the work, and the rough match of the least work in it."""

    pose: _Pose
    weights: MatchWeights
    match: _Match


def matched_outlines(one: OutlineCurve, other: OutlineCurve) -> list[MatchedOutlines]:
    """Match two closed curves: as they are placed, and perhaps also as if limbs swung.

    If both have a common axis as they stand, half of a curve is matched, and the other half is its mirror image; of
    curves with two common axes, a quarter is matched. The first curve is turned by a multiple of 30 degrees, or so that
    both have a common axis, only if they match much better then. Curves with a common axis are only turned upside down,
    or if they are alike then. If pieces keep their shape better where their places are disregarded, the second match is
    that one.
    """
    symmetric = list(_symmetric_poses(one, other))
    upright = [pose for pose in symmetric if abs(pose.turn) < _STANDING]
    turned = [pose for pose in symmetric if abs(pose.turn) > _STANDING]
    if not upright:
        turned += [_Pose(_wrapped(turn)) for turn in np.arange(1, _TURNS) * (2.0 * np.pi / _TURNS)]
    stands = _straightest(upright) or [_Pose(0.0)]
    placed, *bent = (_best(one, other, stands, weights) for weights in (AS_PLACED, *_SWINGING))
    swings = [own for own in bent if own.match.strain < _LESS_STRAIN * placed.match.strain]
    found = _rough(one, other, turned, AS_PLACED) if placed.match.cost > _ALIKE else []
    lying = _least(found)
    if upright and lying is not None and lying.match.cost > _ALIKE:
        lying = _least([own for own in found if abs(own.pose.turn) > np.pi - _STANDING])
    if lying is not None and lying.match.cost < min(_SIMILAR, _CLEARLY * placed.match.cost):
        swings = [own for own in swings if own.match.strain < lying.match.strain]
        turn = _best_turn(one, other, lying.match) if lying.pose.ends is None else lying.pose.turn
        placed = replace(lying, pose=replace(lying.pose, turn=turn))
    return [_finished(one, other, placed, swings=False), *(_finished(one, other, own, swings=True) for own in swings)]


def have_upright_axis(one: OutlineCurve, other: OutlineCurve) -> bool:
    """Return whether two closed curves are symmetric about the same axis as they are placed."""
    return any(abs(pose.turn) < _STANDING for pose in _symmetric_poses(one, other))


def rough_work(one: OutlineCurve, other: OutlineCurve) -> float:
    """Return the work per length of a rough match of two curves as they are placed."""
    return _best_placed(one, other).match.cost


def placed_outlines(one: OutlineCurve, other: OutlineCurve) -> MatchedOutlines:
    """Match two closed curves as they are placed, about a common axis if they have one."""
    return _finished(one, other, _best_placed(one, other), swings=False)


def only_placed(one: OutlineCurve, other: OutlineCurve) -> list[MatchedOutlines]:
    """Match two closed curves only as they are placed: neither turned nor as if limbs swung."""
    return [placed_outlines(one, other)]


def _best_placed(one: OutlineCurve, other: OutlineCurve) -> _Candidate:
    """Return the rough match of two curves as they are placed."""
    upright = [pose for pose in _symmetric_poses(one, other) if abs(pose.turn) < _STANDING]
    return _best(one, other, _straightest(upright) or [_Pose(0.0)], AS_PLACED)


def _finished(one: OutlineCurve, other: OutlineCurve, rough: _Candidate, swings: bool) -> MatchedOutlines:
    """Match two curves finely, next to a rough match."""
    pose = rough.pose
    if pose.ends is None:
        fine = _around(one, other, pose.turn, rough.weights, rough.match)
        turn = _best_turn(one, other, fine)
    else:
        fine = _along_axis(one, other, pose, rough.weights, FINE).mirrored((one, other), pose.ends)
        turn = pose.turn
    found = smooth_map((one.curve, other.curve), (one.corners, other.corners), fine.places, fine.images)
    turns = not swings and abs(turn) > _TURNED
    return MatchedOutlines(found, fine.cost, turn if turns else 0.0, swings)


def _at_corners(places: NDArray[np.float64], first: int, curve: OutlineCurve) -> NDArray[np.float64]:
    """Return increasing places on a curve, with those from `first` on moved to corners that they are closest to."""
    found = places.copy()
    for corner in curve.corners:
        # What is at an end of the axis stays there.
        away = curve.curve.differences(found[first - 1 :], np.array([corner]))[:, 0]
        nearest = int(np.abs(away).argmin())
        if nearest in (0, len(away) - 1) or np.abs(away[nearest]) > _AT_CORNER * curve.curve.length:
            continue
        index = first - 1 + nearest
        moved = found[index] + away[nearest]
        if found[index - 1] < moved < found[index + 1]:
            found[index] = moved
    return found


def _straightest(poses: Sequence[_Pose]) -> list[_Pose]:
    """Return the poses that turn a curve least, and of these the ones with the most vertical axis."""
    chosen = list(poses)
    for measure in (lambda pose: abs(pose.turn), lambda pose: abs(np.cos(pose.axis))):
        least = min(map(measure, chosen), default=0.0)
        chosen = [pose for pose in chosen if measure(pose) < least + _EQUAL]
    return chosen


def _best(one: OutlineCurve, other: OutlineCurve, poses: Sequence[_Pose], weights: MatchWeights) -> _Candidate | None:
    """Return the pose in which two curves roughly match best; None if there are no poses."""
    return _least(_rough(one, other, poses, weights))


def _rough(one: OutlineCurve, other: OutlineCurve, poses: Sequence[_Pose], weights: MatchWeights) -> list[_Candidate]:
    """Match two curves roughly in several poses."""
    found = []
    for pose in poses:
        if pose.ends is None:
            match = _around(one, other, pose.turn, weights)
        else:
            match = _along_axis(one, other, pose, weights, _ROUGH)
        found.append(_Candidate(pose, weights, match))
    return found


def _least(candidates: Sequence[_Candidate]) -> _Candidate | None:
    """Return the candidate of the least work, None if there is none."""
    return min(candidates, key=lambda own: own.match.cost + _TURN_WORK * abs(own.pose.turn), default=None)


def _best_turn(one: OutlineCurve, other: OutlineCurve, match: _Match) -> float:
    """Return the turn of the first curve, in radians, that brings matched points closest to each other."""
    ours, theirs = one.curve.at(match.places) - one.center, other.curve.at(match.images) - other.center
    return best_turn(ours, theirs)


def _symmetric_poses(one: OutlineCurve, other: OutlineCurve) -> Iterator[_Pose]:
    """Yield the turns after which two curves have a common axis."""
    for own, place in _common_axes(one.axes, other.axes):
        angle = float(other.axes.angles[place])
        for flipped in (False, True):
            ends = _crossings(one, own, flipped=False), _crossings(other, place, flipped=flipped)
            # The second axis is of use only if both have one.
            fewest = min(map(len, ends))
            both = np.stack([each if len(each) == fewest else each[[0, 2, 3]] for each in ends])
            yield _Pose(_wrapped(angle + np.pi * flipped - one.axes.angles[own]), both, angle)


def _common_axes(one: MirrorAxes, other: MirrorAxes) -> list[tuple[int, int]]:
    """Return pairs of axes that may become the same one; a round curve has one in every direction."""
    ours, theirs = (np.flatnonzero(axes.is_best) for axes in (one, other))
    if not len(ours) or not len(theirs):
        return []
    if len(ours) > _MOST_AXES:
        theirs = theirs if len(theirs) <= _MOST_AXES else [_nearest(other.angles, 0.5 * np.pi)]
        return [(_nearest(one.angles, other.angles[place]), place) for place in theirs]
    if len(theirs) > _MOST_AXES:
        return [(place, _nearest(other.angles, one.angles[place])) for place in ours]
    return [(own, place) for own in ours for place in theirs]


def _crossings(outline: OutlineCurve, index: int, *, flipped: bool) -> NDArray[np.float64]:
    """Return where a curve crosses an axis, (3,), or that and an axis across it, (4,); see :class:`_Pose`."""
    axes, length = outline.axes, outline.curve.length
    begin, end = axes.places[index][::-1] if flipped else axes.places[index]
    across = axes.is_best & (np.abs(np.cos(axes.angles - axes.angles[index])) < _EQUAL)
    after = np.mod(np.append(axes.places[across].ravel(), end) - begin, length)
    middle = after[:-1][after[:-1] < after[-1]]
    return begin + np.array([0.0, *middle[:1], after[-1], length])


def _wrapped(angle: float) -> float:
    """Return the same angle between -pi and pi."""
    return float(np.angle(np.exp(1j * angle)))


def _nearest(angles: NDArray[np.float64], angle: float) -> int:
    """Return the index of the line of the nearest direction."""
    return int(np.abs(np.sin(angles - angle)).argmin())


def _around(
    one: OutlineCurve, other: OutlineCurve, turn: float, weights: MatchWeights, near: _Match | None = None
) -> _Match:
    """Match two closed curves after a turn: roughly, from every start, or finely, next to a rough match."""
    count = _ROUGH if near is None else FINE
    begin = one.corners[0] if len(one.corners) else 0.0
    start = 0.0 if near is None else near.images[0] - _NEAR * other.curve.length
    own = one.samples(begin, begin + one.curve.length, count).turned(turn)
    theirs = other.samples(start, start + other.curve.length, count)
    size, around = len(theirs.places) - 1, theirs.twice_around()
    starts = size if near is None else int(np.searchsorted(around.places, around.places[0] + 2.0 * _NEAR))
    return _Match.of((one, other), (own, around), matched_curves(own, around, range(starts), size, weights), 1.0)


def _along_axis(one: OutlineCurve, other: OutlineCurve, pose: _Pose, weights: MatchWeights, count: int) -> _Match:
    """Match the halves of two closed curves on one side of their common axis, or quarters between two axes."""
    parts = [curve.samples(*ends[:2], count) for curve, ends in zip((one, other), pose.ends, strict=True)]
    own, theirs = parts[0].turned(pose.turn), parts[1]
    found = matched_curves(own, theirs, range(1), len(theirs.places) - 1, weights)
    return _Match.of((one, other), (own, theirs), found, 0.5 if pose.ends.shape[1] == 3 else 0.25)
