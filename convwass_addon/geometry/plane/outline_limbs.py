# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Limbs of flat shapes, such as the strokes of letters: what short cuts from concave points separate.

M. Singh, G. Seyranian and D. Hoffman, "Parsing silhouettes: The short-cut rule", Perception & Psychophysics 61(4),
1999: silhouettes are divided by the shortest cuts of which at least one end is a concave point.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .closed_curves import CORNER, ClosedCurve, boundary_of
from .planar_fill import Boundary
from .plane_angles import signed_angles

# Samples of a curve, and by how many of them it is followed to both sides of a point to measure how it turns there.
_SAMPLES, _SIDE = 200, 2
# A curve is concave where it turns to the right by more than this angle.
_CONCAVE = np.radians(35.0)
# Areas between samples of a curve are those of limbs but for this factor.
_ABOUT = 1.5
# Points of a cut, without its ends, that have to be inside the shape.
_ALONG = np.linspace(0.1, 0.9, 7)
# Half the width of the neighborhood in which limbs reach equally far, in lengths of the cut.
_NEAR = 0.05
# Edges whose ends are this close, in lengths of the cut, are parallel to the axis; and by how much they are extended.
_PARALLEL = 1e-9
# A limb reaches at least so far, in lengths of its cut; and its sides run along it: they leave the strip over the cut
# at most by the second share of its length, and go back behind the cut at most by the third one.
_LEAST_REACH, _BESIDE, _BEHIND = 1.2, 0.35, 0.05
# Sine of the least angle between a cut and the limb.
_LEAST_SINE = 0.4
# Limbs whose ends are closer than this to those of another, relative to the length of the curve, are the same.
_SAME = 0.06


@dataclass(frozen=True)
class OutlineLimb:
    """A limb of a flat shape.

    Attributes
    ----------
    curve : ClosedCurve
        The outline of the shape.
    begin, end : float
        Places on it between which the limb is, the second one larger and by less than a round.
    """

    curve: ClosedCurve
    begin: float
    end: float

    def sampled(self, spacing: float, marks: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points of the outline from one end of the cut to the other one, (n, 2).

        Parameters
        ----------
        spacing : float
            Their approximate distance.
        marks : (k, 2)
            Points that are among them if they are on the outline, as corners are.
        """
        knots = np.concatenate([self.curve.sharp_places(CORNER), self.curve.places_of(marks)])
        return self.curve.at(self.curve.spread(self.begin, self.end, knots, spacing))

    @cached_property
    def outline(self) -> ClosedCurve:
        """The outline of the limb, whose first and last point are the ends of the cut."""
        return ClosedCurve(self.curve.at(self.curve.spread(self.begin, self.end, self.curve.starts[:-1], np.inf)))

    @property
    def cut(self) -> NDArray[np.float64]:
        """Both ends of the cut, (2, 2)."""
        return self.outline.points[[0, -1]]

    @property
    def width(self) -> float:
        """Length of the cut."""
        return float(np.linalg.norm(self.cut[1] - self.cut[0]))

    @cached_property
    def axis(self) -> NDArray[np.float64]:
        """Direction of the limb, from the middle of the cut to the center of the limb, (2,)."""
        along = boundary_of([self.outline]).center - self.cut.mean(axis=0)
        return along / np.linalg.norm(along)

    def coordinates(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where points, (n, 2), are along the cut, from 0 to 1, and their distances from it along the axis."""
        begin, end = self.cut
        return np.linalg.solve(np.stack([end - begin, self.axis], axis=1), (points - begin).T).T

    def reaches(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far the limb reaches along the axis near places on the line of the cut, (n,); see `coordinates`.

        At the sides, which are hardly ever parallel to the axis, it reaches as far as just beside them.
        """
        return np.max([self._reaches(places + offset) for offset in (-_NEAR, 0.0, _NEAR)], axis=0)

    def _reaches(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far the limb reaches along the axis at places, (n,)."""
        begin, low = self.coordinates(self.outline.points).T
        end, high = np.roll(begin, -1), np.roll(low, -1)
        along = end - begin
        # The ends of edges along the axis are those of others, too.
        is_across = np.abs(along) > _PARALLEL
        shares = (places[:, None] - begin) / np.where(is_across, along, 1.0)
        crosses = is_across & (shares >= -_PARALLEL) & (shares <= 1.0 + _PARALLEL)
        return np.where(crosses, low + shares * (high - low), 0.0).max(axis=1)

    @property
    def is_slender(self) -> bool:
        """Whether it reaches far enough, and its sides run along it."""
        begin, end = self.cut
        across = (end - begin) / self.width
        if abs(across[0] * self.axis[1] - across[1] * self.axis[0]) < _LEAST_SINE:
            return False
        beside, beyond = self.coordinates(self.outline.points).T
        return bool(
            beside.min() >= -_BESIDE
            and beside.max() <= 1.0 + _BESIDE
            and beyond.min() >= -_BEHIND * self.width
            and beyond.max() >= _LEAST_REACH * self.width
        )


def outline_limbs(curve: ClosedCurve, holes: Sequence[ClosedCurve], areas: tuple[float, float]) -> list[OutlineLimb]:
    """Return the limbs of a shape, those of the shortest cuts first; they may contain each other.

    Parameters
    ----------
    curve : ClosedCurve
        The outline of the shape.
    holes : sequence of ClosedCurve
        The curves around its holes, which no limb contains.
    areas : (float, float)
        Least and largest area of a limb.
    """
    filled, empty = boundary_of([curve, *holes]), np.concatenate([np.empty((0, 2)), *(own.points for own in holes)])
    found: list[OutlineLimb] = []
    for limb in sorted(_separated(curve, filled, areas), key=lambda own: own.width):
        inside = boundary_of([limb.outline])
        if not areas[0] <= inside.area <= areas[1] or inside.contains(empty).any():
            continue
        if limb.is_slender and not any(_are_same(limb, own) for own in found):
            found.append(limb)
    return found


def without_limb(limb: OutlineLimb) -> ClosedCurve:
    """Return the outline of a shape with a straight cut instead of one of its limbs."""
    curve = limb.curve
    places = curve.starts[:-1]
    places = places[np.mod(places - limb.begin, curve.length) > limb.end - limb.begin]
    cut = np.mod([limb.begin, limb.end], curve.length)
    return ClosedCurve(curve.at(np.unique(np.concatenate([places, cut]))))


def _separated(curve: ClosedCurve, filled: Boundary, areas: tuple[float, float]) -> Iterator[OutlineLimb]:
    """Yield what all cuts separate, of areas from about the first of two to about the second one."""
    spacing = curve.length / _SAMPLES
    corners = curve.sharp_places(_CONCAVE)
    # A curve of very many corners, such as a traced one, is treated as smooth.
    knots = corners if len(corners) <= _SAMPLES else corners[:0]
    places = curve.spread(0.0, curve.length, knots, spacing)[:-1]
    points, side = curve.at(places), _SIDE * spacing
    low, high = areas[0] / _ABOUT, areas[1] * _ABOUT
    turns = signed_angles(points - curve.at(places - side), curve.at(places + side) - points)
    apart = np.abs(curve.differences(places, places))
    for place in np.flatnonzero(turns < -_CONCAVE):
        if turns[place] > turns[apart[place] < side].min():
            continue
        away = np.linalg.norm(points - points[place], axis=1)
        is_nearest = (away <= np.roll(away, 1)) & (away <= np.roll(away, -1)) & (apart[place] > 2.0 * side)
        before, after = _areas(points, place)
        fits = np.stack([(low <= own) & (own <= high) for own in (before, after)])
        for other in np.flatnonzero(is_nearest & fits.any(axis=0)):
            if filled.contains(points[place] + _ALONG[:, None] * (points[other] - points[place])).all():
                foot = curve.nearest_between(points[place], places[other] - spacing, places[other] + spacing)
                ways = (foot, float(places[place])), (float(places[place]), foot)
                for (begin, end), is_chosen in zip(ways, fits[:, other], strict=True):
                    if is_chosen:
                        yield OutlineLimb(curve, begin, begin + (end - begin) % curve.length)


def _areas(points: NDArray[np.float64], place: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the areas of a closed polygon between each of its corners and one of them, and between that and each."""
    rolled = np.roll(points - points[place], -place, axis=0)
    # With that corner as the origin, the straight line to it adds nothing.
    crosses = rolled[:-1, 0] * rolled[1:, 1] - rolled[:-1, 1] * rolled[1:, 0]
    after = 0.5 * np.concatenate([[0.0], np.cumsum(crosses)])
    return tuple(np.roll(own, place) for own in (after[-1] - after, after))


def _are_same(one: OutlineLimb, other: OutlineLimb) -> bool:
    """Return whether two limbs of a curve have nearly the same ends."""
    ends = np.array([[own.begin, own.end] for own in (one, other)])
    return bool(np.abs(np.diag(one.curve.differences(*ends))).sum() < _SAME * one.curve.length)
