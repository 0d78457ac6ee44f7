# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which closed curves of two flat shapes belong together; holes of only one shape shrink to a point of the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from ...geometry.deformation.mean_value import polygon_coordinates
from ...geometry.plane.closed_curves import ClosedCurve
from ...geometry.plane.curve_maps import CurveMap, even_map
from ...geometry.plane.plane_angles import best_turn
from .matched_outlines import MatchedOutlines, placed_outlines
from .matched_strokes import outlines_and_strokes
from .outline_curves import OutlineCurve
from .outlined_shape import OutlinedShape

CurveMatcher = Callable[[OutlineCurve, OutlineCurve], list[MatchedOutlines]]
"""Matches two curves around regions in one or more ways, the first of which is as they are placed."""

# Samples of an outline by which the inside is mapped.
_SAMPLES = 256
# Largest difference of points of similar curves, relative to their length.
_SIMILAR = 1e-9
# Samples of a hole by which its turn is measured.
_HOLE_SAMPLES = 48


@dataclass(frozen=True)
class CurvePair:
    """Curves of two shapes that belong together.

    Attributes
    ----------
    first, second : int
        Indices of the curves.
    map : CurveMap
        The map from the first to the second one.
    slides : bool
        Whether the map may be changed so that the inside is strained less; see :mod:`.sliding_outlines`.
    cost, turn, unrolled : float
        Figures of curves around regions as in :class:`.MatchedOutlines`; zero for holes.
    """

    first: int
    second: int
    map: CurveMap
    slides: bool = False
    cost: float = 0.0
    turn: float = 0.0
    unrolled: float = 0.0

    def swapped(self) -> CurvePair:
        """Return the pair with the shapes swapped."""
        return replace(self, first=self.second, second=self.first, map=self.map.inverse(), turn=-self.turn)


@dataclass(frozen=True)
class ShapePair:
    """Two shapes whose outlines are mapped onto each other.

    Attributes
    ----------
    first, second : OutlinedShape
        The shapes, with points that are holes of the other one.
    pairs : tuple of CurvePair
        Curves that belong together.
    """

    first: OutlinedShape
    second: OutlinedShape
    pairs: tuple[CurvePair, ...] = ()

    @property
    def regions(self) -> list[tuple[int, int]]:
        """Indices of the regions of both shapes that belong together."""
        ours, theirs = (
            {region.outer: index for index, region in enumerate(shape.regions)} for shape in (self.first, self.second)
        )
        return [(ours[pair.first], theirs[pair.second]) for pair in self.pairs if pair.first in ours]

    @property
    def swings(self) -> bool:
        """Whether limbs swing."""
        return any(pair.slides for pair in self.pairs)

    @property
    def unrolled(self) -> float:
        """How large regions that are matched as strokes become, relative to the larger one; zero if none is."""
        return max(pair.unrolled for pair in self.pairs)

    @property
    def turns(self) -> bool:
        """Whether a region turns."""
        return any(pair.turn != 0.0 for pair in self.pairs)

    @property
    def turn(self) -> float:
        """Angle in radians by which the first shape turns as a whole; zero if it has several regions."""
        return next((pair.turn for pair in self.pairs if pair.turn != 0.0), 0.0) if len(self.regions) == 1 else 0.0

    def swapped(self) -> ShapePair:
        """Return the pair with the shapes swapped."""
        return ShapePair(self.second, self.first, tuple(pair.swapped() for pair in self.pairs))

    def with_pair(self, pair: CurvePair) -> ShapePair:
        """Return the shapes with two more curves that belong together."""
        return replace(self, pairs=(*self.pairs, pair))


@dataclass(frozen=True)
class KnownMatches:
    """Matches of curves around regions, which are the same however other regions are completed.

    Attributes
    ----------
    match : callable
        Matches two curves.
    """

    match: CurveMatcher = outlines_and_strokes
    _found: dict[tuple[int, int], tuple[ClosedCurve, ClosedCurve, list[MatchedOutlines]]] = field(default_factory=dict)

    def of(self, one: OutlinedShape, region: int, other: OutlinedShape, there: int) -> list[MatchedOutlines]:
        """Match the curves around two regions, unless they have been."""
        outer, other_outer = one.regions[region].outer, other.regions[there].outer
        first, second = one.curves[outer], other.curves[other_outer]
        # The curves are kept, so that their numbers are not used again.
        key = id(first), id(second)
        if key not in self._found:
            self._found[key] = first, second, self._matched(one, outer, other, other_outer)
        return self._found[key][2]

    def _matched(self, one: OutlinedShape, index: int, other: OutlinedShape, there: int) -> list[MatchedOutlines]:
        """Match two curves; those that differ in size only, as the curves of points do, match at once."""
        first, second = one.curves[index], other.curves[there]
        if _are_similar(first, second):
            return [MatchedOutlines(even_map(first, second), 0.0, 0.0, swings=False)]
        return self.match(one.curve(index), other.curve(there))


def vanishing_share(one: OutlinedShape, other: OutlinedShape) -> float:
    """Return the share of the area of a shape that grows from points of the other one; the larger one of both."""
    shares = np.zeros(2)
    for own, there in region_pairs(one, other):
        ours, theirs = one.regions[own], other.regions[there]
        shares += one.share(ours) * theirs.is_point, other.share(theirs) * ours.is_point
    return float(shares.max())


def matched_shapes(one: OutlinedShape, other: OutlinedShape, known: KnownMatches | None = None) -> list[ShapePair]:
    """Match the closed curves of two shapes: as they are placed, and perhaps also as if limbs swung.

    Both have equal numbers of regions.
    """
    regions = region_pairs(one, other)
    known = KnownMatches() if known is None else known
    matches = [known.of(one, region, other, there) for region, there in regions]
    found = []
    for choice in range(max(map(len, matches))):
        pair = ShapePair(one, other)
        for (region, there), own in zip(regions, matches, strict=True):
            pair = _with_regions(pair, region, there, own[min(choice, len(own) - 1)])
        found.append(pair)
    return found


def region_pairs(one: OutlinedShape, other: OutlinedShape) -> list[tuple[int, int]]:
    """Return the indices of the regions of two shapes that belong together, equally many of both.

    These are near each other, relative to the centers of the shapes, and similar in size.
    """
    away = np.square(one.region_places[:, None] - other.region_places).sum(axis=2)
    return [(int(region), int(there)) for region, there in zip(*linear_sum_assignment(away), strict=True)]


def _are_similar(one: ClosedCurve, other: ClosedCurve) -> bool:
    """Return whether curves have the same points but for a translation and their size."""
    if len(one.points) != len(other.points):
        return False
    ours, theirs = ((curve.points - curve.points.mean(axis=0)) / curve.length for curve in (one, other))
    return bool(np.abs(ours - theirs).max() < _SIMILAR)


def _with_regions(pair: ShapePair, region: int, there: int, match: MatchedOutlines) -> ShapePair:
    """Add the match of the curves around two regions, and those of their holes."""
    one, other = pair.first, pair.second
    outer = one.regions[region].outer, other.regions[there].outer
    pair = pair.with_pair(CurvePair(*outer, match.map, match.swings, match.cost, match.turn, match.unrolled))
    holes = one.regions[region].holes, other.regions[there].holes
    there_map = _InsideMap(one.curves[outer[0]], other.curves[outer[1]], match.map)
    back_map = _InsideMap(other.curves[outer[1]], one.curves[outer[0]], match.map.inverse())
    images = np.array([there_map.at(one.center(hole)[None])[0] for hole in holes[0]]).reshape(-1, 2)
    centers = np.array([other.center(hole) for hole in holes[1]]).reshape(-1, 2)
    rows, columns = linear_sum_assignment(np.square(images[:, None] - centers).sum(axis=2))
    for row, column in zip(rows, columns, strict=True):
        first, second = holes[0][row], holes[1][column]
        # As it stands, a round hole would be twisted against an outline that turns.
        turned = one.curve(first).turned(there_map.turn(one.curves[first]))
        found = placed_outlines(turned, other.curve(second)).map
        pair = pair.with_pair(CurvePair(first, second, found, match.swings))
    for row in np.setdiff1d(np.arange(len(holes[0])), rows):
        pair = _with_lone_hole(pair, holes[0][row], there, there_map)
    for column in np.setdiff1d(np.arange(len(holes[1])), columns):
        pair = _with_lone_hole(pair.swapped(), holes[1][column], region, back_map).swapped()
    return pair


def _with_lone_hole(pair: ShapePair, hole: int, region: int, inside: _InsideMap) -> ShapePair:
    """Let a hole of the first shape shrink to a point in a region of the second one, if there is room."""
    curve = pair.first.curve(hole)
    turned = curve.turned(inside.turn(curve.curve)).curve
    grown = pair.second.with_point(turned, inside.at(curve.center[None])[0], region)
    if grown is None:
        return pair
    found = CurvePair(hole, len(grown.curves) - 1, even_map(turned, grown.curves[-1]))
    return replace(pair, second=grown).with_pair(found)


@dataclass(frozen=True)
class _InsideMap:
    """Maps what is inside a curve to the inside of another one, as their outlines are mapped.

    Attributes
    ----------
    curve, other : ClosedCurve
        The curves.
    around : CurveMap
        The map from the first to the second one.
    """

    curve: ClosedCurve
    other: ClosedCurve
    around: CurveMap

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the images of points, (k, 2)."""
        places = np.linspace(0.0, self.curve.length, _SAMPLES, endpoint=False)
        return polygon_coordinates(points, self.curve.at(places)) @ self.other.at(self.around(places))

    def turn(self, hole: ClosedCurve) -> float:
        """Return the angle in radians by which a curve inside turns."""
        points = hole.at(np.linspace(0.0, hole.length, _HOLE_SAMPLES, endpoint=False))
        images = self.at(points)
        return best_turn(points - points.mean(axis=0), images - images.mean(axis=0))
