# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of shapes that stand on one floor: blends stand on it, too, and feet stay in their places.

While limbs swing, the mean of a body moves along a straight line, so that feet sink into the floor and slide. Moving
the body as a whole puts them back. With transport alone, every point moves along a straight line, so nothing sinks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..workers import side_by_side
from .motion import Motion, MovedShape, arriving, unmoved, ways_between

# Two shapes stand on one floor if their lowest points differ by at most this, in mean diagonals of their bounds. Up to
# twice the difference, blends follow the floor less and less.
_LEVEL = 0.03
# Height in diagonals over which a point ceases to touch the floor.
_TOUCHING = 0.01
# Points that are nowhere lower than this, in the same unit, are not considered.
_LOW = 0.2
# Share of the surface that keeps a body half in its place if it touches the floor.
_HOLDING = 1e-4
# Weight at which a shape that lifts a foot half prevents it from keeping a body in its place.
_PRESENT = 0.02


@dataclass(frozen=True)
class Feet:
    """The points of a shape that are low on any shape.

    Attributes
    ----------
    vertices : (n,) int64
        Vertices of the moved shape.
    areas : (n,) float64
        Their shares of the surface.
    places : mapping of int to (n, 3) float64
        Their positions on every shape that occurs together with theirs, and on their own.
    """

    vertices: NDArray[np.int64]
    areas: NDArray[np.float64]
    places: Mapping[int, NDArray[np.float64]]

    def shift(
        self, moved: NDArray[np.float64], weights: Mapping[int, float], floors: Mapping[int, float], touching: float
    ) -> NDArray[np.float64]:
        """Return the mean displacement, (3,), from points that touch the floor to their interpolated places.

        With weights w_k, heights h_k of a point above the floors, and the height c over which points cease to touch
        them, the point counts exp(-sum_k h_k / c w_k / (w_k + w_0)): a foot that one of the shapes lifts does not.
        """
        between = sum(weight * self.places[shape] for shape, weight in weights.items())
        lifted = sum(
            weight / (weight + _PRESENT) * np.maximum(self.places[shape][:, 2] - floors[shape], 0.0)
            for shape, weight in weights.items()
        )
        holds = self.areas * np.exp(-lifted / touching)
        return holds @ (between - moved[self.vertices]) / (holds.sum() + _HOLDING)


@dataclass(frozen=True)
class StandingMotion:
    """A motion whose shapes are moved as a whole so that they stand on a floor; a :class:`.motion.Motion`.

    The height of the lowest point is interpolated, and so are the horizontal places of points that touch the floor.

    Attributes
    ----------
    motion : Motion
        The motion without a floor.
    floors : mapping of int to float
        Height of the lowest point of every shape.
    feet : mapping of int to Feet
        The low points of every shape.
    touching : float
        Height over which a point ceases to touch the floor, scene units.
    shares : mapping of (int, int) to float
        How far blends of two shapes follow the floor, from 0 to 1, smaller index first. Blends of more shapes have the
        mean over their pairs, with weights w_i w_j.
    """

    motion: Motion
    floors: Mapping[int, float]
    feet: Mapping[int, Feet]
    touching: float
    shares: Mapping[tuple[int, int], float]

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return the moved inputs; see :meth:`.motion.Motion.moved`."""
        shapes = self.motion.moved(weights)
        active = {index: weight for index, weight in enumerate(weights) if weight > 0}
        if len(active) == 1:
            return shapes
        floor = sum(weight * self.floors[index] for index, weight in active.items())
        lowest = sum(weight * _lowest(shapes[index]) for index, weight in active.items())
        shift = sum(
            weight * self.feet[index].shift(shapes[index].vertices, active, self.floors, self.touching)
            for index, weight in active.items()
        )
        shift[2] = floor - lowest
        shift *= self._share(active)
        return [None if shape is None else replace(shape, vertices=shape.vertices + shift) for shape in shapes]

    def _share(self, active: Mapping[int, float]) -> float:
        """Return how far the blend with these weights follows the floor."""
        pairs = list(combinations(active, 2))
        weights = np.array([active[one] * active[other] for one, other in pairs])
        return float(np.average([self.shares[pair] for pair in pairs], weights=weights))


def standing_motion(motion: Motion, count: int, pairs: Sequence[tuple[int, int]]) -> Motion:
    """Return a motion in which shapes that stand on one floor stay on it; the motion itself if no two of them do.

    Parameters
    ----------
    motion : Motion
        The motion of shapes in scene space, with z upward.
    count : int
        Number of shapes.
    pairs : sequence of (int, int)
        Pairs of shapes that occur together in a blend, smaller index first.
    """
    if not pairs:
        return motion
    rests = {index: unmoved(motion, count, index) for index in np.unique(pairs).tolist()}
    floors = {index: _lowest(rest) for index, rest in rests.items()}
    diagonal = float(np.mean([rest.mesh.diagonal for rest in rests.values()]))
    shares = {
        (one, other): float(np.clip(2.0 - abs(floors[one] - floors[other]) / (_LEVEL * diagonal), 0.0, 1.0))
        for one, other in pairs
    }
    if not any(shares.values()):
        return motion
    places = {index: {index: rest.vertices} for index, rest in rests.items()}
    ways = ways_between(pairs)
    arrived = side_by_side(lambda way: arriving(motion, count, *ways[way]).vertices, len(ways))
    for (one, other), vertices in zip(ways, arrived, strict=True):
        places[one][other] = vertices
    feet = {index: _feet(rest, places[index], floors, _LOW * diagonal) for index, rest in rests.items()}
    return StandingMotion(motion, floors, feet, _TOUCHING * diagonal, shares)


def _feet(rest: MovedShape, places: Mapping[int, NDArray[np.float64]], floors: Mapping[int, float], low: float) -> Feet:
    """Return the points of a shape that are somewhere lower than `low`, of given positions on the shapes."""
    heights = np.min([points[:, 2] - floors[shape] for shape, points in places.items()], axis=0)
    found = np.flatnonzero(heights < low)
    areas = rest.mesh.vertex_areas[found] / rest.mesh.area
    return Feet(found, areas, {shape: points[found] for shape, points in places.items()})


def _lowest(shape: MovedShape) -> float:
    """Return the height of the lowest point."""
    return float(shape.mesh.bounds[0, 2])
