# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The boundary of the area that closed curves fill, with overlaps, crossings and shared edges resolved.

All corners are rounded to an integer lattice. Edges are cut where they meet, coincident edges are merged, and an edge
is kept if exactly one of its sides is filled. Sides are determined by exact integer ray casting.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ..arrays.bounds import bounds_of
from ..arrays.chunks import chunks_by_sizes
from ..arrays.integer_ranges import integer_ranges
from .outlines import Rule
from .plane_angles import plane_cross

# Steps of the lattice along the longest side: products of two doubled coordinates are exact in 64 bits. The coarser
# lattices are for curves that are only one step apart.
_LATTICES = (2**27, 2**22, 2**17)
# A corner within this distance of an edge, in steps, lies on it.
_ON_EDGE = 1.0
_ROUNDS = 8
# Pairs processed together, few enough for the processor's cache.
_AT_ONCE = 1 << 18

Points = NDArray[np.int64]


@dataclass(frozen=True)
class Boundary:
    """The boundary of a filled area of the plane.

    Attributes
    ----------
    starts, ends : (e, 2) float64
        Directed edges that do not cross, with the filled side on their left, in any order.
    """

    starts: NDArray[np.float64]
    ends: NDArray[np.float64]

    @classmethod
    def of_rings(cls, rings: Sequence[NDArray[np.float64]]) -> Boundary:
        """Return the edges of closed polygons, (n, 2) each, at least one, in their directions."""
        return cls(np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings]))

    @classmethod
    def joined(cls, parts: Sequence[Boundary]) -> Boundary:
        """Return the edges of several boundaries, at least one, as they are: areas may overlap."""
        return cls(np.concatenate([own.starts for own in parts]), np.concatenate([own.ends for own in parts]))

    @property
    def area(self) -> float:
        """The filled area."""
        if not len(self.starts):
            return 0.0
        middle = self.starts.mean(axis=0)
        return 0.5 * float(plane_cross(self.starts - middle, self.ends - middle).sum())

    @property
    def root_area(self) -> float:
        """Square root of the filled area."""
        return float(np.sqrt(self.area))

    @property
    def center(self) -> NDArray[np.float64]:
        """Center of mass of the filled area, (2,)."""
        middle = self.starts.mean(axis=0)
        starts, ends = self.starts - middle, self.ends - middle
        doubled = plane_cross(starts, ends)
        return middle + ((starts + ends) * doubled[:, None]).sum(axis=0) / (3.0 * doubled.sum())

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lower and upper corner, (2, 2)."""
        return bounds_of(np.concatenate([self.starts, self.ends]))

    def moved(self, offset: ArrayLike, factor: float = 1.0) -> Boundary:
        """Return the boundary scaled and then translated."""
        shift = np.asarray(offset, dtype=np.float64)
        return Boundary(self.starts * factor + shift, self.ends * factor + shift)

    def part(self, chosen: NDArray[np.bool_]) -> Boundary:
        """Return some of the edges, (e,) bool."""
        return Boundary(self.starts[chosen], self.ends[chosen])

    def divided(self, longest: float) -> Boundary:
        """Return the boundary with edges divided evenly into pieces no longer than `longest`."""
        along = self.ends - self.starts
        counts = np.maximum(np.ceil(np.linalg.norm(along, axis=1) / longest), 1).astype(np.int64)
        edge, place = integer_ranges(0, counts)
        starts = self.starts[edge] + (place / counts[edge])[:, None] * along[edge]
        ends = self.starts[edge] + ((place + 1) / counts[edge])[:, None] * along[edge]
        # Use the exact corners, without rounding.
        last = place + 1 == counts[edge]
        ends[last] = self.ends[edge[last]]
        return Boundary(starts, ends)

    def contains(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return whether points, (n, 2), lie in the filled area, (n,)."""
        found = np.zeros(len(points), bool)
        starts, ends = self.starts, self.ends
        low, high = starts[:, 1].copy(), ends[:, 1].copy()
        for part in np.array_split(np.arange(len(points)), max(1, len(points) * len(starts) // _AT_ONCE)):
            x, y = points[part].T
            # Indices of a flat array are found in a third of the time.
            row, edge = np.divmod(np.flatnonzero((low <= y[:, None]) != (high <= y[:, None])), max(len(starts), 1))
            share = (y[row] - low[edge]) / (high[edge] - low[edge])
            beyond = starts[edge, 0] + share * (ends[edge, 0] - starts[edge, 0]) > x[row]
            found[part] = np.bincount(row[beyond], minlength=len(part)) % 2 == 1
        return found

    def resolved(self) -> Boundary:
        """Return the boundary of the filled area, for edges that may cross, coincide or lie inside it."""
        return _resolved(self, "non-zero")

    def united(self, others: Sequence[Boundary]) -> Boundary:
        """Return the boundary of the union with other filled areas."""
        return Boundary.joined([self, *others]).resolved()


def filled_boundary(rings: Sequence[NDArray[np.float64]], rule: Rule) -> Boundary:
    """Boundary of the area that rings fill.

    Parameters
    ----------
    rings : sequence of (n, 2)
        Closed polygons, which may cross themselves and each other.
    rule : "non-zero" or "even-odd"
        Fill rule.

    Returns
    -------
    Boundary
        Without edges if nothing is filled. Corners move by at most about 1e-8 of the longest side.

    Raises
    ------
    InputError
        The curves are too entangled to be resolved on any lattice.
    """
    if not rings:
        return Boundary(np.zeros((0, 2)), np.zeros((0, 2)))
    return _resolved(Boundary.of_rings([np.asarray(ring, np.float64) for ring in rings]), rule)


def _resolved(edges: Boundary, rule: Rule) -> Boundary:
    """Return the boundary of the area that directed edges fill, which may cross and coincide."""
    starts, ends, (low, high) = edges.starts, edges.ends, edges.bounds
    extent = float((high - low).max())
    if extent <= 0.0:
        return Boundary(np.zeros((0, 2)), np.zeros((0, 2)))
    for steps in _LATTICES:
        unit = extent / steps
        cut = _cut(np.rint((starts - low) / unit).astype(np.int64), np.rint((ends - low) / unit).astype(np.int64))
        kept = _one_sided(cut, rule)
        if kept.closes():
            return Boundary(kept.starts * unit + low, kept.ends * unit + low)
    raise InputError("These curves cross each other in too many places at once; simplify them.")


@dataclass(frozen=True)
class _Edges:
    """Edges on the lattice, and how many more times each is traversed forward than backward."""

    starts: Points
    ends: Points
    counts: NDArray[np.int64]

    @classmethod
    def merged(cls, starts: Points, ends: Points, counts: NDArray[np.int64]) -> _Edges:
        """Merge coincident edges; edges traversed equally often in both directions cancel."""
        backwards = (starts[:, 0] > ends[:, 0]) | ((starts[:, 0] == ends[:, 0]) & (starts[:, 1] > ends[:, 1]))
        low = np.where(backwards[:, None], ends, starts)
        high = np.where(backwards[:, None], starts, ends)
        rows, place = np.unique(np.concatenate([low, high], axis=1), axis=0, return_inverse=True)
        totals = np.zeros(len(rows), np.int64)
        np.add.at(totals, place.ravel(), np.where(backwards, -counts, counts))
        kept = (totals != 0) & (rows[:, :2] != rows[:, 2:]).any(axis=1)
        return cls(rows[kept, :2], rows[kept, 2:], totals[kept])

    def closes(self) -> bool:
        """Whether as many edges end as start at every point."""
        points, place = np.unique(np.concatenate([self.starts, self.ends]), axis=0, return_inverse=True)
        signs = np.concatenate([self.counts, -self.counts])
        return not np.bincount(place.ravel(), signs, minlength=len(points)).any()


def _cut(starts: Points, ends: Points) -> _Edges:
    """Cut edges wherever they meet, until none do."""
    edges = _Edges.merged(starts, ends, np.ones(len(starts), np.int64))
    for _ in range(_ROUNDS):
        owners, points = _meetings(edges)
        if not len(owners):
            break
        edges = _split(edges, owners, points)
    return edges


def _meetings(edges: _Edges) -> tuple[NDArray[np.int64], Points]:
    """Find where edges have to be cut: the edges and the points, excluding their own ends."""
    owners, points = [np.zeros(0, np.int64)], [np.zeros((0, 2), np.int64)]
    for a, b in _near_pairs(edges):
        first, second = (edges.starts[a], edges.ends[a]), (edges.starts[b], edges.ends[b])
        for (start, end), others, numbers in ((first, second, a), (second, first, b)):
            for corner in others:
                on = _lies_on(corner, start, end)
                owners.append(numbers[on])
                points.append(corner[on])
        crossing, place = _crossings(*first, *second)
        for numbers in (a, b):
            owners.append(numbers[crossing])
            points.append(place)
    owner, point = np.concatenate(owners), np.concatenate(points)
    new = (point != edges.starts[owner]).any(axis=1) & (point != edges.ends[owner]).any(axis=1)
    return owner[new], point[new]


def _near_pairs(edges: _Edges) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Yield pairs of edges whose bounding boxes overlap, in batches."""
    low = np.minimum(edges.starts, edges.ends) - 1
    high = np.maximum(edges.starts, edges.ends) + 1
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order], high[order]
    last = np.searchsorted(low[:, 0], high[:, 0], side="right")
    counts = last - np.arange(len(order)) - 1
    for some in chunks_by_sizes(counts, _AT_ONCE):
        rows, columns = integer_ranges(np.arange(some.start, some.stop) + 1, counts[some])
        rows += some.start
        meet = (low[rows, 1] <= high[columns, 1]) & (low[columns, 1] <= high[rows, 1])
        yield order[rows[meet]], order[columns[meet]]


def _lies_on(corner: Points, start: Points, end: Points) -> NDArray[np.bool_]:
    """Return whether corners lie on edges, within a step, strictly between their ends."""
    along, away = end - start, corner - start
    squared = (along * along).sum(axis=1)
    reached = (along * away).sum(axis=1)
    inside = (reached > 0) & (reached < squared)
    return inside & (np.abs(plane_cross(along, away)) <= _ON_EDGE * np.sqrt(squared.astype(np.float64)))


def _crossings(a: Points, b: Points, c: Points, d: Points) -> tuple[NDArray[np.bool_], Points]:
    """Return which edges a-b and c-d cross in their interiors, and the nearest lattice points of the crossings."""
    one, other = b - a, d - c
    sides = [np.sign(plane_cross(*pair)) for pair in ((one, c - a), (one, d - a), (other, a - c), (other, b - c))]
    crossing = (sides[0] * sides[1] < 0) & (sides[2] * sides[3] < 0)
    one, other, between = one[crossing], other[crossing], (c - a)[crossing]
    share = plane_cross(between, other) / plane_cross(one, other)
    return crossing, np.rint(a[crossing] + share[:, None] * one).astype(np.int64)


def _split(edges: _Edges, owners: NDArray[np.int64], points: Points) -> _Edges:
    """Cut edges at given points."""
    numbers = np.arange(len(edges.starts))
    owner = np.concatenate([numbers, owners, numbers])
    chain = np.concatenate([edges.starts, points, edges.ends])
    along = (edges.ends - edges.starts)[owner]
    reached = ((chain - edges.starts[owner]) * along).sum(axis=1)
    # Starts come first and ends last, regardless of rounding.
    rank = np.repeat([0, 1, 2], [len(numbers), len(owners), len(numbers)])
    order = np.lexsort((reached, rank, owner))
    owner, chain = owner[order], chain[order]
    same = owner[:-1] == owner[1:]
    return _Edges.merged(chain[:-1][same], chain[1:][same], edges.counts[owner[:-1][same]])


def _one_sided(edges: _Edges, rule: Rule) -> _Edges:
    """Keep edges with exactly one filled side, once each, oriented to have it on their left."""
    along = edges.ends - edges.starts
    steep = np.abs(along[:, 1]) >= np.abs(along[:, 0])
    beyond = np.where(steep, _turns_beyond(edges, 0, steep), _turns_beyond(edges, 1, ~steep))
    # Upward edges beyond a point wind around it, and so do leftward edges above it.
    own = edges.counts * np.where(steep, np.sign(along[:, 1]), -np.sign(along[:, 0]))
    far, near = _is_inside(beyond, rule), _is_inside(beyond + own, rule)
    # The left side of an upward edge is the near one; the left side of a rightward edge is the far one, above.
    forwards = np.where(steep, near == (along[:, 1] > 0), far == (along[:, 0] > 0))
    kept = far != near
    starts = np.where(forwards[:, None], edges.starts, edges.ends)[kept]
    ends = np.where(forwards[:, None], edges.ends, edges.starts)[kept]
    return _Edges(starts, ends, np.ones(len(starts), np.int64))


def _is_inside(turns: NDArray[np.int64], rule: Rule) -> NDArray[np.bool_]:
    return turns != 0 if rule == "non-zero" else turns % 2 != 0


def _turns_beyond(edges: _Edges, axis: int, wanted: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Sum the signed edges that a ray along an axis meets beyond the midpoints of selected edges, (e,)."""
    other = 1 - axis
    # Doubled coordinates make midpoints integers.
    starts, ends = 2 * edges.starts, 2 * edges.ends
    rising = starts[:, other] < ends[:, other]
    low, high = np.where(rising[:, None], starts, ends), np.where(rising[:, None], ends, starts)
    sign = np.where(rising, edges.counts, -edges.counts) * (1 if axis == 0 else -1)
    level = low[:, other] != high[:, other]
    low, high, sign, number = low[level], high[level], sign[level], np.flatnonzero(level)
    found = np.zeros(len(edges.starts), np.int64)
    rows = np.flatnonzero(wanted)
    lowest, highest = low[:, other].copy(), high[:, other].copy()
    for part in np.array_split(rows, max(1, len(rows) * len(low) // _AT_ONCE)):
        middle = edges.starts[part] + edges.ends[part]
        place, height = middle[:, axis, None], middle[:, other, None]
        hit = (lowest <= height) & (height < highest) & (part[:, None] != number)
        row, column = np.divmod(np.flatnonzero(hit), max(len(low), 1))
        rise, run = (high - low)[column, other], (high - low)[column, axis]
        away = (place[row, 0] - low[column, axis]) * rise - (height[row, 0] - low[column, other]) * run
        found[part] = np.bincount(row, sign[column] * (away < 0), minlength=len(part)).astype(np.int64)
    return found
