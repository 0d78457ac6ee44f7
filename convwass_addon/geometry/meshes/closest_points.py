# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact nearest-point queries on a triangle surface, for many points at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...progress import UNINTERRUPTED, Control
from ..arrays.chunks import chunks
from ..arrays.distinct import sorted_distinct
from .barycentric import points_of_triangles
from .normals import dot_coordinates
from .point_tree import point_tree

# Least number of samples of a surface, such that large triangles have many, and number of samples per triangle.
_SAMPLES, _SAMPLES_PER_TRIANGLE = 20_000, 1
# A triangle edge is cut into at most this many parts, which gives their square as samples.
_MOST_CUTS = 250
# Nearest samples of a point whose triangles are measured first.
_NEIGHBORS = 4
# Triangles with a smaller squared sine of a corner's angle count as edges: their coordinates would be inexact.
_FLAT = 1e-12
# Points processed together; each needs a few hundred bytes per neighbor.
_AT_ONCE = 20_000


@dataclass(frozen=True)
class ClosestPoints:
    """The closest points on a surface.

    Attributes
    ----------
    triangles : (n,) int64
        The triangle of each point; if several are equally close, any of them.
    shares : (n, 3) float64
        Barycentric coordinates in the triangle: nonnegative, of sum 1.
    distances : (n,) float64
        Distances to the closest points.
    """

    triangles: NDArray[np.int64]
    shares: NDArray[np.float64]
    distances: NDArray[np.float64]

    def interpolated(self, corners: NDArray) -> NDArray[np.float64]:
        """Interpolate values given at all corners, (m, 3, d), at the points, (n, d)."""
        return np.einsum("nc,ncd->nd", self.shares, corners.take(self.triangles, axis=0))

    def replaced(self, chosen: NDArray[np.int64], other: ClosestPoints) -> ClosestPoints:
        """Return these points with those at the indices `chosen` replaced by others on the same surface."""
        found = ClosestPoints(*(values.copy() for values in vars(self).values()))
        for name, values in vars(found).items():
            values[chosen] = vars(other)[name]
        return found

    def followed_by(self, other: ClosestPoints) -> ClosestPoints:
        """Concatenate these points and others on the same surface."""
        return ClosestPoints(*(np.concatenate([own, vars(other)[name]]) for name, own in vars(self).items()))


@dataclass(frozen=True)
class TriangleSamples:
    """Points distributed over triangles.

    Attributes
    ----------
    points : (s, 3) float64
        Evenly distributed unless some triangles are much smaller than others.
    triangles : (s,) int64
        The triangle of every point; each triangle has at least one.
    radius : float
        Every point of a triangle is at most this far from one of its samples.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    radius: float

    @classmethod
    def of(cls, corners: NDArray[np.float64]) -> TriangleSamples:
        """Sample triangles, (m, 3, 3), by at least 20 000 points, and about one for each."""
        wanted = max(_SAMPLES, _SAMPLES_PER_TRIANGLE * len(corners))
        reach = _reaches(corners)
        return cls._divided(corners, reach, np.sqrt(np.square(reach).sum() / wanted))

    @classmethod
    def spaced(cls, corners: NDArray[np.float64], radius: float) -> TriangleSamples:
        """Sample triangles, (m, 3, 3), so that every point of them is about `radius` from a sample, or less."""
        return cls._divided(corners, _reaches(corners), radius)

    @classmethod
    def _divided(cls, corners: NDArray[np.float64], reach: NDArray[np.float64], radius: float) -> TriangleSamples:
        """Divide every triangle into n^2 similar ones, n along each edge, and take their centers."""
        cuts = np.ones(len(corners), np.int64)
        if radius > 0:
            cuts = np.clip(np.round(reach / radius), 1, _MOST_CUTS).astype(np.int64)
        points, owners = [], []
        for count in np.unique(cuts):
            own = np.flatnonzero(cuts == count)
            points.append(points_of_triangles(_cut_centers(int(count)), corners[own]))
            owners.append(np.repeat(own, len(points[-1]) // len(own)))
        return cls(np.concatenate(points), np.concatenate(owners), float((reach / cuts).max()))

    def divided(self, amounts: NDArray[np.float64]) -> NDArray[np.float64]:
        """Divide an amount of every triangle, (m,), such as its area, evenly among its samples, (s,)."""
        return (amounts / np.bincount(self.triangles, minlength=len(amounts)))[self.triangles]


class ClosestPointFinder:
    """Finds closest points on one surface.

    Every triangle is sampled so that each of its points is within a radius r of one of its samples. If d is the
    distance of a query to any triangle, a triangle can only be closer if it has a sample within d + r. Only those
    triangles are measured.

    Parameters
    ----------
    corners : (m, 3, 3) float64
        Triangles, at least one; they may be degenerate.

    Raises
    ------
    ValueError
        No triangles, or coordinates that are not finite.
    """

    def __init__(self, corners: ArrayLike) -> None:
        self._corners = np.asarray(corners, dtype=np.float64)
        if self._corners.ndim != 3 or self._corners.shape[1:] != (3, 3) or not len(self._corners):
            raise ValueError(f"corners must be (m, 3, 3), with at least one triangle, not {np.shape(corners)}")
        if not np.isfinite(self._corners).all():
            raise ValueError("corners must be finite numbers")
        samples = TriangleSamples.of(self._corners)
        self._owners, self._radius = samples.triangles, samples.radius
        self._tree = point_tree(samples.points)

    def find(self, points: ArrayLike, control: Control = UNINTERRUPTED) -> ClosestPoints:
        """Find the closest point of the surface for each of `points`, (n, 3), which must be finite.

        Cancelling `control` stops the search.
        """
        wanted, found = _prepared(points)
        for some in chunks(len(wanted), _AT_ONCE):
            control.check()
            reached = self._measure_nearest(wanted[some], some.start, found)
            self._measure_remaining(wanted[some], some.start, found, reached)
        return found

    def find_about(self, points: ArrayLike, control: Control = UNINTERRUPTED) -> ClosestPoints:
        """Find the closest points on the triangles of the nearest samples, (n, 3), in a fifth of the time.

        Their distances exceed the true ones by at most r, and hardly ever at all.
        """
        wanted, found = _prepared(points)
        for some in chunks(len(wanted), _AT_ONCE):
            control.check()
            self._measure_nearest(wanted[some], some.start, found)
        return found

    def _measure_nearest(self, points: NDArray[np.float64], start: int, found: ClosestPoints) -> NDArray[np.float64]:
        """Measure the triangles of the nearest samples; return a lower bound on the distances of the others, (n,)."""
        count = min(_NEIGHBORS, len(self._owners))
        distances, samples = self._tree.query(points, count)
        distances = distances.reshape(-1, count)
        owners = self._owners.take(samples.reshape(-1, count))
        part = slice(start, start + len(points))
        self._take(found, part, owners[:, 0], closest_in_triangles(self._corners.take(owners[:, 0], axis=0), points))
        for column in range(1, count):
            # Skip repeated triangles, and those that are too far away.
            promising = distances[:, column] - self._radius < found.distances[part]
            for before in range(column):
                promising &= owners[:, column] != owners[:, before]
            rows = np.flatnonzero(promising)
            triangles = owners[:, column].take(rows)
            own = closest_in_triangles(self._corners.take(triangles, axis=0), points.take(rows, axis=0))
            better = np.flatnonzero(own.distances < found.distances[start + rows])
            self._take(found, start + rows[better], triangles[better], own, better)
        return distances[:, -1] - self._radius if count < len(self._owners) else np.full(len(points), np.inf)

    def _measure_remaining(
        self, points: NDArray[np.float64], start: int, found: ClosestPoints, reached: NDArray[np.float64]
    ) -> None:
        """Measure all other triangles that may be closer, for the points that have any."""
        best = found.distances[start : start + len(points)]
        unsure = np.flatnonzero(reached < best)
        if not len(unsure):
            return
        balls = self._tree.query_ball_point(points[unsure], best[unsure] + self._radius, return_sorted=False)
        queries = np.repeat(unsure, [len(ball) for ball in balls])
        owners = self._owners[np.fromiter(chain.from_iterable(balls), np.int64, len(queries))]
        # Encode pairs as single numbers, which sort much faster.
        pairs = sorted_distinct(queries * len(self._corners) + owners)
        for some in chunks(len(pairs), _AT_ONCE * _NEIGHBORS):
            self._measure(points, *np.divmod(pairs[some], len(self._corners)), start, found)

    def _measure(
        self,
        points: NDArray[np.float64],
        queries: NDArray[np.int64],
        triangles: NDArray[np.int64],
        start: int,
        found: ClosestPoints,
    ) -> None:
        """Measure pairs of points and triangles, and keep the best pair of each point if it improves the result."""
        if not len(queries):
            return
        own = closest_in_triangles(self._corners.take(triangles, axis=0), points.take(queries, axis=0))
        order = np.lexsort((own.distances, queries))
        best = order[np.flatnonzero(np.diff(queries[order], prepend=-1))]
        best = best[own.distances[best] < found.distances[start + queries[best]]]
        self._take(found, start + queries[best], triangles[best], own, best)

    @staticmethod
    def _take(
        found: ClosestPoints,
        places: NDArray[np.int64] | slice,
        triangles: NDArray[np.int64],
        own: InTriangle,
        chosen: NDArray[np.int64] | slice = slice(None),
    ) -> None:
        found.triangles[places] = triangles
        found.shares[places] = own.shares[chosen]
        found.distances[places] = own.distances[chosen]


@dataclass(frozen=True)
class InTriangle:
    """Closest points, each in one given triangle.

    Attributes
    ----------
    shares : (n, 3) float64
        Barycentric coordinates: nonnegative, of sum 1.
    distances : (n,) float64
        Distances to the closest points.
    """

    shares: NDArray[np.float64]
    distances: NDArray[np.float64]


def _prepared(points: ArrayLike) -> tuple[NDArray[np.float64], ClosestPoints]:
    """Return the points as an array, and a result to be filled in."""
    wanted = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    count = len(wanted)
    return wanted, ClosestPoints(np.zeros(count, np.int64), np.zeros((count, 3)), np.full(count, np.inf))


def _reaches(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distance from the center of every triangle, (m, 3, 3), to its farthest corner, (m,)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    centers = (a + b + c) / 3.0
    squares = [np.einsum("md,md->m", corner - centers, corner - centers) for corner in (a, b, c)]
    return np.sqrt(np.maximum(np.maximum(squares[0], squares[1]), squares[2]))


@lru_cache(maxsize=32)
def _cut_centers(count: int) -> NDArray[np.float64]:
    """Barycentric coordinates of the centers of the count^2 parts of a triangle, (count^2, 3)."""
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(count), np.arange(count), indexing="ij"))
    upright = i + j < count
    turned = i + j < count - 1
    first = np.concatenate([i[upright] + 1.0 / 3.0, i[turned] + 2.0 / 3.0]) / count
    second = np.concatenate([j[upright] + 1.0 / 3.0, j[turned] + 2.0 / 3.0]) / count
    return np.stack([1.0 - first - second, first, second], axis=1)


def closest_in_triangles(corners: NDArray[np.float64], points: NDArray[np.float64]) -> InTriangle:
    """Closest point of each triangle, (n, 3, 3), to its query point, (n, 3).

    This is the foot of the perpendicular if it lies inside, otherwise the closest point on the three edges.
    """
    # One contiguous array per coordinate: sums over rows of three numbers take four times as long.
    a, b, c = (np.ascontiguousarray(corners[:, corner].T) for corner in range(3))
    ab, ac, offset = b - a, c - a, points.T - a
    pairs = (ab, ab), (ab, ac), (ac, ac), (ab, offset), (ac, offset)
    products = _Products(*(dot_coordinates(*pair) for pair in pairs))
    second, third, inside = products.feet()
    first = 1.0 - second - third
    outside = np.flatnonzero(~inside)
    first[outside], second[outside], third[outside] = products.taken(outside).on_edges()
    offset -= second * ab
    offset -= third * ac
    return InTriangle(np.stack([first, second, third], axis=1), np.sqrt(dot_coordinates(offset, offset)))


@dataclass(frozen=True)
class _Products:
    """Scalar products, (n,), of two edges from the first corner, and of these with the offset of a point from there."""

    one: NDArray[np.float64]
    mixed: NDArray[np.float64]
    other: NDArray[np.float64]
    along_one: NDArray[np.float64]
    along_other: NDArray[np.float64]

    def taken(self, rows: NDArray[np.int64]) -> _Products:
        return _Products(*(values.take(rows) for values in vars(self).values()))

    def feet(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """Return two barycentric coordinates of the feet of perpendiculars, (n,) each, and which are inside, (n,)."""
        squared_area = self.one * self.other - self.mixed * self.mixed
        regular = squared_area > _FLAT * self.one * self.other
        scale = 1.0 / np.where(regular, squared_area, 1.0)
        second = (self.other * self.along_one - self.mixed * self.along_other) * scale
        third = (self.one * self.along_other - self.mixed * self.along_one) * scale
        return second, third, regular & (second >= 0.0) & (third >= 0.0) & (second + third <= 1.0)

    def on_edges(self) -> NDArray[np.float64]:
        """Return the barycentric coordinates of the closest points on the edges of triangles, (3, n)."""
        # The edge between the ends of both, and the offset from the end of the first along it.
        between = self.one - 2.0 * self.mixed + self.other
        rise = self.along_other - self.along_one + self.one - self.mixed
        on_one, on_other = _share(self.along_one, self.one), _share(self.along_other, self.other)
        on_third = _share(rise, between)
        # Squared distances, without the square of the offset, which is the same for all three edges.
        excess = [
            on_one * (on_one * self.one - 2.0 * self.along_one),
            self.one - 2.0 * self.along_one + on_third * (on_third * between - 2.0 * rise),
            on_other * (on_other * self.other - 2.0 * self.along_other),
        ]
        nearest, zero = np.argmin(excess, axis=0), np.zeros_like(on_one)
        return np.stack(
            [
                np.choose(nearest, [1.0 - on_one, zero, 1.0 - on_other]),
                np.choose(nearest, [on_one, 1.0 - on_third, zero]),
                np.choose(nearest, [zero, on_third, on_other]),
            ]
        )


def _share(along: NDArray[np.float64], length: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the closest point's fraction of the way along an edge; zero if the edge has no length."""
    return np.clip(along / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
