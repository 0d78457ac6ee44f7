# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Let a mapped outline slide along the other one where limbs swing, so that limbs keep their lengths.

Matched outlines do not know what is on the other side of a limb: both sides of an arm that bends may stretch in
different places. Corners that match stay where they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.travel import travel
from ...geometry.deformation.unit_shape import UnitShape
from ...geometry.meshes.mesh import TriangleMesh, joined_meshes
from ...geometry.plane.closed_curves import ClosedCurve
from ...geometry.plane.curve_maps import CurveMap
from ...progress import Control
from ..workers import side_by_side
from .outline_curves import sharp_corners
from .outline_meshes import Rim, filled_outline, outline_knots, region_meshes
from .outline_pairs import CurvePair, ShapePair
from .outlined_shape import OutlinedShape

# Edge length of the triangles, relative to the size of the shape.
_TRIANGLES = 0.045
# A match takes clearly less effort with this share of that of another one.
_LESS = 0.93
# Strokes that become more than the first number of times as large where they unroll do so only with the second share.
# By eye, an S that becomes a Z (0.62) and a w that becomes an s (0.60) are better so, and a pi that becomes a W (0.89)
# keeps its size better.
_GROWN, _CLEARLY_LESS = 1.2, 0.7
# The effort is the distortion, times e to the power of this multiple of the travel. By eye, an N that becomes an E
# should not turn by 60 degrees on the way (from 1.1 on it does not: distortion 14.6, travel 0.89, and if it turns 8.3
# and 1.34), and an S should become a Z as a stroke (up to 1.5: 10.6, 0.66, and as a stroke 4.0 and 1.08).
_TRAVELING = 1.2
# Travel up to this much counts less, by its square: limbs that bend a little travel, too. By eye, the ends of an O
# should open to become a C (distortion 3.56, travel 0.24 as placed, and 3.08, 0.34), and the bars of an equals sign
# should bend to become an H (6.3, 0.32, and 5.1, 0.49), but a J should not lean to become a U (3.9, 0.42 as placed, and
# 3.3, 0.56).
_LITTLE = 2.0 / 3.0
# Rounds, size of the neighborhoods that turn together, and strain at which the inside yields.
_ROUNDS, _WIDTH, _GIVE = 20, 0.04, 0.2
# Stiffness of the springs that hold a vertex on the outline, per area, and the share of it that resists sliding.
_HELD, _GRIP = 1e4, 2e-4
# Largest step of a vertex per round, relative to the size of the shape, and least speed relative to the mean one.
_STEP, _LEAST_SPEED = 0.03, 0.1
# A corner matches another one if they are this close, and tangents are measured over this distance, relative to the
# length of the curve.
_SAME, _ALONG = 1e-4, 1e-3


@dataclass(frozen=True)
class _Slide:
    """Vertices on a curve that slide along another one.

    Attributes
    ----------
    pair : CurvePair
        The curves.
    curve, other : ClosedCurve
        The curve that the vertices are on, and the one that they are mapped to.
    vertices : (k,) int64
        Indices of the vertices, in order.
    places, images : (k,) float64
        Their places on both curves, increasing.
    is_held : (k,) bool
        Whether each stays where it is: corners of both curves, and all of curves that do not slide.
    """

    pair: CurvePair
    curve: ClosedCurve
    other: ClosedCurve
    vertices: NDArray[np.int64]
    places: NDArray[np.float64]
    images: NDArray[np.float64]
    is_held: NDArray[np.bool_]

    @classmethod
    def of(cls, rim: Rim, match: ShapePair, pair: CurvePair) -> _Slide:
        """Return the vertices of a rim on a curve."""
        curve, other = match.first.curves[pair.first], match.second.curves[pair.second]
        vertices, places = rim.on(pair.first)
        images = pair.map(places)
        is_held = _are_corners(curve, places) & _are_corners(other, images) | (not pair.slides)
        return cls(pair, curve, other, vertices, places, images, is_held)

    @property
    def targets(self) -> NDArray[np.float64]:
        """Points that the vertices are mapped to, (k, 2)."""
        return self.other.at(self.images)

    @property
    def tangents(self) -> NDArray[np.float64]:
        """Unit tangents of the other curve there, (k, 2)."""
        beside = _ALONG * self.other.length
        along = self.other.at(self.images + beside) - self.other.at(self.images - beside)
        return along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(np.float64).tiny)

    def moved(self, steps: NDArray[np.float64]) -> _Slide:
        """Return the vertices after steps along the other curve, (k,), without one passing another."""
        if not self.pair.slides:
            return self
        images = self.images + np.where(self.is_held, 0.0, steps)
        ratio = self.other.length / self.curve.length
        least = _LEAST_SPEED * ratio * np.diff(self.places, append=self.places[0] + self.curve.length)
        gaps = np.diff(images, append=images[0] + self.other.length)
        if (gaps >= least).all():
            return replace(self, images=images)
        bounds = np.flatnonzero(self.is_held) if self.is_held.any() else np.zeros(1, np.int64)
        gaps = np.roll(np.maximum(gaps, least), -bounds[0])
        ends = np.append(images[bounds], images[bounds[0]] + self.other.length)
        for (low, high), (begin, end) in zip(
            pairwise(np.append(bounds, bounds[0] + len(images)) - bounds[0]), pairwise(ends), strict=True
        ):
            gaps[low:high] *= (end - begin) / gaps[low:high].sum()
        spread = images[bounds[0]] + np.concatenate([[0.0], np.cumsum(gaps[:-1])])
        spread[len(images) - bounds[0] :] -= self.other.length
        return replace(self, images=np.roll(spread, bounds[0]))

    @property
    def mapped(self) -> CurvePair:
        """The curves with the map that the vertices tell."""
        if not self.pair.slides:
            return self.pair
        lengths = self.curve.length, self.other.length
        places = np.append(self.places, self.places[0] + lengths[0])
        images = np.append(self.images, self.images[0] + lengths[1])
        return replace(self.pair, map=CurveMap(places, images, lengths))


def _with_slid_outlines(match: ShapePair, control: Control) -> ShapePair:
    """Return the match of two shapes after the outline of one has slid along that of the other one."""
    if not match.swings:
        return match
    # A canonical order, so that a pair has the same result whatever the order of the shapes.
    if _length(match.first) < _length(match.second):
        return _with_slid_outlines(match.swapped(), control).swapped()
    mesh = _coarse_mesh(match)
    unit, rim, size = UnitShape.of(mesh), Rim.of(mesh, match.first), mesh.root_area
    start = filled_outline(mesh, match, control).points
    center = start.mean(axis=0)
    slides = [_Slide.of(rim, match, pair) for pair in match.pairs]
    stiffness = _HELD * np.maximum(unit.areas, unit.areas[unit.areas > 0].min())
    points = np.column_stack([(start - center) / size, np.zeros(len(start))])
    for _ in range(_ROUNDS):
        control.check()
        springs, pulls = np.zeros((len(points), 3, 3)), np.zeros((len(points), 3))
        for slide in slides:
            own, tangents = slide.vertices, slide.tangents
            along = np.einsum("ni,nj->nij", tangents, tangents)
            free = np.where(slide.is_held, 0.0, 1.0 - _GRIP)[:, None, None]
            springs[own, :2, :2] = stiffness[own][:, None, None] * (np.eye(2) - free * along)
            springs[own, 2, 2] = stiffness[own]
            pulls[own, :2] = np.einsum("nij,nj->ni", springs[own, :2, :2], (slide.targets - center) / size)
        points = unit.elastic.relaxed_robustly(points, springs, pulls, _WIDTH, _GIVE)
        points[:, 2] = 0.0
        slides = [_slid(slide, size * points[:, :2] + center, _STEP * size) for slide in slides]
    return replace(match, pairs=tuple(slide.mapped for slide in slides))


def effort(distortion: float, traveled: float) -> float:
    """Return what is to be small: by how much the inside is distorted, and more if it moves far; see :mod:`.travel`.

    Parts that move far without need tumble, or swing over others.
    """
    little = min(traveled, _LITTLE)
    return distortion * float(np.exp(_TRAVELING * (traveled - little + little**2 / (2.0 * _LITTLE))))


def least_effort(matches: Sequence[ShapePair], control: Control) -> ShapePair:
    """Slide matched outlines; return the match that takes clearly less effort than those before it."""
    if len(matches) == 1:
        return _with_slid_outlines(matches[0], control)

    def slid(number: int) -> tuple[ShapePair, float]:
        match = _with_slid_outlines(matches[number], control)
        return match, _effort(match, control)

    (best, least), *others = side_by_side(slid, len(matches))
    for match, found in others:
        if found < (_CLEARLY_LESS if match.unrolled > _GROWN else _LESS) * least:
            best, least = match, found
    return best


def _effort(match: ShapePair, control: Control) -> float:
    """Return the effort of a match for the shape of the longer outline."""
    if _length(match.first) < _length(match.second):
        return _effort(match.swapped(), control)
    mesh = _coarse_mesh(match)
    filled = filled_outline(mesh, match, control)
    return effort(filled.distortion, travel(mesh, filled.points, match.turn))


def _coarse_mesh(match: ShapePair) -> TriangleMesh:
    """Triangulate the first of two shapes."""
    knots = outline_knots([match.first, match.second], {(0, 1): match})[0]
    return joined_meshes(region_meshes(match.first, knots, _TRIANGLES))


def _length(shape: OutlinedShape) -> float:
    """Return the length of a shape's outline."""
    return sum(curve.length for curve in shape.curves)


def _slid(slide: _Slide, points: NDArray[np.float64], most: float) -> _Slide:
    """Move vertices along the other curve to where the elastic inside, (n, 2), has drawn them."""
    away = ((points[slide.vertices] - slide.targets) * slide.tangents).sum(axis=1)
    return slide.moved(np.clip(away, -most, most))


def _are_corners(curve: ClosedCurve, places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether places are corners of a curve."""
    return np.abs(curve.to_nearest(places, sharp_corners(curve))) < _SAME * curve.length
