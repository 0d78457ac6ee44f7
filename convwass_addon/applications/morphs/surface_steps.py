# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far surfaces go from blend to blend, and where one goes so far that something pops up or vanishes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ...geometry.mesh import TriangleMesh
from .layouts import Blend
from .morph_problem import MorphFrame
from .steady_topology import Leg

# A step of more than so many times the usual one is a jump; those that are made again go so many times as far at most.
_JUMP, _REACH = 1.8, 1.5
# Steps shorter than so many times the distance of the vertices are no jumps.
_LEAST = 1.5
# So many vertices of every surface are asked how far the next one is.
_ASKED = 2500
# The meshes of so many steps are kept, the longest; from a number of steps on only of those that are so many times as
# long as the usual one by then.
_KEPT, _FIRST, _LONG = 16, 4, 1.2
# Share of the area about a vertex by which squared distances to the nearest vertex exceed those to the surface.
_BESIDE = 0.35


@dataclass(frozen=True)
class Chain:
    """Blends that are to be made again one after the other, each near the one before.

    Attributes
    ----------
    beside : Blend
        What the first one is to be near to.
    near : TriangleMesh
        Its surface, unless it is made again as well.
    reach : float
        How near, in scene units.
    blends : tuple of Blend
        As many as may be needed.
    """

    beside: Blend
    near: TriangleMesh
    reach: float
    blends: tuple[Blend, ...]


@dataclass(frozen=True)
class _Lengths:
    """How far a surface is from the one before at the most, and that one from it."""

    appears: float
    vanishes: float

    @property
    def longest(self) -> float:
        return max(self.appears, self.vanishes)


@dataclass(frozen=True)
class _Step:
    """From one blend to the next.

    Attributes
    ----------
    place : int
        Of the second blend in its leg.
    lengths : _Lengths
        How far it goes.
    before, after : TriangleMesh
        Both surfaces.
    """

    place: int
    lengths: _Lengths
    before: TriangleMesh
    after: TriangleMesh


class SurfaceSteps:
    """Hears of frames in their order, and says where surfaces jump.

    Parameters
    ----------
    legs : sequence of Leg
        Of the bake.
    """

    def __init__(self, legs: Sequence[Leg]) -> None:
        self._legs = legs
        self._places = {blend: (leg, i) for leg in legs for i, blend in enumerate(leg.between)}
        self._lengths: dict[Leg, list[_Lengths]] = {leg: [] for leg in legs}
        self._longest: dict[Leg, list[_Step]] = {leg: [] for leg in legs}
        self._last: MorphFrame | None = None

    def hear(self, frame: MorphFrame) -> None:
        """Measure the step to a frame from the one before it."""
        leg, place = self._places.get(frame.blend, (None, 0))
        last, self._last = self._last, frame
        if leg is None or frame.mesh is None or last is None or self._places.get(last.blend) != (leg, place - 1):
            return
        appears, vanishes = farthest(frame.mesh, last.mesh), farthest(last.mesh, frame.mesh)
        step = _Step(place, _Lengths(appears, vanishes), last.mesh, frame.mesh)
        self._lengths[leg].append(step.lengths)
        least = _LONG * self._usual(leg) if len(self._lengths[leg]) > _FIRST else 0.0
        longest = sorted([*self._longest[leg], step], key=lambda one: -one.lengths.longest)
        self._longest[leg] = [one for one in longest[:_KEPT] if one.lengths.longest >= least]

    def _usual(self, leg: Leg) -> float:
        return float(np.median([step.longest for step in self._lengths[leg]]))

    def chains(self) -> list[Chain]:
        """Return what should be made again: blends after what appears, and blends before what vanishes."""
        return [chain for leg in self._legs for chain in self._chains_of(leg)]

    def _chains_of(self, leg: Leg) -> list[Chain]:
        if len(self._lengths[leg]) < max(len(leg.between) - 1, 2):
            return []
        lengths = self._lengths[leg]
        usual = self._usual(leg)
        found = []
        for step in sorted(self._longest[leg], key=lambda step: step.place):
            place, least = step.place, max(_JUMP * usual, _LEAST * _spacing(step.after))
            first, second = leg.between[place - 1 : place + 1]
            if step.lengths.appears > least:
                coming = [one.appears for one in lengths[place - 1 :]]
                reach = max(_REACH * usual, _even_step(coming))
                found.append(Chain(first, step.before, reach, leg.between[place:]))
            if step.lengths.vanishes > least:
                gone = [one.vanishes for one in lengths[place - 1 :: -1]]
                reach = max(_REACH * usual, _even_step(gone))
                found.append(Chain(second, step.after, reach, leg.between[place - 1 :: -1]))
        return found


def _even_step(lengths: Sequence[float]) -> float:
    """Return the least step with which one gets as far as these lead, some time before they end."""
    return float((np.cumsum(lengths) / np.arange(1, len(lengths) + 1)).min())


def farthest(asked: TriangleMesh, other: TriangleMesh) -> float:
    """Return about how far the points of one surface are from another one at the most, by the vertices of both."""
    points = asked.vertices[:: max(len(asked.vertices) // _ASKED, 1)]
    found = cKDTree(other.vertices).query(points)[0].max()
    return float(np.sqrt(max(found**2 - _BESIDE * _spacing(other) ** 2, 0.0)))


def _spacing(mesh: TriangleMesh) -> float:
    """Return about how far vertices are apart."""
    return float(np.sqrt(mesh.area / len(mesh.vertices)))
