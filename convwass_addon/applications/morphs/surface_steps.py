# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances between the surfaces of successive blends, and jumps where something appears or vanishes abruptly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ...geometry.mesh import TriangleMesh
from .layouts import Blend
from .morph_problem import MorphFrame
from .steady_topology import Leg

# A step longer than this multiple of the median is a jump; the steps of blends computed again are limited to the
# second.
_JUMP, _REACH = 1.8, 1.5
# Steps shorter than this multiple of the vertex spacing are not jumps.
_LEAST = 1.5
# Number of vertices of every surface at which distances are measured.
_ASKED = 2500
# Meshes are kept for this many of the longest steps. From this number of steps on, they are kept only if the step
# exceeds the current median by this factor.
_KEPT, _FIRST, _LONG = 16, 4, 1.2
# Excess of the squared distance to the nearest vertex over that to the surface, as a fraction of the area per vertex.
_BESIDE = 0.35


@dataclass(frozen=True)
class Chain:
    """Blends that should be computed again one after the other, each with a limited distance to the previous one.

    Attributes
    ----------
    beside : Blend
        The blend before the first one.
    near : TriangleMesh
        The surface of that blend, unless it is computed again, too.
    reach : float
        Maximum distance, in scene units.
    blends : tuple of Blend
        All blends up to the end of the leg; usually fewer are needed.
    """

    beside: Blend
    near: TriangleMesh
    reach: float
    blends: tuple[Blend, ...]


@dataclass(frozen=True)
class _Lengths:
    """The largest distance from a surface to the previous one, and vice versa."""

    appears: float
    vanishes: float

    @property
    def longest(self) -> float:
        return max(self.appears, self.vanishes)


@dataclass(frozen=True)
class _Step:
    """The step from one blend to the next.

    Attributes
    ----------
    place : int
        Index of the second blend in its leg.
    lengths : _Lengths
        Lengths of the step.
    before, after : TriangleMesh
        The two surfaces.
    """

    place: int
    lengths: _Lengths
    before: TriangleMesh
    after: TriangleMesh


class SurfaceSteps:
    """Measures the steps between frames in order, and finds jumps.

    Parameters
    ----------
    legs : sequence of Leg
        Legs of the bake.
    """

    def __init__(self, legs: Sequence[Leg]) -> None:
        self._legs = legs
        self._places = {blend: (leg, i) for leg in legs for i, blend in enumerate(leg.between)}
        self._lengths: dict[Leg, list[_Lengths]] = {leg: [] for leg in legs}
        self._longest: dict[Leg, list[_Step]] = {leg: [] for leg in legs}
        self._last: MorphFrame | None = None

    def add(self, frame: MorphFrame) -> None:
        """Measure the step from the previous frame to this one."""
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
        """Return the blends to compute again: those after something appears, and before something vanishes."""
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
    """Return the smallest equal step that covers the distance of some first lengths: the least running mean."""
    return float((np.cumsum(lengths) / np.arange(1, len(lengths) + 1)).min())


def farthest(asked: TriangleMesh, other: TriangleMesh) -> float:
    """Estimate the largest distance of a surface's points from another surface, using the vertices of both."""
    points = asked.vertices[:: max(len(asked.vertices) // _ASKED, 1)]
    found = cKDTree(other.vertices).query(points)[0].max()
    return float(np.sqrt(max(found**2 - _BESIDE * _spacing(other) ** 2, 0.0)))


def _spacing(mesh: TriangleMesh) -> float:
    """Return the approximate distance between neighboring vertices."""
    return float(np.sqrt(mesh.area / len(mesh.vertices)))
