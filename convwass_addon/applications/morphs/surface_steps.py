# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances between the surfaces of successive blends, and jumps where something appears or vanishes abruptly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, zip_longest

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.meshes.closest_points import TriangleSamples
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.point_tree import point_tree
from ...geometry.solids.orientation import orient_outward
from .frame_file import as_stored
from .layouts import Blend
from .morph_problem import MorphFrame
from .steady_topology import Leg, leg_with

# A step longer than this multiple of the median is a jump; the steps of blends computed again are limited to the
# second.
JUMP, _REACH = 1.8, 1.5
# Steps shorter than this multiple of the spacing of points are not jumps.
_LEAST = 1.5
# Legs with fewer blends have no usual step.
_FEWEST = 3
# Distances are measured at up to twice as many points of every surface; a few thousand miss the tips of ears.
_ASKED = 20_000
# Meshes are kept for this many of the longest steps.
_KEPT = 16
# Excess of the squared distance to the nearest point over that to the surface, as a fraction of the area per point.
_BESIDE = 0.35


@dataclass(frozen=True, eq=False)
class Chain:
    """Blends that should be computed again one after the other, each with a limited distance to the previous one.

    Attributes
    ----------
    beside : Blend
        The blend before the first one.
    near : MeasuredSurface
        The surface of that blend, unless it is computed again, too.
    reach : float
        Maximum distance, in scene units.
    blends : tuple of Blend
        All blends up to the end of the leg; usually fewer are needed.
    """

    beside: Blend
    near: MeasuredSurface
    reach: float
    blends: tuple[Blend, ...]


@dataclass(frozen=True)
class _Lengths:
    """The largest distance from a surface to the previous one, and vice versa."""

    appears: float
    vanishes: float

    @classmethod
    def between(cls, before: MeasuredSurface, after: MeasuredSurface) -> _Lengths:
        return cls(farthest(after, before), farthest(before, after))

    @property
    def longest(self) -> float:
        return max(self.appears, self.vanishes)


@dataclass(frozen=True)
class MeasuredSurface:
    """A surface, with points on it between which distances are measured.

    Attributes
    ----------
    mesh : TriangleMesh
        The surface, oriented outward.
    points : (n, 3) float64
        Points all over the surface.
    spacing : float
        The approximate distance between neighboring points.
    """

    mesh: TriangleMesh
    points: NDArray[np.float64]
    spacing: float

    @classmethod
    def of_blend(cls, mesh: TriangleMesh) -> MeasuredSurface:
        """Take the vertices of a blend, which lie evenly on its surface.

        They are rounded as in the cache, so that steps do not depend on whether the blend was read from there.
        """
        mesh = as_stored(mesh)
        return cls(mesh, mesh.vertices, float(np.sqrt(mesh.area / len(mesh.vertices))))

    @classmethod
    def of_shape(cls, mesh: TriangleMesh) -> MeasuredSurface:
        """Take points on the triangles of a shape, which may be large."""
        points = TriangleSamples.of(mesh.corners).points
        return cls(orient_outward(mesh), points, float(np.sqrt(mesh.area / len(points))))

    @cached_property
    def tree(self) -> cKDTree:
        """The search tree of the points; every surface is compared with the one before and the one after."""
        return point_tree(self.points)


@dataclass(frozen=True)
class _Step:
    """A step between two frames.

    Attributes
    ----------
    place : int
        Index of the second frame in its leg; the first shape has the index 0.
    lengths : _Lengths
        Lengths of the step.
    before, after : MeasuredSurface
        The two surfaces.
    """

    place: int
    lengths: _Lengths
    before: MeasuredSurface
    after: MeasuredSurface


class SurfaceSteps:
    """Measures the steps between frames in order, and finds jumps.

    Parameters
    ----------
    legs : sequence of Leg
        Legs of the bake.
    shapes : mapping of Blend to TriangleMesh, optional
        The unblended shapes at the ends of legs, in scene space. Without them, first and last steps are not measured.
    """

    def __init__(self, legs: Sequence[Leg], shapes: Mapping[Blend, TriangleMesh] | None = None) -> None:
        self._legs, self._shapes = legs, shapes or {}
        self._places = {pair: (leg, place) for leg in legs for place, pair in enumerate(pairwise(leg.whole), start=1)}
        self._lengths: dict[Leg, dict[int, _Lengths]] = {leg: {} for leg in legs}
        self._longest: dict[Leg, list[_Step]] = {leg: [] for leg in legs}
        self._last: tuple[Blend, MeasuredSurface] | None = None

    def add(self, frame: MorphFrame) -> None:
        """Measure the step from the previous frame to this one."""
        last, after = self._last, self._surface(frame)
        self._last = None if after is None else (frame.blend, after)
        if last is None or after is None or (last[0], frame.blend) not in self._places:
            return
        (leg, place), before = self._places[last[0], frame.blend], last[1]
        lengths = _Lengths.between(before, after)
        if place in (1, len(leg.between) + 1):
            # A shape cannot change, so the blends beside it change whether they have too much or too little.
            lengths = _Lengths(lengths.longest, lengths.longest)
        self._lengths[leg][place] = lengths
        longest = [*self._longest[leg], _Step(place, lengths, before, after)]
        self._longest[leg] = sorted(longest, key=lambda step: -step.lengths.longest)[:_KEPT]

    def _surface(self, frame: MorphFrame) -> MeasuredSurface | None:
        if frame.mesh is not None:
            return MeasuredSurface.of_blend(frame.mesh)
        shape = self._shapes.get(frame.blend)
        return None if shape is None or not len(shape.faces) else MeasuredSurface.of_shape(shape)

    def longest(self, blends: Sequence[Blend]) -> float:
        """Return the largest distance between successive surfaces of some neighboring blends, in either order."""
        found = [self._places.get((one, other)) or self._places[other, one] for one, other in pairwise(blends)]
        return max(self._lengths[leg][place].longest for leg, place in found)

    def usual(self, blend: Blend) -> float | None:
        """Return the median step between the blends of a leg; None if it has too few, or not all were added."""
        return self._usual(leg_with(self._legs, blend))

    def chains(self) -> list[Chain]:
        """Return the blends to compute again: those after something appears, and before something vanishes.

        What appears or vanishes beside a shape does so in the blends next to it. Of chains that go the same way, the
        one that starts first comes first, because it changes the surface that the next one starts from.
        """
        return [chain for leg in self._legs for chain in self._chains_of(leg)]

    def _usual(self, leg: Leg) -> float | None:
        lengths, blends = self._lengths[leg], len(leg.between)
        if blends < _FEWEST or any(place not in lengths for place in range(2, blends + 1)):
            return None
        return float(np.median([lengths[place].longest for place in range(2, blends + 1)]))

    def _chains_of(self, leg: Leg) -> list[Chain]:
        lengths, blends, usual = self._lengths[leg], len(leg.between), self._usual(leg)
        if usual is None:
            return []
        onwards, back = [], []
        for step in sorted(self._longest[leg], key=lambda step: step.place):
            place, least = step.place, max(JUMP * usual, _LEAST * max(step.before.spacing, step.after.spacing))
            # The last step is followed by no blend, and the first one preceded by none.
            if step.lengths.appears > least and place <= blends:
                coming = [lengths[i].appears for i in range(place, blends + 1)]
                reach = max(_REACH * usual, _even_step(coming))
                onwards.append(Chain(leg.whole[place - 1], step.before, reach, leg.whole[place:-1]))
            if step.lengths.vanishes > least and place > 1:
                gone = [lengths[i].vanishes for i in range(place, 1, -1)]
                reach = max(_REACH * usual, _even_step(gone))
                back.insert(0, Chain(leg.whole[place], step.after, reach, leg.whole[place - 1 : 0 : -1]))
        # Taking turns, neither way has precedence where they meet.
        return [chain for both in zip_longest(onwards, back) for chain in both if chain is not None]


def _even_step(lengths: Sequence[float]) -> float:
    """Return the smallest equal step that covers the distance of some first lengths: the least running mean."""
    return float((np.cumsum(lengths) / np.arange(1, len(lengths) + 1)).min())


def longest_step(surfaces: Sequence[MeasuredSurface]) -> float:
    """Return the largest distance between successive surfaces."""
    return max(_Lengths.between(*both).longest for both in pairwise(surfaces))


def farthest(asked: MeasuredSurface, other: MeasuredSurface) -> float:
    """Estimate the largest distance of a surface's points from another surface, using the points of both."""
    points = asked.points[:: max(len(asked.points) // _ASKED, 1)]
    found = other.tree.query(points)[0].max()
    return float(np.sqrt(max(found**2 - _BESIDE * other.spacing**2, 0.0)))
