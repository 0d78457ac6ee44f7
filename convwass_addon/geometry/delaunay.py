# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Intrinsic Delaunay triangulations of closed surfaces, by flips of many edges at once.

A. Bobenko and B. Springborn, "A Discrete Laplace-Beltrami Operator for Simplicial Surfaces", Discrete & Computational
Geometry 38, 2007; edges without length in space, flipped by laying out their two triangles in the plane, as in
N. Sharp and K. Crane, "A Laplacian for Nonmanifold Triangle Meshes", Computer Graphics Forum 39(5), 2020.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..progress import UNINTERRUPTED, Control
from .edges import edge_use

# Edges are flipped until none has a weight, half the sum of two cotangents, below this.
_NOTICEABLE = 1e-6
# Meshes with triangles of any use are done after ten to thirty rounds.
_MOST_ROUNDS = 2000


@dataclass(frozen=True)
class ClosedSurface:
    """Triangles by their sides: side 3 f + c of triangle f runs from its corner c to the next.

    Attributes
    ----------
    tails : (3 m,) int64
        The vertex that every side starts from.
    twins : (3 m,) int64
        The side of the other triangle at the same edge.
    lengths : (3 m,) float64
        Of the sides.
    sheets : int
        How many times the surface lies over the mesh that it was made of.
    """

    tails: NDArray[np.int64]
    twins: NDArray[np.int64]
    lengths: NDArray[np.float64]
    sheets: int


def closed_surface(faces: NDArray[np.int64], lengths: NDArray[np.float64]) -> ClosedSurface | None:
    """Return the tufted cover of triangles, or half of it where that is closed; None where more than two share an edge.

    The cover has a front and a back of every triangle; across an edge of two triangles the sheets go on, at an edge
    of one its front goes on to its back. The two sheets of a closed surface that has an outside are the same twice.

    Parameters
    ----------
    faces : (m, 3) int64
        Three different vertices each.
    lengths : (m, 3) float64
        Of the sides that start from every corner.
    """
    use, tails = edge_use(faces), faces.ravel()
    if use.count.max() > 2:
        return None
    pairs, border = use.start[use.count == 2], use.side[use.start[use.count == 1]]
    first, second = use.side[pairs], use.side[pairs + 1]
    alike = tails[first] == tails[second]
    if len(border) or alike.any():
        return _double(faces, lengths, first, second, alike, border)
    twins = np.empty(len(tails), np.int64)
    twins[first], twins[second] = second, first
    return ClosedSurface(tails, twins, lengths.ravel(), 1)


def _double(
    faces: NDArray[np.int64],
    lengths: NDArray[np.float64],
    first: NDArray[np.int64],
    second: NDArray[np.int64],
    alike: NDArray[np.bool_],
    border: NDArray[np.int64],
) -> ClosedSurface:
    """Glue fronts and backs together: sides `first` and `second` are those of one edge, `border` those of their own.

    The back of a triangle a, b, c is c, b, a: its sides 0, 1, 2 are the front's 1, 0, 2 the other way round.
    """
    count = faces.size
    sides = np.arange(count).reshape(-1, 3)
    back = np.empty(count, np.int64)
    back[sides[:, [1, 0, 2]].ravel()] = count + np.arange(count)
    twins = np.empty(2 * count, np.int64)
    # Two that run along an edge the same way have their outsides on different sides of it.
    front_mate, back_mate = np.where(alike, back[second], second), np.where(alike, second, back[second])
    for one, other in ((first, front_mate), (back[first], back_mate), (border, back[border])):
        twins[one], twins[other] = other, one
    tails = np.concatenate([faces.ravel(), faces[:, ::-1].ravel()])
    return ClosedSurface(tails, twins, np.concatenate([lengths.ravel(), lengths[:, [1, 0, 2]].ravel()]), 2)


@dataclass(frozen=True)
class FlippedSurface:
    """A Delaunay triangulation of a closed surface.

    Attributes
    ----------
    tails : (3 m,) int64
        As in `ClosedSurface`.
    cotangents : (m, 3) float64
        Of the angle opposite to every side.
    areas : (m,) float64
        Of the triangles.
    """

    tails: NDArray[np.int64]
    cotangents: NDArray[np.float64]
    areas: NDArray[np.float64]


def flipped_to_delaunay(surface: ClosedSurface, control: Control = UNINTERRUPTED) -> FlippedSurface | None:
    """Flip edges until the sum of the angles across each is at most pi; None where rounding keeps that from ending.

    In every round flips that share no triangle are done together. Cancelling `control` ends the work.
    """
    state = _Flipping(surface.tails.copy(), surface.twins.copy(), surface.lengths.copy())
    random = np.random.default_rng(0)
    sides = np.flatnonzero(np.arange(len(state.twins)) < state.twins)
    for _ in range(_MOST_ROUNDS):
        control.check()
        sides = state.bad(sides)
        if not len(sides):
            areas = state.areas
            sound = np.isfinite(state.cotangents).all() and np.isfinite(areas).all()
            return FlippedSurface(state.tails, state.cotangents.reshape(-1, 3), areas) if sound else None
        now = state.apart(sides, random)
        changed = state.flip(sides[now])
        # All sides of changed triangles, each edge once, and those that had to wait.
        again = np.concatenate([changed, state.twins[changed], sides[~now]])
        sides = _distinct(np.minimum(again, state.twins[again]))
    return None


def _distinct(sides: NDArray[np.int64]) -> NDArray[np.int64]:
    """Each side once, in order; NumPy's unique takes several times as long for millions of numbers."""
    ordered = np.sort(sides)
    return ordered[np.diff(ordered, prepend=-1) > 0]


class _Flipping:
    """A triangulation that changes; arrays as in `ClosedSurface`, and what follows from them."""

    def __init__(self, tails: NDArray[np.int64], twins: NDArray[np.int64], lengths: NDArray[np.float64]) -> None:
        self.tails, self.twins, self.lengths = tails, twins, lengths
        self.areas = np.empty(len(tails) // 3)
        self.cotangents = np.empty(len(tails))
        self._places = np.arange(len(tails))
        self._measure(np.arange(len(self.areas)))

    def _measure(self, triangles: NDArray[np.int64]) -> None:
        """Calculate the areas and cotangents of some triangles from their sides."""
        lengths = self.lengths.reshape(-1, 3)[triangles]
        areas = triangle_areas(lengths)
        squares = lengths**2
        self.areas[triangles] = areas
        cotangents = (squares.sum(axis=1, keepdims=True) - 2.0 * squares) / (4.0 * areas[:, None])
        self.cotangents.reshape(-1, 3)[triangles] = cotangents

    def bad(self, sides: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return those of some sides whose edges are not Delaunay, and that can be flipped."""
        twins = self.twins[sides]
        low = 0.5 * (self.cotangents[sides] + self.cotangents[twins]) < -_NOTICEABLE
        # Both sides of one triangle: its third side goes around a vertex of a single triangle.
        return sides[low & (sides // 3 != twins // 3)]

    def apart(self, sides: NDArray[np.int64], random: np.random.Generator) -> NDArray[np.bool_]:
        """Choose sides of which no two have a triangle in common; in a random order, as rows of flips share them."""
        order = random.permutation(len(sides))
        triangles = np.stack([sides, self.twins[sides]], axis=1) // 3
        # The last to claim a triangle gets it.
        owners = np.empty(len(self.areas), np.int64)
        owners[triangles[order].ravel()] = np.repeat(order, 2)
        return (owners[triangles] == np.arange(len(sides))[:, None]).all(axis=1)

    def flip(self, sides: NDArray[np.int64]) -> NDArray[np.int64]:
        """Replace edges by the other diagonals of their two triangles; returns the sides of these triangles."""
        one, other = sides, self.twins[sides]
        one_next, other_next = _next(one), _next(other)
        one_last, other_last = _next(one_next), _next(other_next)
        ends = self.tails[one_last], self.tails[other_last]
        lengths = self._diagonals(one, one_next, one_last, other_next, other_last)
        # The four outer sides change places in a ring.
        before = np.concatenate([one_last, other_next, other_last, one_next])
        after = np.concatenate([one_next, one_last, other_next, other_last])
        tails, sizes, mates = self.tails[before], self.lengths[before], self.twins[before]
        self._places[before] = after
        mates = self._places[mates]
        self._places[before] = before
        self.tails[after], self.lengths[after] = tails, sizes
        self.twins[after], self.twins[mates] = mates, after
        self.tails[one], self.tails[other] = ends[1], ends[0]
        self.lengths[one] = self.lengths[other] = lengths
        self._measure(np.concatenate([one // 3, other // 3]))
        return np.concatenate([one, other, after])

    def _diagonals(
        self,
        one: NDArray[np.int64],
        one_next: NDArray[np.int64],
        one_last: NDArray[np.int64],
        other_next: NDArray[np.int64],
        other_last: NDArray[np.int64],
    ) -> NDArray[np.float64]:
        """Distances of the corners across edges, with the two triangles of each in one plane, the edge along x."""
        length = self.lengths[one]
        above = _apex(length, self.lengths[one_last], self.lengths[one_next], self.areas[one // 3])
        below = _apex(length, self.lengths[other_next], self.lengths[other_last], self.areas[other_next // 3])
        return np.hypot(above[0] - below[0], above[1] + below[1])


def _next(sides: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the next side of the same triangle."""
    return np.where(sides % 3 == 2, sides - 2, sides + 1)


def _apex(
    base: NDArray[np.float64], from_start: NDArray[np.float64], from_end: NDArray[np.float64], area: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Place along a base from its start, and height above it, of the third corner of triangles."""
    return (base**2 + from_start**2 - from_end**2) / (2.0 * base), 2.0 * area / base


def triangle_areas(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Areas from edge lengths, (m, 3), by Heron's formula in the order that keeps needles exact (Kahan 2014)."""
    c, b, a = np.sort(lengths, axis=1).T
    return 0.25 * np.sqrt((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c)))
