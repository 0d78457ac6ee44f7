# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What closed curves fill, as edges that do not cross: overlaps, crossings and shared edges are resolved.

All corners are rounded to a lattice of whole numbers. Edges are cut where they meet, edges in the same place become
one, and each is kept where only one of its sides is filled. Sides are told by exact counts along rays.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .outlines import Rule

# Steps of the lattice along the longest side: products of two doubled coordinates are exact in 64 bits. Coarser ones
# are for curves that run beside each other at the distance of a step.
_LATTICES = (2**27, 2**22, 2**17)
# A corner as near as this to an edge, in steps, is on it.
_ON_EDGE = 1.0
_ROUNDS = 8
# Pairs that are looked at at once.
_AT_ONCE = 4_000_000

Points = NDArray[np.int64]


@dataclass(frozen=True)
class Boundary:
    """The boundary of a filled part of the plane.

    Attributes
    ----------
    starts, ends : (e, 2) float64
        Directed edges that do not cross, with what is filled on their left; in no order.
    """

    starts: NDArray[np.float64]
    ends: NDArray[np.float64]

    @property
    def area(self) -> float:
        """What is filled."""
        if not len(self.starts):
            return 0.0
        middle = self.starts.mean(axis=0)
        return 0.5 * float(_cross(self.starts - middle, self.ends - middle).sum())

    @property
    def center(self) -> NDArray[np.float64]:
        """Center of mass of what is filled, (2,)."""
        middle = self.starts.mean(axis=0)
        starts, ends = self.starts - middle, self.ends - middle
        doubled = _cross(starts, ends)
        return middle + ((starts + ends) * doubled[:, None]).sum(axis=0) / (3.0 * doubled.sum())

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Low and high corner, (2, 2)."""
        both = np.concatenate([self.starts, self.ends])
        return np.stack([both.min(axis=0), both.max(axis=0)])

    def moved(self, offset: ArrayLike, factor: float = 1.0) -> Boundary:
        """Return the boundary scaled and then moved."""
        shift = np.asarray(offset, dtype=np.float64)
        return Boundary(self.starts * factor + shift, self.ends * factor + shift)

    def divided(self, longest: float) -> Boundary:
        """Return the same boundary with edges cut into equal pieces no longer than `longest`."""
        along = self.ends - self.starts
        counts = np.maximum(np.ceil(np.linalg.norm(along, axis=1) / longest), 1).astype(np.int64)
        edge = np.repeat(np.arange(len(along)), counts)
        place = np.arange(len(edge)) - np.repeat(np.cumsum(counts) - counts, counts)
        starts = self.starts[edge] + (place / counts[edge])[:, None] * along[edge]
        ends = self.starts[edge] + ((place + 1) / counts[edge])[:, None] * along[edge]
        # The corners themselves, not what rounding makes of them.
        last = place + 1 == counts[edge]
        ends[last] = self.ends[edge[last]]
        return Boundary(starts, ends)

    def contains(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether points, (n, 2), lie in what is filled, (n,)."""
        found = np.zeros(len(points), bool)
        starts, ends = self.starts, self.ends
        for part in np.array_split(np.arange(len(points)), max(1, len(points) * len(starts) // _AT_ONCE)):
            x, y = points[part, 0, None], points[part, 1, None]
            row, edge = np.nonzero((starts[:, 1] <= y) != (ends[:, 1] <= y))
            share = (y[row, 0] - starts[edge, 1]) / (ends[edge, 1] - starts[edge, 1])
            beyond = starts[edge, 0] + share * (ends[edge, 0] - starts[edge, 0]) > x[row, 0]
            found[part] = np.bincount(row[beyond], minlength=len(part)) % 2 == 1
        return found

    def united(self, others: Sequence[Boundary]) -> Boundary:
        """Return the boundary of what this one or any of the others fills."""
        starts = np.concatenate([self.starts, *(other.starts for other in others)])
        ends = np.concatenate([self.ends, *(other.ends for other in others)])
        return _resolved(starts, ends, "non-zero")


def filled_boundary(rings: Sequence[NDArray[np.float64]], rule: Rule) -> Boundary:
    """Boundary of what rings fill.

    Parameters
    ----------
    rings : sequence of (n, 2)
        Closed polygons, which may cross themselves and each other.
    rule : "non-zero" or "even-odd"
        Which points are inside.

    Returns
    -------
    Boundary
        Without edges where nothing is filled. Corners have moved by about 1e-8 of the longest side at the most.

    Raises
    ------
    InputError
        Curves so tangled that no lattice tells their sides apart.
    """
    if not rings:
        return Boundary(np.zeros((0, 2)), np.zeros((0, 2)))
    starts = np.concatenate(rings).astype(np.float64)
    ends = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings]).astype(np.float64)
    return _resolved(starts, ends, rule)


def _resolved(starts: NDArray[np.float64], ends: NDArray[np.float64], rule: Rule) -> Boundary:
    both = np.concatenate([starts, ends])
    low, extent = both.min(axis=0), float(np.ptp(both, axis=0).max())
    if extent <= 0.0:
        return Boundary(np.zeros((0, 2)), np.zeros((0, 2)))
    for steps in _LATTICES:
        unit = extent / steps
        edges = _cut(np.rint((starts - low) / unit).astype(np.int64), np.rint((ends - low) / unit).astype(np.int64))
        kept = _one_sided(edges, rule)
        if kept.closes():
            return Boundary(kept.starts * unit + low, kept.ends * unit + low)
    raise InputError("These curves cross each other in too many places at once; simplify them.")


@dataclass(frozen=True)
class _Edges:
    """Edges on the lattice, and how often each runs from its start to its end more than the other way."""

    starts: Points
    ends: Points
    counts: NDArray[np.int64]

    @classmethod
    def merged(cls, starts: Points, ends: Points, counts: NDArray[np.int64]) -> _Edges:
        """Bring edges in the same place together; what runs to and fro as often is gone."""
        backwards = (starts[:, 0] > ends[:, 0]) | ((starts[:, 0] == ends[:, 0]) & (starts[:, 1] > ends[:, 1]))
        low = np.where(backwards[:, None], ends, starts)
        high = np.where(backwards[:, None], starts, ends)
        rows, place = np.unique(np.concatenate([low, high], axis=1), axis=0, return_inverse=True)
        totals = np.zeros(len(rows), np.int64)
        np.add.at(totals, place.ravel(), np.where(backwards, -counts, counts))
        kept = (totals != 0) & (rows[:, :2] != rows[:, 2:]).any(axis=1)
        return cls(rows[kept, :2], rows[kept, 2:], totals[kept])

    def closes(self) -> bool:
        """Whether as many edges end as begin at every point."""
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
    """Find the places where edges are to be cut: their numbers and the points, which are no ends of theirs."""
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
    """Yield pairs of edges whose boxes meet, in portions."""
    low = np.minimum(edges.starts, edges.ends) - 1
    high = np.maximum(edges.starts, edges.ends) + 1
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order], high[order]
    last = np.searchsorted(low[:, 0], high[:, 0], side="right")
    counts = last - np.arange(len(order)) - 1
    bounds = np.append(0, np.cumsum(counts))
    begun = 0
    while begun < len(order):
        done = max(int(np.searchsorted(bounds, bounds[begun] + _AT_ONCE, side="right")) - 1, begun + 1)
        rows = np.repeat(np.arange(begun, done), counts[begun:done])
        columns = np.arange(len(rows)) - (bounds[rows] - bounds[begun]) + rows + 1
        meet = (low[rows, 1] <= high[columns, 1]) & (low[columns, 1] <= high[rows, 1])
        yield order[rows[meet]], order[columns[meet]]
        begun = done


def _lies_on(corner: Points, start: Points, end: Points) -> NDArray[np.bool_]:
    """Whether corners lie on edges, within a step, between their ends."""
    along, away = end - start, corner - start
    squared = (along * along).sum(axis=1)
    reached = (along * away).sum(axis=1)
    inside = (reached > 0) & (reached < squared)
    return inside & (np.abs(_cross(along, away)) <= _ON_EDGE * np.sqrt(squared.astype(np.float64)))


def _crossings(a: Points, b: Points, c: Points, d: Points) -> tuple[NDArray[np.bool_], Points]:
    """Whether edges a-b and c-d cross away from their ends, and the lattice points next to where they do."""
    one, other = b - a, d - c
    sides = [np.sign(_cross(*pair)) for pair in ((one, c - a), (one, d - a), (other, a - c), (other, b - c))]
    crossing = (sides[0] * sides[1] < 0) & (sides[2] * sides[3] < 0)
    one, other, between = one[crossing], other[crossing], (c - a)[crossing]
    share = _cross(between, other) / _cross(one, other)
    return crossing, np.rint(a[crossing] + share[:, None] * one).astype(np.int64)


def _split(edges: _Edges, owners: NDArray[np.int64], points: Points) -> _Edges:
    """Cut edges at points of theirs."""
    numbers = np.arange(len(edges.starts))
    owner = np.concatenate([numbers, owners, numbers])
    chain = np.concatenate([edges.starts, points, edges.ends])
    along = (edges.ends - edges.starts)[owner]
    reached = ((chain - edges.starts[owner]) * along).sum(axis=1)
    # Starts come first and ends last, also where rounding says otherwise.
    rank = np.repeat([0, 1, 2], [len(numbers), len(owners), len(numbers)])
    order = np.lexsort((reached, rank, owner))
    owner, chain = owner[order], chain[order]
    same = owner[:-1] == owner[1:]
    return _Edges.merged(chain[:-1][same], chain[1:][same], edges.counts[owner[:-1][same]])


def _one_sided(edges: _Edges, rule: Rule) -> _Edges:
    """Keep the edges of which one side is filled, once each, with that on their left."""
    along = edges.ends - edges.starts
    steep = np.abs(along[:, 1]) >= np.abs(along[:, 0])
    beyond = np.where(steep, _turns_beyond(edges, 0, steep), _turns_beyond(edges, 1, ~steep))
    # Upward edges beyond a point turn around it; so do leftward ones above it.
    own = edges.counts * np.where(steep, np.sign(along[:, 1]), -np.sign(along[:, 0]))
    far, near = _is_inside(beyond, rule), _is_inside(beyond + own, rule)
    # Left of an upward edge is the near side, left of a rightward one is the far side, above.
    forwards = np.where(steep, near == (along[:, 1] > 0), far == (along[:, 0] > 0))
    kept = far != near
    starts = np.where(forwards[:, None], edges.starts, edges.ends)[kept]
    ends = np.where(forwards[:, None], edges.ends, edges.starts)[kept]
    return _Edges(starts, ends, np.ones(len(starts), np.int64))


def _is_inside(turns: NDArray[np.int64], rule: Rule) -> NDArray[np.bool_]:
    return turns != 0 if rule == "non-zero" else turns % 2 != 0


def _turns_beyond(edges: _Edges, axis: int, wanted: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Count, for the middles of some edges, the signed edges that a ray along an axis meets beyond them, (e,)."""
    other = 1 - axis
    # Doubled, so that middles are whole numbers.
    starts, ends = 2 * edges.starts, 2 * edges.ends
    rising = starts[:, other] < ends[:, other]
    low, high = np.where(rising[:, None], starts, ends), np.where(rising[:, None], ends, starts)
    sign = np.where(rising, edges.counts, -edges.counts) * (1 if axis == 0 else -1)
    level = low[:, other] != high[:, other]
    low, high, sign, number = low[level], high[level], sign[level], np.flatnonzero(level)
    found = np.zeros(len(edges.starts), np.int64)
    rows = np.flatnonzero(wanted)
    for part in np.array_split(rows, max(1, len(rows) * len(low) // _AT_ONCE)):
        middle = edges.starts[part] + edges.ends[part]
        place, height = middle[:, axis, None], middle[:, other, None]
        hit = (low[:, other] <= height) & (height < high[:, other]) & (part[:, None] != number)
        row, column = np.nonzero(hit)
        rise, run = (high - low)[column, other], (high - low)[column, axis]
        away = (place[row, 0] - low[column, axis]) * rise - (height[row, 0] - low[column, other]) * run
        found[part] = np.bincount(row, sign[column] * (away < 0), minlength=len(part)).astype(np.int64)
    return found


def _cross(one: NDArray, other: NDArray) -> NDArray:
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
