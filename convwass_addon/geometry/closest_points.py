# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a surface that are closest to others, exactly and many at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from ..progress import UNINTERRUPTED, Control

# Samples that a surface gets at least, so that large triangles have some all over, and per triangle.
_SAMPLES, _SAMPLES_PER_TRIANGLE = 20_000, 1
# No triangle gets more than the square of this.
_MOST_CUTS = 250
# Samples about a point whose triangles are looked at first.
_NEIGHBORS = 4
# Points that are looked up at once: what they need is some hundred bytes for every neighbor.
_AT_ONCE = 20_000


@dataclass(frozen=True)
class ClosestPoints:
    """Where on a surface the closest points lie.

    Attributes
    ----------
    triangles : (n,) int64
        The triangle of each; where several are equally close, any of them.
    shares : (n, 3) float64
        Barycentric coordinates in it: not negative, of sum 1.
    distances : (n,) float64
        How far away they are.
    """

    triangles: NDArray[np.int64]
    shares: NDArray[np.float64]
    distances: NDArray[np.float64]

    def interpolated(self, corners: NDArray) -> NDArray[np.float64]:
        """Interpolate values of all corners, (m, 3, d), at the points, (n, d)."""
        return np.einsum("nc,ncd->nd", self.shares, corners[self.triangles])

    def replaced(self, chosen: NDArray[np.int64], other: ClosestPoints) -> ClosestPoints:
        """Return these points with some of them, by their numbers, replaced by others of the same surface."""
        found = ClosestPoints(*(values.copy() for values in vars(self).values()))
        for name, values in vars(found).items():
            values[chosen] = vars(other)[name]
        return found

    def followed_by(self, other: ClosestPoints) -> ClosestPoints:
        """Return these points and then others of the same surface."""
        return ClosestPoints(*(np.concatenate([own, vars(other)[name]]) for name, own in vars(self).items()))


class ClosestPointFinder:
    """Finds closest points on one surface.

    Every triangle is sampled so that none of its points is farther than a radius r from one of its samples. A triangle
    whose samples are all farther than d + r is farther than d; so those with a sample within d + r of a point, d being
    the distance to any triangle, are all that need to be measured.

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
        samples, self._owners, self._radius = _samples(self._corners)
        self._tree = cKDTree(samples, leafsize=32)

    def find(self, points: ArrayLike, control: Control = UNINTERRUPTED) -> ClosestPoints:
        """Find the point of the surface that is closest to each of `points`, (n, 3) finite numbers.

        Cancelling `control` ends the search.
        """
        wanted, found = _begun(points)
        for some in _chunks(len(wanted)):
            control.check()
            reached = self._look_about(wanted[some], some.start, found)
            self._look_further(wanted[some], some.start, found, reached)
        return found

    def find_about(self, points: ArrayLike, control: Control = UNINTERRUPTED) -> ClosestPoints:
        """Find the closest points of the triangles whose samples are nearest, (n, 3): a fifth of the work.

        They are farther away than the closest of all by r at the most, and hardly ever farther at all.
        """
        wanted, found = _begun(points)
        for some in _chunks(len(wanted)):
            control.check()
            self._look_about(wanted[some], some.start, found)
        return found

    def _look_about(self, points: NDArray[np.float64], start: int, found: ClosestPoints) -> NDArray[np.float64]:
        """Measure the triangles of the nearest samples; return how far away the others are at least, (n,)."""
        count = min(_NEIGHBORS, len(self._owners))
        distances, samples = self._tree.query(points, count)
        distances, owners = distances.reshape(-1, count), self._owners[samples.reshape(-1, count)]
        first = closest_in_triangles(self._corners[owners[:, 0]], points)
        # Of neighboring samples many are of the same triangle, and some too far away.
        promising = distances - self._radius < first.distances[:, None]
        promising[:, 0] = False
        for column in range(1, count):
            promising[:, column] &= (owners[:, column, None] != owners[:, :column]).all(axis=1)
        queries, columns = np.nonzero(promising)
        self._take(found, start + np.arange(len(points)), owners[:, 0], first)
        self._measure(points, queries, owners[queries, columns], start, found)
        return distances[:, -1] - self._radius if count < len(self._owners) else np.full(len(points), np.inf)

    def _look_further(
        self, points: NDArray[np.float64], start: int, found: ClosestPoints, reached: NDArray[np.float64]
    ) -> None:
        """Measure all other triangles that may be closer, for points that have such."""
        best = found.distances[start : start + len(points)]
        unsure = np.flatnonzero(reached < best)
        if not len(unsure):
            return
        balls = self._tree.query_ball_point(points[unsure], best[unsure] + self._radius)
        queries = np.repeat(unsure, [len(ball) for ball in balls])
        owners = self._owners[np.fromiter(chain.from_iterable(balls), np.int64, len(queries))]
        # Pairs as single numbers, which are sorted much faster.
        pairs = np.unique(queries * len(self._corners) + owners)
        for some in _chunks(len(pairs), _AT_ONCE * _NEIGHBORS):
            self._measure(points, *np.divmod(pairs[some], len(self._corners)), start, found)

    def _measure(
        self,
        points: NDArray[np.float64],
        queries: NDArray[np.int64],
        triangles: NDArray[np.int64],
        start: int,
        found: ClosestPoints,
    ) -> None:
        """Measure pairs of a point and a triangle, and keep the best of each point if it is better than what it has."""
        if not len(queries):
            return
        own = closest_in_triangles(self._corners[triangles], points[queries])
        order = np.lexsort((own.distances, queries))
        best = order[np.flatnonzero(np.diff(queries[order], prepend=-1))]
        best = best[own.distances[best] < found.distances[start + queries[best]]]
        self._take(found, start + queries[best], triangles[best], own, best)

    @staticmethod
    def _take(
        found: ClosestPoints,
        places: NDArray[np.int64],
        triangles: NDArray[np.int64],
        own: InTriangle,
        chosen: NDArray[np.int64] | slice = slice(None),
    ) -> None:
        found.triangles[places] = triangles
        found.shares[places] = own.shares[chosen]
        found.distances[places] = own.distances[chosen]


@dataclass(frozen=True)
class InTriangle:
    """Closest points of one triangle each.

    Attributes
    ----------
    shares : (n, 3) float64
        Barycentric coordinates: not negative, of sum 1.
    distances : (n,) float64
        How far away they are.
    """

    shares: NDArray[np.float64]
    distances: NDArray[np.float64]


def _begun(points: ArrayLike) -> tuple[NDArray[np.float64], ClosestPoints]:
    """Return points as an array and answers to be filled in."""
    wanted = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    count = len(wanted)
    return wanted, ClosestPoints(np.zeros(count, np.int64), np.zeros((count, 3)), np.full(count, np.inf))


def _chunks(count: int, size: int = _AT_ONCE) -> Iterator[slice]:
    return (slice(start, min(start + size, count)) for start in range(0, count, size))


def _samples(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64], float]:
    """Sample triangles: points (s, 3), the triangle of each (s,), and the radius in which every point has a sample.

    A triangle is cut into n^2 similar ones, n along each edge, and sampled at their centers.
    """
    centers = corners.mean(axis=1)
    reach = np.linalg.norm(corners - centers[:, None], axis=2).max(axis=1)
    wanted = max(_SAMPLES, _SAMPLES_PER_TRIANGLE * len(corners))
    spacing = np.sqrt(np.square(reach).sum() / wanted)
    cuts = np.ones(len(corners), np.int64)
    if spacing > 0:
        cuts = np.clip(np.round(reach / spacing), 1, _MOST_CUTS).astype(np.int64)
    points, owners = [], []
    for count in np.unique(cuts):
        own = np.flatnonzero(cuts == count)
        shares = _cut_centers(int(count))
        points.append(np.einsum("sc,mcd->msd", shares, corners[own]).reshape(-1, 3))
        owners.append(np.repeat(own, len(shares)))
    return np.concatenate(points), np.concatenate(owners), float((reach / cuts).max())


def _cut_centers(count: int) -> NDArray[np.float64]:
    """Barycentric coordinates of the centers of the count^2 triangles that a triangle is cut into, (count^2, 3)."""
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(count), np.arange(count), indexing="ij"))
    upright = i + j < count
    turned = i + j < count - 1
    first = np.concatenate([i[upright] + 1.0 / 3.0, i[turned] + 2.0 / 3.0]) / count
    second = np.concatenate([j[upright] + 1.0 / 3.0, j[turned] + 2.0 / 3.0]) / count
    return np.stack([1.0 - first - second, first, second], axis=1)


def closest_in_triangles(corners: NDArray[np.float64], points: NDArray[np.float64]) -> InTriangle:
    """Closest points of one triangle each, (n, 3, 3), to points (n, 3).

    That is the foot of the perpendicular where it lies inside, or else the closest point of the three edges.
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    best = np.full(len(points), np.inf)
    shares = np.zeros((len(points), 3))
    for first, second, (one, other) in ((a, b, (0, 1)), (b, c, (1, 2)), (c, a, (2, 0))):
        edge, offset = second - first, points - first
        length = np.einsum("nd,nd->n", edge, edge)
        along = np.einsum("nd,nd->n", edge, offset) / np.where(length > 0, length, 1.0)
        np.clip(along, 0.0, 1.0, out=along)
        offset -= along[:, None] * edge
        distance = np.einsum("nd,nd->n", offset, offset)
        better = distance < best
        np.copyto(best, distance, where=better)
        rows = np.flatnonzero(better)
        shares[rows] = 0.0
        shares[rows, one], shares[rows, other] = 1.0 - along[rows], along[rows]
    ab, ac, ap = b - a, c - a, points - a
    normal = np.cross(ab, ac)
    area = np.einsum("nd,nd->n", normal, normal)
    safe = np.where(area > 0, area, 1.0)
    at_b = np.einsum("nd,nd->n", np.cross(ap, ac), normal) / safe
    at_c = np.einsum("nd,nd->n", np.cross(ab, ap), normal) / safe
    height = np.square(np.einsum("nd,nd->n", ap, normal)) / safe
    inside = (area > 0) & (at_b >= 0) & (at_c >= 0) & (at_b + at_c <= 1.0) & (height < best)
    np.copyto(best, height, where=inside)
    inner = np.stack([1.0 - at_b - at_c, at_b, at_c], axis=1)
    np.copyto(shares, inner, where=inside[:, None])
    return InTriangle(shares, np.sqrt(best))
