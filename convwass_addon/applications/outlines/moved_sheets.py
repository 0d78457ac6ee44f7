# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes that move as their matched outlines do, and what that does to their insides."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.foldover_free import UNDISTORTED, DeformedTriangles
from ...geometry.deformation.travel import travel
from ...geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.plane.closed_curves import boundary_of
from ...geometry.plane.coverage import self_overlap
from ...progress import Control
from ..motions.coherence import FULL_COHERENCE
from ..motions.guided_motion import GuidedMotion, GuidedPair
from ..motions.guided_settings import GuidedSettings
from ..motions.motion import Motion, weights_between
from ..motions.motion_choice import MotionChoice
from ..registrations.carriers import Carrier, carrier_of
from ..registrations.laid_meshes import Laid
from ..registrations.shape_deformations import ShapeDeformation, split_deformation
from ..workers import both_ways, side_by_side
from .agreeing_motion import AgreeingMotion
from .outline_meshes import filled_outline, outline_knots, region_labels, region_meshes
from .outline_pairs import KnownMatches, ShapePair, matched_shapes, vanishing_share
from .outlined_shape import OutlinedShape
from .sheets import Sheet
from .sliding_outlines import effort

TRIANGLES = 0.028
"""Edge length of the triangles, relative to the size of the shape."""

# Carriers have at least this number of vertices, and are never coarser than the shapes.
_VERTICES = 6000
# Times at which shapes are checked for overlaps, and cells along the longest side of the grid for that.
_TIMES, _CELLS = (0.25, 0.5, 0.75), 128
# Shapes whose insides would be distorted by more than the first number, or whose outlines match with a lower score than
# the second one, are transported, if the user chose no motion: a spiral that becomes a wave has 68, a C that becomes
# a D 32 and a B that becomes an E 23; the score of a spiral to a snowflake is 0.08, that of a heart to a star 0.22.
_MOST_DISTORTED, _LEAST_SCORE = 30.0, 0.135
# So are shapes of several regions of which more than this share would overlap on the way: three dots that become four
# arcs have 0.06, a percent sign that becomes an X 0.035, and all others that were tried at most 0.01.
_MOST_OVERLAP = 0.03
# Costs of shares of the area that grow from points or overlap themselves, in units of the distortion.
_VANISHING, _OVERLAPPING = 10.0, 50.0


@dataclass(frozen=True)
class MovedSheets:
    """Flat shapes that move as a body.

    Attributes
    ----------
    sheets : tuple of Sheet
        The shapes.
    choice : MotionChoice
        Their motion.
    score : float
        Least score of a match.
    distortion : float
        By how much it distorts their insides: 3 for similar shapes, 4 to 25 for letters.
    overlap : float
        Largest share of their area that overlaps itself on the way.
    vanishing : float
        Largest share of their area that grows from points, or shrinks to them.
    regions : int
        Number of regions of each.
    travel : float
        How far their insides move, at most; see :mod:`.travel`.
    """

    sheets: tuple[Sheet, ...]
    choice: MotionChoice
    score: float = 1.0
    distortion: float = 0.0
    overlap: float = 0.0
    vanishing: float = 0.0
    regions: int = 1
    travel: float = 0.0

    @property
    def effort(self) -> float:
        """What is to be small if shapes should not move far either."""
        return effort(self.cost, self.travel)

    @property
    def cost(self) -> float:
        """What is to be small, in units of the distortion."""
        return self.distortion + _VANISHING * self.vanishing + _OVERLAPPING * self.overlap

    @property
    def is_distorted(self) -> bool:
        """Whether shapes would be distorted, or overlap, too much."""
        overlaps = self.regions > 1 and self.overlap > _MOST_OVERLAP
        return self.distortion > _MOST_DISTORTED or self.score < _LEAST_SCORE or overlaps


@dataclass(frozen=True)
class MatchedShapes:
    """Flat shapes, with points that are holes of other ones, and the matches of those that occur together."""

    shapes: list[OutlinedShape]
    matches: dict[tuple[int, int], ShapePair]

    @classmethod
    def of(
        cls,
        shapes: Sequence[OutlinedShape],
        pairs: Sequence[tuple[int, int]],
        choose: Callable[[Sequence[ShapePair], Control], ShapePair],
        known: KnownMatches,
        control: Control,
    ) -> MatchedShapes:
        """Match shapes of equal numbers of regions. Of several matches, one is chosen."""
        grown, matches = list(shapes), {}
        for one, other in pairs:
            control.check()
            match = choose(matched_shapes(grown[one], grown[other], known), control)
            matches[one, other], grown[one], grown[other] = match, match.first, match.second
        # Later pairs have added points to the shapes.
        whole = {
            (one, other): replace(match, first=grown[one], second=grown[other])
            for (one, other), match in matches.items()
        }
        return cls(grown, whole)

    @property
    def swings(self) -> bool:
        """Whether limbs swing in a match."""
        return any(match.swings for match in self.matches.values())

    @property
    def unrolls(self) -> bool:
        """Whether regions are matched as strokes."""
        return any(match.unrolled > 0.0 for match in self.matches.values())

    @property
    def turns(self) -> bool:
        """Whether one of several regions turns in a match."""
        return any(len(match.regions) > 1 and match.turns for match in self.matches.values())


def least_cost(shapes: Sequence[OutlinedShape], pairs: Sequence[tuple[int, int]]) -> float:
    """Return a lower bound of the cost of moving shapes: that without any distortion or overlap."""
    vanishing = (vanishing_share(shapes[one], shapes[other]) for one, other in pairs)
    return UNDISTORTED + _VANISHING * max(vanishing, default=0.0)


def moved_sheets(
    matched: MatchedShapes, names: Sequence[str], settings: GuidedSettings, control: Control
) -> MovedSheets:
    """Return the motion of matched shapes."""
    shapes, matches = matched.shapes, matched.matches
    knots = outline_knots(shapes, matches)
    sheets = tuple(side_by_side(lambda shape: _sheet(shapes[shape], knots[shape]), len(shapes)))
    # Nothing is left for what resists stretching.
    coherence = min(settings.coherence, FULL_COHERENCE)
    most = max(len(sheet.mesh.vertices) for sheet in sheets)
    settings = replace(settings, coherence=coherence, carrier_vertices=max(2 * most, _VERTICES))
    count = settings.carrier_vertices
    carriers = tuple(
        side_by_side(lambda shape: carrier_of(sheets[shape].mesh, names[shape], count, control), len(sheets))
    )
    if matched.unrolls:
        carriers = tuple(carrier.following_gradients() for carrier in carriers)
    labels = [region_labels(carrier.mesh, shape) for carrier, shape in zip(carriers, shapes, strict=True)]
    deformations: dict[tuple[int, int], ShapeDeformation] = {}
    distortion = traveled = 0.0
    for (one, other), match in matches.items():
        ends, own = (carriers[one], carriers[other]), (labels[one], labels[other])
        deformed = _DeformedPair.of(ends, own, match, control)
        deformations[one, other], deformations[other, one] = deformed.there, deformed.back
        distortion, traveled = max(distortion, deformed.distortion), max(traveled, deformed.travel)
    known = {pair: _figures(match) for pair, match in matches.items()}
    motion = AgreeingMotion(GuidedMotion(carriers, deformations, known, settings))
    turned = max((abs(pair.turn) for pair in known.values()), default=0.0)
    choice = MotionChoice("guided", "OUTLINES", motion, turned=turned)
    overlap = max((largest_overlap(sheets, motion, pair) for pair in matches), default=0.0)
    vanishing = max((vanishing_share(match.first, match.second) for match in matches.values()), default=0.0)
    score = min((pair.score for pair in known.values()), default=1.0)
    regions = max(len(shape.regions) for shape in shapes)
    return MovedSheets(sheets, choice, score, distortion, overlap, vanishing, regions, traveled)


@dataclass(frozen=True)
class _DeformedPair:
    """Two shapes deformed to match each other.

    Attributes
    ----------
    there, back : ShapeDeformation
        Of the first shape, and of the second one.
    distortion : float
        By how much their insides are distorted, at most.
    travel : float
        How far these move, at most; see :mod:`.travel`.
    """

    there: ShapeDeformation
    back: ShapeDeformation
    distortion: float
    travel: float

    @classmethod
    def of(
        cls,
        ends: tuple[Carrier, Carrier],
        labels: tuple[NDArray[np.int64], NDArray[np.int64]],
        match: ShapePair,
        control: Control,
    ) -> _DeformedPair:
        """Deform two shapes region by region."""
        own = labels[0], _counterparts(match)[labels[1]]
        ways = match, match.swapped()

        def filled(k: int) -> tuple[DeformedTriangles, ClosestPoints]:
            found = filled_outline(ends[k].mesh, ways[k], control)
            return found, _images(found, own[k], ends[1 - k].mesh, own[1 - k], control)

        # The samples of both shapes are needed for both directions.
        both_ways(lambda k: ends[k].samples)
        (first, images), (second, images_back) = both_ways(filled)
        there = split_deformation(*ends, _laid(first), None, control, images, np.inf)
        back = split_deformation(*ends[::-1], _laid(second), there, control, images_back, np.inf)
        moved = zip(ends, (first, second), ways, strict=True)
        traveled = max(travel(end.mesh, found.points, way.turn) for end, found, way in moved)
        return cls(there, back, max(first.distortion, second.distortion), traveled)


def largest_overlap(sheets: Sequence[Sheet], motion: Motion, pair: tuple[int, int]) -> float:
    """Return the largest share of the area of a shape that overlaps itself at some times on its way to another one."""

    def overlap(number: int) -> float:
        moved = motion.moved(weights_between(len(sheets), pair, _TIMES[number]))[pair[0]]
        return self_overlap(sheets[pair[0]].moved(moved), _CELLS)

    return max(side_by_side(overlap, len(_TIMES)))


def _figures(match: ShapePair) -> GuidedPair:
    """Return the figures of a match; of several regions, those of the worst and of the one that turned most."""
    work = max(pair.cost for pair in match.pairs)
    turn = max((pair.turn for pair in match.pairs), key=abs)
    return GuidedPair(score=float(np.exp(-work)), guides_left_out=0, detour=1.0, turn=float(np.degrees(turn)))


def _sheet(shape: OutlinedShape, knots: Sequence[NDArray[np.float64]]) -> Sheet:
    """Triangulate a shape, with vertices at the knots of every curve."""
    exact = [curve.with_places(own) for curve, own in zip(shape.curves, knots, strict=True)]
    meshes = region_meshes(shape, knots, TRIANGLES)
    return Sheet.joined(
        [
            Sheet.attached(boundary_of([exact[index] for index in region.curves]), mesh)
            for region, mesh in zip(shape.regions, meshes, strict=True)
        ]
    )


def _laid(filled: DeformedTriangles) -> Laid:
    """Return positions in space."""
    return Laid(_in_space(filled.points), np.ones(len(filled.points)))


def _counterparts(match: ShapePair) -> NDArray[np.int64]:
    """Return the region of the first shape that each region of the second one belongs to."""
    found = np.empty(len(match.second.regions), np.int64)
    for region, there in match.regions:
        found[there] = region
    return found


def _images(
    filled: DeformedTriangles,
    ours: NDArray[np.int64],
    mesh: TriangleMesh,
    theirs: NDArray[np.int64],
    control: Control,
) -> ClosestPoints:
    """Return the points of another mesh, whose vertices have labels, that deformed vertices of equal labels lie on."""
    points = _in_space(filled.points)
    triangles, shares = np.empty(len(points), np.int64), np.empty((len(points), 3))
    distances = np.empty(len(points))
    for label in np.unique(ours):
        own, others = np.flatnonzero(ours == label), np.flatnonzero(theirs[mesh.faces[:, 0]] == label)
        found = ClosestPointFinder(mesh.corners[others]).find(points[own], control)
        triangles[own], shares[own], distances[own] = others[found.triangles], found.shares, found.distances
    return ClosestPoints(triangles, shares, distances)


def _in_space(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points of the plane z = 0, (n, 3)."""
    return np.column_stack([points, np.zeros(len(points))])
