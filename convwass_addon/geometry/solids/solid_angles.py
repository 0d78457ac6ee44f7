# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside tests by winding number, distances to the surface, and nearest points inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays.chunks import chunks
from ..meshes.closest_points import ClosestPointFinder
from ..meshes.mesh import TriangleMesh

# Pairs of a point and a triangle processed together; each needs a few hundred bytes.
_PAIRS = 1 << 18
# Rays start at this fraction of the body's size behind the surface, so that they do not hit it at their origin.
_SKIN = 1e-6
# Tilt of the rays that are tried if the straight one misses the inside.
_TILT = 0.35
# Number of places on the surface tried for a point if there is no inside behind the nearest one.
_FARTHER = 64


def winding_numbers(points: ArrayLike, mesh: TriangleMesh) -> NDArray[np.float64]:
    """Generalized winding numbers of a mesh about points.

    The sum of signed solid angles over 4 pi (Van Oosterom and Strackee 1983; Jacobson et al. 2013).

    Parameters
    ----------
    points : (k, 3)
        Query points.
    mesh : TriangleMesh
        Oriented outward; open and self-intersecting meshes are allowed.

    Returns
    -------
    (k,) float64
        About 1 inside, 0 outside, 2 where two solids overlap.
    """
    wanted = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    result = np.zeros(len(wanted))
    for some in chunks(len(wanted), max(1, _PAIRS // max(len(mesh.faces), 1))):
        a, b, c = (mesh.corners[None, :, i] - wanted[some, None] for i in range(3))
        la, lb, lc = (np.sqrt(_dot(x, x)) for x in (a, b, c))
        numerator = _dot(a, np.cross(b, c))
        denominator = la * lb * lc + _dot(a, b) * lc + _dot(b, c) * la + _dot(c, a) * lb
        result[some] = np.arctan2(numerator, denominator).sum(axis=1) / (2.0 * np.pi)
    return result


@dataclass(frozen=True)
class NearestInside:
    """Points inside a body that are nearest to given points.

    Attributes
    ----------
    positions : (k, 3) float64
        The points inside; the given points where none was found.
    found : (k,) bool
        Whether one was found.
    """

    positions: NDArray[np.float64]
    found: NDArray[np.bool_]


class Inside:
    """Inside and outside tests for one body.

    Parameters
    ----------
    mesh : TriangleMesh
        Oriented outward, with at least one face.
    """

    def __init__(self, mesh: TriangleMesh) -> None:
        self._mesh = mesh
        self._closest = ClosestPointFinder(mesh.corners)
        self._normals = mesh.face_normals
        self._size = mesh.diagonal

    def winding(self, points: ArrayLike) -> NDArray[np.float64]:
        """Winding numbers about points, (k, 3)."""
        return winding_numbers(points, self._mesh)

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return which points, (k, 3), lie inside: those with a winding number above one half."""
        return self.winding(points) > 0.5

    def distances(self, points: ArrayLike) -> NDArray[np.float64]:
        """How far points, (k, 3), are from the surface."""
        return self._closest.find(points).distances

    def nearest(self, points: ArrayLike, depth: float) -> NearestInside:
        """Return the points inside that are nearest to points outside.

        A ray enters the body at the nearest surface point. The result is at `depth` on the ray, or in the middle of the
        body where it is less than twice `depth` thick along the ray.

        Parameters
        ----------
        points : (k, 3)
            Query points.
        depth : float
            Depth below the surface, positive.
        """
        wanted = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        places, found = wanted.copy(), np.zeros(len(wanted), bool)
        near = self._closest.find(wanted)
        feet = near.interpolated(self._mesh.corners)
        for index, (point, foot, triangle) in enumerate(zip(wanted, feet, near.triangles, strict=True)):
            place = self._behind(foot, _directions(foot - point, -self._normals[triangle], self._size), depth)
            place = self._behind_others(point, depth) if place is None else place
            if place is not None:
                places[index], found[index] = place, True
        return NearestInside(places, found)

    def _behind_others(self, point: NDArray[np.float64], depth: float) -> NDArray[np.float64] | None:
        """Try the triangles with the nearest centers, because the nearest one may be part of an open sheet."""
        middles = self._mesh.corners.mean(axis=1)
        order = np.argsort(np.linalg.norm(middles - point, axis=1), kind="stable")
        # Sample ever more sparsely with the distance, because neighbors of a sheet mostly belong to it.
        chosen = np.unique(np.geomspace(1, len(order), min(_FARTHER, len(order))).astype(int)) - 1
        for triangle in order[chosen]:
            place = self._behind(middles[triangle], [-self._normals[triangle]], depth)
            if place is not None:
                return place
        return None

    def _behind(
        self, foot: NDArray[np.float64], directions: list[NDArray[np.float64]], depth: float
    ) -> NDArray[np.float64] | None:
        """Return the result for the first direction that leads inside; None if none does."""
        for direction in directions:
            thickness = self.first_hit(foot + _SKIN * self._size * direction, direction)
            place = foot + min(depth, 0.5 * thickness) * direction
            if self.contains(place[None])[0]:
                return place
        return None

    def first_hit(self, start: NDArray[np.float64], direction: NDArray[np.float64]) -> float:
        """Distance along a ray to its first hit of the surface; infinite without a hit (Möller and Trumbore 1997)."""
        a, b, c = np.moveaxis(self._mesh.corners, 1, 0)
        first, second = b - a, c - a
        across = np.cross(direction, second)
        determinant = _dot(first, across)
        safe = np.where(determinant != 0, determinant, 1.0)
        offset = start - a
        u = _dot(offset, across) / safe
        turned = np.cross(offset, first)
        v = turned @ direction / safe
        away = _dot(second, turned) / safe
        hit = (determinant != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (away > 0)
        return float(away[hit].min(initial=np.inf))


def _directions(toward: NDArray[np.float64], inward: NDArray[np.float64], size: float) -> list[NDArray[np.float64]]:
    """Return unit vectors to try: on through the surface, along the inward normal, and tilted from it to all sides."""
    length = np.linalg.norm(toward)
    straight = [toward / length] if length > _SKIN * size else []
    side = np.cross(inward, np.eye(3)[np.argmin(np.abs(inward))])
    sides = [s * _TILT * d for d in (side, np.cross(inward, side)) for s in (1.0, -1.0)]
    tilted = [inward + s for s in sides]
    return [*straight, inward, *(d / max(np.linalg.norm(d), np.finfo(float).tiny) for d in tilted)]


def _dot(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.einsum("...i,...i->...", first, second)
