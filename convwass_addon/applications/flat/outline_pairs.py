# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which closed curves of two flat shapes belong together; holes of only one shape shrink to a point of the other."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from ...geometry.closed_curves import ClosedCurve, boundary_of
from ...geometry.curve_maps import CurveMap, even_map
from ...geometry.planar_fill import Boundary
from ...geometry.plane_angles import best_turn, signed_angles
from ...geometry.ring_nesting import outline_of
from .matched_outlines import MatchedOutlines, matched_outlines, placed_outlines
from .outline_curves import OutlineCurve

# Corners at which curves touch are cut by this, relative to the square root of the area.
_GAP = 2e-3
# Shapes of more regions are not matched by their outlines.
_MOST_REGIONS = 32
# Extent of a hole that opens from a point, and its least distance from the outline, relative to the square root of the
# area; cells along both sides of the grid on which its place is sought; and samples of the outline.
_POINT, _INSIDE, _CELLS, _SAMPLES = 0.004, 0.03, 64, 256
# Largest angle, in radians, at which a point sees an edge of the outline; at pi it is on the edge.
_STRAIGHT = 3.1
# Samples of a hole by which its turn is measured.
_HOLE_SAMPLES = 48


@dataclass(frozen=True)
class OutlinedShape:
    """A flat shape as closed curves.

    Attributes
    ----------
    filled : Boundary
        The shape.
    curves : tuple of ClosedCurve
        Curves around its regions and holes; last, points that are holes of other shapes.
    outer : tuple of int
        Indices of the curves around its regions.
    holes : tuple of tuple of int
        Indices of the curves around the holes of every region.
    """

    filled: Boundary
    curves: tuple[ClosedCurve, ...]
    outer: tuple[int, ...]
    holes: tuple[tuple[int, ...], ...]

    @classmethod
    def of(cls, filled: Boundary) -> OutlinedShape:
        """Divide a boundary into curves."""
        outline = outline_of(filled)
        curves = _apart([ClosedCurve(ring) for ring in outline.rings], _GAP * np.sqrt(filled.area))
        sizes = [1 + len(region.holes) for region in outline.regions]
        outer = [end - size for end, size in zip(accumulate(sizes), sizes, strict=True)]
        holes = tuple(tuple(range(first + 1, first + size)) for first, size in zip(outer, sizes, strict=True))
        return cls(filled, tuple(curves), tuple(outer), holes)

    @property
    def size(self) -> float:
        """Square root of the area."""
        return float(np.sqrt(self.filled.area))

    def center(self, index: int) -> NDArray[np.float64]:
        """Center of what a curve encloses, (2,)."""
        return boundary_of([self.curves[index]]).center

    def curve(self, index: int) -> OutlineCurve:
        """Return a curve to be matched."""
        return OutlineCurve(self.curves[index], self.filled, self.center(index))

    def with_point(self, hole: ClosedCurve, place: NDArray[np.float64]) -> OutlinedShape | None:
        """Return the shape with a tiny copy of another shape's hole near a place; None if it has no room."""
        steps = (np.arange(_CELLS) + 0.5) / _CELLS
        x, y = np.meshgrid(*(low + (high - low) * steps for low, high in self.filled.bounds.T), indexing="ij")
        cells = np.concatenate([place[None], np.stack([x.ravel(), y.ravel()], axis=1)])
        spacing = _INSIDE * self.size / 3.0
        rim = np.concatenate([curve.resampled(curve.starts[:-1], spacing).points for curve in self.curves])
        free = self.filled.contains(cells) & (cKDTree(rim).query(cells)[0] > _INSIDE * self.size)
        if not free.any():
            return None
        spot = cells[free][np.square(cells[free] - place).sum(axis=1).argmin()]
        scale = _POINT * self.size / np.ptp(hole.points, axis=0).max()
        point = ClosedCurve(spot + (hole.points - boundary_of([hole]).center) * scale)
        return replace(self, curves=(*self.curves, point))


def _apart(curves: list[ClosedCurve], gap: float) -> list[ClosedCurve]:
    """Cut the corners at which curves touch each other or themselves, so that they can move apart."""
    points = np.concatenate([curve.points for curve in curves])
    _, index, counts = np.unique(points, axis=0, return_inverse=True, return_counts=True)
    touches = np.split(counts[index.ravel()] > 1, np.cumsum([len(curve.points) for curve in curves])[:-1])
    found = []
    for curve, own in zip(curves, touches, strict=True):
        lengths = np.diff(curve.starts)
        before, after = (np.minimum(gap, 0.5 * own_lengths) for own_lengths in (np.roll(lengths, 1), lengths))
        kept, cut = curve.starts[:-1][~own], curve.starts[:-1][own]
        places = np.sort(np.concatenate([kept, cut - before[own], cut + after[own]]))
        found.append(ClosedCurve(curve.at(places)) if own.any() else curve)
    return found


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
    """

    first: int
    second: int
    map: CurveMap
    slides: bool = False

    def swapped(self) -> CurvePair:
        """Return the pair with the shapes swapped."""
        return replace(self, first=self.second, second=self.first, map=self.map.inverse())


@dataclass(frozen=True)
class ShapePair:
    """Two shapes whose outlines are mapped onto each other.

    Attributes
    ----------
    first, second : OutlinedShape
        The shapes, with points that are holes of the other one.
    pairs : tuple of CurvePair
        Curves that belong together.
    outer : tuple of MatchedOutlines
        The matches of the curves around regions.
    """

    first: OutlinedShape
    second: OutlinedShape
    pairs: tuple[CurvePair, ...] = ()
    outer: tuple[MatchedOutlines, ...] = ()

    def swapped(self) -> ShapePair:
        """Return the pair with the shapes swapped."""
        return ShapePair(self.second, self.first, tuple(pair.swapped() for pair in self.pairs), self.outer)

    def with_pair(self, pair: CurvePair) -> ShapePair:
        """Return the shapes with two more curves that belong together."""
        return replace(self, pairs=(*self.pairs, pair))


def matched_shapes(one: OutlinedShape, other: OutlinedShape) -> list[ShapePair]:
    """Match the closed curves of two shapes: as they are placed, and perhaps also as if limbs swung.

    There is no match of shapes of different numbers of regions, or of too many. Regions belong together that are near
    each other, relative to the centers of the shapes, and similar in size.
    """
    if len(one.outer) != len(other.outer) or not 1 <= len(one.outer) <= _MOST_REGIONS:
        return []
    places = []
    for shape in (one, other):
        filled = [boundary_of([shape.curves[index]]) for index in shape.outer]
        centers = np.array([own.center for own in filled]) - shape.filled.center
        places.append(np.column_stack([centers, np.sqrt([own.area for own in filled])]))
    away = np.square(places[0][:, None] - places[1]).sum(axis=2)
    regions = [(int(region), int(there)) for region, there in zip(*linear_sum_assignment(away), strict=True)]
    matches = [
        matched_outlines(one.curve(one.outer[region]), other.curve(other.outer[there])) for region, there in regions
    ]
    found = []
    for choice in range(max(map(len, matches))):
        pair = ShapePair(one, other)
        for (region, there), own in zip(regions, matches, strict=True):
            pair = _with_regions(pair, region, there, own[min(choice, len(own) - 1)])
        found.append(pair)
    return found


def _with_regions(pair: ShapePair, region: int, there: int, match: MatchedOutlines) -> ShapePair:
    """Add the match of the curves around two regions, and those of their holes."""
    one, other = pair.first, pair.second
    outer = one.outer[region], other.outer[there]
    pair = replace(pair.with_pair(CurvePair(*outer, match.map, match.swings)), outer=(*pair.outer, match))
    holes = one.holes[region], other.holes[there]
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
        pair = _with_lone_hole(pair, holes[0][row], there_map)
    for column in np.setdiff1d(np.arange(len(holes[1])), columns):
        pair = _with_lone_hole(pair.swapped(), holes[1][column], back_map).swapped()
    return pair


def _with_lone_hole(pair: ShapePair, hole: int, inside: _InsideMap) -> ShapePair:
    """Let a hole of the first shape shrink to a point of the second one, if there is room."""
    curve = pair.first.curve(hole)
    turned = curve.turned(inside.turn(curve.curve)).curve
    grown = pair.second.with_point(turned, inside.at(curve.center[None])[0])
    if grown is None:
        return pair
    found = CurvePair(hole, len(grown.curves) - 1, even_map(turned, grown.curves[-1]))
    return replace(pair, second=grown).with_pair(found)


@dataclass(frozen=True)
class _InsideMap:
    """Maps what is inside a curve to the inside of another one, as their outlines are mapped.

    M. Floater, "Mean value coordinates", Computer Aided Geometric Design 20(1), 2003.

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
        toward = self.curve.at(places) - points[:, None]
        away = np.maximum(np.linalg.norm(toward, axis=2), np.finfo(np.float64).eps * self.curve.length)
        angles = signed_angles(toward, np.roll(toward, -1, axis=1))
        tangents = np.tan(0.5 * np.clip(angles, -_STRAIGHT, _STRAIGHT))
        weights = (tangents + np.roll(tangents, 1, axis=1)) / away
        return weights @ self.other.at(self.around(places)) / weights.sum(axis=1, keepdims=True)

    def turn(self, hole: ClosedCurve) -> float:
        """Return the angle in radians by which a curve inside turns."""
        points = hole.at(np.linspace(0.0, hole.length, _HOLE_SAMPLES, endpoint=False))
        images = self.at(points)
        return best_turn(points - points.mean(axis=0), images - images.mean(axis=0))
