# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Intrinsic Delaunay triangulations of closed surfaces, flipping many edges at once.

A. Bobenko and B. Springborn, "A Discrete Laplace-Beltrami Operator for Simplicial Surfaces", Discrete & Computational
Geometry 38, 2007. Edges are intrinsic: a flip lays out its two triangles in the plane, as in N. Sharp and K. Crane, "A
Laplacian for Nonmanifold Triangle Meshes", Computer Graphics Forum 39(5), 2020.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..arrays.distinct import sorted_distinct
from .edges import edge_use
from .face_neighbors import FaceNeighbors

# Edges are flipped until no weight, half the sum of two cotangents, is below minus this.
_NOTICEABLE = 1e-6
# Reasonable meshes need ten to thirty rounds.
_MOST_ROUNDS = 2000


@dataclass(frozen=True)
class ClosedSurface:
    """Triangles by half-edges: side 3 f + c of triangle f runs from its corner c to the next.

    Attributes
    ----------
    tails : (3 m,) int64
        The start vertex of every side.
    twins : (3 m,) int64
        The side of the adjacent triangle on the same edge.
    lengths : (3 m,) float64
        Lengths of the sides.
    sheets : int
        How many times the surface covers the original mesh.
    """

    tails: NDArray[np.int64]
    twins: NDArray[np.int64]
    lengths: NDArray[np.float64]
    sheets: int


def closed_surface(faces: NDArray[np.int64], lengths: NDArray[np.float64]) -> ClosedSurface | None:
    """Return the triangles themselves if closed and oriented, else their tufted cover; None if an edge has over two.

    The cover has a front and a back for every triangle. Sheets continue across interior edges, and at a boundary edge
    the front continues to the back. For a closed oriented surface the two sheets would be identical copies.

    Parameters
    ----------
    faces : (m, 3) int64
        Three different vertices each.
    lengths : (m, 3) float64
        Length of the side that starts at each corner.
    """
    use, tails = edge_use(faces), faces.ravel()
    if use.count.max() > 2:
        return None
    border = use.side[use.start[use.count == 1]]
    first, second = FaceNeighbors.of(use).sides
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
    """Glue fronts and backs; `first` and `second` are the sides of interior edges, `border` those of boundary edges.

    The back of a triangle a, b, c is c, b, a: its sides 0, 1, 2 are the reversed sides 1, 0, 2 of the front.
    """
    count = faces.size
    sides = np.arange(count).reshape(-1, 3)
    back = np.empty(count, np.int64)
    back[sides[:, [1, 0, 2]].ravel()] = count + np.arange(count)
    twins = np.empty(2 * count, np.int64)
    # If both sides run the same way, the two triangles have opposite orientations.
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
        Cotangent of the angle opposite every side.
    areas : (m,) float64
        Areas of the triangles.
    """

    tails: NDArray[np.int64]
    cotangents: NDArray[np.float64]
    areas: NDArray[np.float64]


def flipped_to_delaunay(surface: ClosedSurface, control: Control = UNINTERRUPTED) -> FlippedSurface | None:
    """Flip edges until the opposite angles of each sum to at most pi; None if rounding prevents this.

    Every round performs flips that share no triangle. Cancelling `control` stops the work.
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
        # All sides of the changed triangles, each edge once, and the flips that were postponed.
        again = np.concatenate([changed, state.twins[changed], sides[~now]])
        sides = sorted_distinct(np.minimum(again, state.twins[again]))
    return None


class _Flipping:
    """A mutable triangulation with the arrays of `ClosedSurface`, and areas and cotangents kept up to date."""

    def __init__(self, tails: NDArray[np.int64], twins: NDArray[np.int64], lengths: NDArray[np.float64]) -> None:
        self.tails, self.twins, self.lengths = tails, twins, lengths
        self.areas = np.empty(len(tails) // 3)
        self.cotangents = np.empty(len(tails))
        self._places = np.arange(len(tails))
        self._measure(np.arange(len(self.areas)))

    def _measure(self, triangles: NDArray[np.int64]) -> None:
        """Update the areas and cotangents of some triangles from their side lengths."""
        lengths = self.lengths.reshape(-1, 3)[triangles]
        squares = lengths**2
        # By rounding, three corners may come to lie on a line; then there is no triangulation.
        with np.errstate(divide="ignore", invalid="ignore"):
            areas = heron_areas(lengths)
            cotangents = (squares.sum(axis=1, keepdims=True) - 2.0 * squares) / (4.0 * areas[:, None])
        self.areas[triangles] = areas
        self.cotangents.reshape(-1, 3)[triangles] = cotangents

    def bad(self, sides: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return those of the sides whose edges are not Delaunay and can be flipped."""
        twins = self.twins[sides]
        low = 0.5 * (self.cotangents[sides] + self.cotangents[twins]) < -_NOTICEABLE
        # If both sides belong to one triangle, its third side encloses a vertex of degree one.
        return sides[low & (sides // 3 != twins // 3)]

    def apart(self, sides: NDArray[np.int64], random: np.random.Generator) -> NDArray[np.bool_]:
        """Choose sides no two of which share a triangle; at random, since adjacent edges often need flips together."""
        order = random.permutation(len(sides))
        triangles = np.stack([sides, self.twins[sides]], axis=1) // 3
        # If several sides claim a triangle, the last one gets it.
        owners = np.empty(len(self.areas), np.int64)
        owners[triangles[order].ravel()] = np.repeat(order, 2)
        return (owners[triangles] == np.arange(len(sides))[:, None]).all(axis=1)

    def flip(self, sides: NDArray[np.int64]) -> NDArray[np.int64]:
        """Replace edges by the other diagonals of their triangle pairs; return the sides of these triangles."""
        one, other = sides, self.twins[sides]
        one_next, other_next = _next(one), _next(other)
        one_last, other_last = _next(one_next), _next(other_next)
        ends = self.tails[one_last], self.tails[other_last]
        lengths = self._diagonals(one, one_next, one_last, other_next, other_last)
        # The four outer sides move to new positions.
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
        """Lengths of the new diagonals, with the two triangles of each unfolded into the plane, the edge along x."""
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
    """Position along the base from its start, and height above it, of the third corner of triangles."""
    return (base**2 + from_start**2 - from_end**2) / (2.0 * base), 2.0 * area / base


def heron_areas(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Areas from edge lengths, (m, 3), by Heron's formula in the stable order for needle triangles (Kahan 2014)."""
    c, b, a = np.sort(lengths, axis=1).T
    return 0.25 * np.sqrt((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c)))
