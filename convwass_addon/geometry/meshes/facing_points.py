# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Nearest-point queries that respect the orientation, to avoid the far side of an ear or a wing.

`FacingPointFinder` takes the closest point if that faces the right way. `OrientedSamples` always weighs distance
against direction and measures only one triangle per point, for iterations that query repeatedly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...progress import UNINTERRUPTED, Control
from ..arrays.chunks import chunks
from .barycentric import points_of_triangles
from .closest_points import ClosestPointFinder, ClosestPoints, closest_in_triangles
from .mesh import TriangleMesh
from .point_tree import point_tree

# Points are looked up again if the cosine between their normal and the triangle's is below this.
_AWAY = 0.2
# Distance that counts as much as a normal turned by 60 degrees, relative to the square root of the surface's area.
_TURN = 0.05
# Triangles measured for each point.
_CANDIDATES = 8
# Points processed together.
_AT_ONCE = 1 << 16
# Shorter normals are ignored as unreliable.
_VAGUE = 0.2


class FacingPointFinder:
    """Finds close points on one surface that face a given direction.

    Parameters
    ----------
    mesh : TriangleMesh
        At least one triangle, finite coordinates.
    """

    def __init__(self, mesh: TriangleMesh) -> None:
        self._corners = mesh.corners
        self._closest = ClosestPointFinder(mesh.corners)
        self._normals = mesh.face_normals
        self._turn = _TURN * mesh.root_area
        self._tree: cKDTree | None = None

    def find(
        self, points: NDArray[np.float64], normals: NDArray[np.float64], control: Control = UNINTERRUPTED
    ) -> ClosestPoints:
        """Find a point on the surface for each of `points`, (n, 3).

        Parameters
        ----------
        points : (n, 3)
            Query points.
        normals : (n, 3)
            Desired surface normals, of length at most 1; the shorter, the less reliable.
        control : Control
            Stops the search when cancelled.
        """
        found = self._closest.find_about(points, control)
        lengths = np.linalg.norm(normals, axis=1)
        agreement = np.einsum("nd,nd->n", self._normals[found.triangles], normals)
        again = np.flatnonzero((lengths > _VAGUE) & (agreement < _AWAY * lengths))
        if not len(again):
            return found
        units = normals / np.maximum(lengths, _VAGUE)[:, None]
        for some in chunks(len(again), _AT_ONCE):
            control.check()
            self._search_by_position_and_normal(found, again[some], points, units)
        return found

    @property
    def closest(self) -> ClosestPointFinder:
        """The finder of closest points, regardless of normals."""
        return self._closest

    def find_closest(self, points: NDArray[np.float64], control: Control = UNINTERRUPTED) -> ClosestPoints:
        """Find the closest point on the surface for each of `points`, (n, 3), regardless of its normal."""
        return self._closest.find_about(points, control)

    def _search_by_position_and_normal(
        self, found: ClosestPoints, again: NDArray[np.int64], points: NDArray[np.float64], normals: NDArray[np.float64]
    ) -> None:
        """Replace some results by triangles that are close in position and normal."""
        if self._tree is None:
            self._tree = point_tree(np.concatenate([self._corners.mean(axis=1), self._turn * self._normals], axis=1))
        count = min(_CANDIDATES, len(self._corners))
        wanted = np.concatenate([points[again], self._turn * normals[again]], axis=1)
        candidates = self._tree.query(wanted, count)[1].reshape(len(again), count)
        candidates = np.concatenate([found.triangles[again, None], candidates], axis=1)
        flat = candidates.ravel()
        repeats = np.repeat(again, candidates.shape[1])
        own = closest_in_triangles(self._corners[flat], points[repeats])
        turned = 2.0 * self._turn**2 * (1.0 - np.einsum("nd,nd->n", self._normals[flat], normals[repeats]))
        costs = (np.square(own.distances) + turned).reshape(candidates.shape)
        best = np.arange(len(again)) * candidates.shape[1] + costs.argmin(axis=1)
        found.triangles[again], found.shares[again] = flat[best], own.shares[best]
        found.distances[again] = own.distances[best]


@dataclass(frozen=True)
class FacingShape:
    """A surface for nearest-point queries.

    Attributes
    ----------
    mesh : TriangleMesh
        At least one triangle, finite coordinates.
    """

    mesh: TriangleMesh

    @cached_property
    def finder(self) -> FacingPointFinder:
        """The finder, built on first use."""
        return FacingPointFinder(self.mesh)

    def ready(self) -> FacingShape:
        """Build the finder, which threads that need it at the same time would each build; return the surface."""
        _ = self.finder
        return self

    def __getstate__(self) -> dict[str, object]:
        # The finder is not pickled, because it is quick to rebuild.
        return {"mesh": self.mesh}


class OrientedSamples:
    """Finds points on one surface that are approximately closest in position and normal together.

    Parameters
    ----------
    mesh : TriangleMesh
        At least one triangle, finite coordinates.
    turn : float
        Distance that counts as much as a normal turned by 90 degrees, divided by the square root of two.
    """

    # The center of a triangle and the midpoints between it and the corners.
    _SHARES = np.array([[2, 2, 2], [4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6.0

    def __init__(self, mesh: TriangleMesh, turn: float) -> None:
        self._corners, self._turn = mesh.corners, turn
        normals = mesh.vertex_normals
        smooth = points_of_triangles(self._SHARES, normals[mesh.faces])
        smooth += np.repeat(mesh.face_normals, len(self._SHARES), axis=0)
        smooth /= np.maximum(np.linalg.norm(smooth, axis=1, keepdims=True), np.finfo(float).tiny)
        samples = points_of_triangles(self._SHARES, mesh.corners)
        self._tree = point_tree(np.concatenate([samples, turn * smooth], axis=1))

    def find(self, points: NDArray[np.float64], normals: NDArray[np.float64]) -> ClosestPoints:
        """Find a point for each of `points`, (n, 3), with unit normals, (n, 3): the closest on the nearest triangle."""
        nearest = self._tree.query(np.concatenate([points, self._turn * normals], axis=1))[1]
        triangles = nearest // len(self._SHARES)
        found = closest_in_triangles(self._corners[triangles], points)
        return ClosestPoints(triangles, found.shares, found.distances)
