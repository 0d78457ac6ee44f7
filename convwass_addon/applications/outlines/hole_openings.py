# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes of different numbers of holes: holes that the other shape has not are opened to the outside."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from .matched_outlines import rough_work
from .outline_pairs import region_pairs
from .outlined_shape import OutlinedShape

# Directions from the center of a hole in which slits are tried.
_DIRECTIONS = 8
# Samples of a hole, among which the one in such a direction is sought.
_SAMPLES = 256


@dataclass(frozen=True)
class _RegionPair:
    """Regions of two shapes that belong together.

    Attributes
    ----------
    one, other : int
        Indices of the shapes.
    ours, theirs : int
        Indices of their regions.
    """

    one: int
    other: int
    ours: int
    theirs: int

    def surplus(self, shapes: Sequence[OutlinedShape]) -> int:
        """Return how many holes more the first one has."""
        first, second = shapes[self.one].regions[self.ours], shapes[self.other].regions[self.theirs]
        return len(first.holes) - len(second.holes)


def _region_pairs(shapes: Sequence[OutlinedShape], pairs: Sequence[tuple[int, int]]) -> list[_RegionPair]:
    return [_RegionPair(*pair, *own) for pair in pairs for own in region_pairs(*(shapes[index] for index in pair))]


def surplus_holes(shapes: Sequence[OutlinedShape], pairs: Sequence[tuple[int, int]]) -> int:
    """Return how many holes of two shapes, at most, have no counterpart in the other one."""
    return max((sum(abs(own.surplus(shapes)) for own in _region_pairs(shapes, [pair])) for pair in pairs), default=0)


def with_open_holes(shapes: Sequence[OutlinedShape], pairs: Sequence[tuple[int, int]]) -> list[OutlinedShape]:
    """Return shapes with slits from holes to the outside, so that regions that match have equal numbers of holes.

    Of all holes and some slits, the one is taken after which the outlines match best. Where no straight slit is free,
    holes stay as they are.

    Parameters
    ----------
    shapes : sequence of OutlinedShape
        Shapes; those that occur together have equal numbers of regions.
    pairs : sequence of (int, int)
        Shapes that occur together in a blend.
    """
    found = list(shapes)
    # Every round that changes something opens a hole.
    for _ in range(sum(len(region.holes) for shape in shapes for region in shape.regions)):
        before = list(found)
        for own in _region_pairs(found, pairs):
            first, second = found[own.one], found[own.other]
            surplus = own.surplus(found)
            if surplus > 0:
                found[own.one] = _opened(first, own.ours, second, own.theirs)
            elif surplus < 0:
                found[own.other] = _opened(second, own.theirs, first, own.ours)
        if all(own is earlier for own, earlier in zip(found, before, strict=True)):
            break
    return found


def _opened(shape: OutlinedShape, index: int, other: OutlinedShape, there: int) -> OutlinedShape:
    """Return a shape with the hole of a region opened after which it matches a region of another one best."""
    target = other.curve(other.regions[there].outer)
    candidates = [
        shape.opened(index, hole, places)
        for hole in shape.regions[index].holes
        for places in _slits(shape, index, hole)
    ]
    return min(candidates, key=lambda own: rough_work(own.curve(own.regions[index].outer), target), default=shape)


def _slits(shape: OutlinedShape, index: int, hole: int) -> Iterator[tuple[float, float]]:
    """Yield the ends of free straight slits from a hole to the outside, in several directions."""
    region, curve = shape.regions[index], shape.curves[hole]
    places = np.linspace(0.0, curve.length, _SAMPLES, endpoint=False)
    toward = curve.at(places) - shape.center(hole)
    for angle in np.arange(_DIRECTIONS) * (2.0 * np.pi / _DIRECTIONS):
        direction = np.array([np.cos(angle), np.sin(angle)])
        along = toward @ direction / np.maximum(np.linalg.norm(toward, axis=1), np.finfo(np.float64).tiny)
        place = places[along.argmax()]
        start = curve.at(np.array([place]))
        away = [shape.curves[own].nearest(start) for own in region.curves if own != hole]
        nearest = min(away, key=lambda own: own[1][0])
        if nearest is away[0]:
            yield float(nearest[0][0]), float(place)
