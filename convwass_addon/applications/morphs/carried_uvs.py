# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer UV maps of the shapes to the corners of a blend's triangles.

Every triangle of the blend is assigned to one triangle of the shape, its home triangle. A corner gets the UVs at its
origin if no seam separates the origin from the home triangle. Otherwise it gets those of the nearest point on the near
side of the seam, so that no triangle of the blend extends across the texture.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.arrays.chunks import chunks
from ...geometry.meshes.barycentric import barycentric_coordinates, clamped_to_triangle
from ...geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints, closest_in_triangles
from ...geometry.meshes.normals import triangle_areas
from ...geometry.meshes.uv_charts import SEAM_DETOUR, chart_labels, uv_sizes

# Number of triangles of the shape tried for each corner beyond a seam.
_CANDIDATES = 8
# Distance by which the texture is extrapolated beyond the border of an island, relative to its width: 10 pixels at 2K.
# Textures usually have margins around islands; those of Blender's bakes are 16 pixels wide.
_MARGIN = 0.005
# Number of triangles of a blend that are processed together, which limits the memory.
_AT_ONCE = 1 << 15


@dataclass(frozen=True)
class UvMap:
    """A UV map of a shape.

    Attributes
    ----------
    corners : (m, 3, 3) float64
        Triangles of the shape, in the same space as origins.
    faces : (m, 3) int64
        Vertices of the triangles.
    uvs : (m, 3, 2) float64
        UVs of their corners.
    repeats : bool
        Whether all textures that use the map repeat. UVs that differ by integers are then equal, and seams between them
        are ignored.
    """

    corners: NDArray[np.float64]
    faces: NDArray[np.int64]
    uvs: NDArray[np.float64]
    repeats: bool = False

    @cached_property
    def charts(self) -> NDArray[np.int64]:
        """The island of every triangle, (m,)."""
        return chart_labels(self.faces, self.uvs, repeats=self.repeats)

    @cached_property
    def sizes(self) -> NDArray[np.float64]:
        """The length in the texture of a unit of length on every triangle, (m,)."""
        return uv_sizes(self.corners, self.uvs)

    @cached_property
    def middles(self) -> NDArray[np.float64]:
        """The centers of the triangles, (m, 3)."""
        return self.corners.mean(axis=1)

    @cached_property
    def middle_uvs(self) -> NDArray[np.float64]:
        """The UVs of these centers, (m, 2)."""
        return self.uvs.mean(axis=1)

    @cached_property
    def scale(self) -> float:
        """The mean length on the shape of a unit of length in the texture."""
        areas = triangle_areas(self.corners)
        mean = float(np.average(self.sizes, weights=areas)) if areas.any() else 0.0
        return 1.0 / mean if mean > 0.0 else 0.0

    @cached_property
    def tree(self) -> cKDTree:
        """The centers of the triangles, in space and in the texture, scaled alike: (m, 5)."""
        return cKDTree(np.concatenate([self.middles, self.scale * self.middle_uvs], axis=1))

    def at(
        self,
        places: ClosestPoints,
        faces: NDArray[np.int64],
        origins: NDArray[np.floating],
        homes: NDArray[np.int64],
    ) -> NDArray[np.float32]:
        """Return the UVs of the corners of a blend's triangles.

        Parameters
        ----------
        places : ClosestPoints
            Origins of the blend's vertices on the shape.
        faces : (f, 3) int64
            Triangles of the blend.
        origins : (n, 3)
            Origins as points, on or close to the shape.
        homes : (f,) int64
            The triangle of the shape that each triangle of the blend belongs to; see :func:`home_triangles`.

        Returns
        -------
        (f, 3, 2) float32
            Exact for triangles within one triangle of the shape, or within several triangles of one island.
        """
        # Single precision is enough, and much faster: it tells a thousandth of a pixel at 8K.
        own = places.interpolated(self.uvs).astype(np.float32)
        found = own[faces]
        if self.repeats:
            found -= np.rint(found - found[:, :1])
        apart = np.empty(len(faces), bool)
        for some in chunks(len(faces), _AT_ONCE):
            apart[some] = ~self._are_together(
                places.triangles[faces[some]], origins[faces[some]], found[some], homes[some]
            )
        apart = np.flatnonzero(apart)
        if len(apart):
            rest = faces[apart]
            uvs = own[rest].astype(np.float64)
            found[apart] = self._with_homes(places.triangles[rest], uvs, origins[rest], homes[apart])
        return found

    def _are_together(
        self,
        triangles: NDArray[np.int64],
        points: NDArray[np.floating],
        uvs: NDArray[np.float64],
        homes: NDArray[np.int64],
    ) -> NDArray[np.bool_]:
        """Return for which triangles of a blend no seam is between the corners and the home, (f,).

        Parameters
        ----------
        triangles, points, uvs : (f, 3), (f, 3, 3), (f, 3, 2)
            Of the corners.
        homes : (f,)
            Of the triangles.
        """
        together = (self.charts[triangles] == self.charts[homes][:, None]).all(axis=1)
        reach = SEAM_DETOUR * np.maximum(self.sizes[homes], self.sizes[triangles[:, 0]])
        points = points.astype(np.float32, copy=False)
        for corner in (1, 2):
            way, step = points[:, corner] - points[:, 0], uvs[:, corner] - uvs[:, 0]
            together &= _lengths(step) <= reach * _lengths(way)
        way, step = self.middles[homes] - points[:, 0], self.middle_uvs[homes] - uvs[:, 0]
        if self.repeats:
            step -= np.rint(step)
        return together & (_lengths(step) <= reach * _lengths(way))

    def _with_homes(
        self,
        triangles: NDArray[np.int64],
        uvs: NDArray[np.float64],
        points: NDArray[np.floating],
        homes: NDArray[np.int64],
    ) -> NDArray[np.float64]:
        """Return the UVs of triangles, some corners of which may be beyond a seam; parameters as above."""
        points, found = points.astype(np.float64), uvs
        means = points.mean(axis=1, keepdims=True)
        middles = clamped_to_triangle(barycentric_coordinates(self.corners[homes], means))
        middle_uvs = middles @ self.uvs[homes]
        distances = np.linalg.norm(points - middles @ self.corners[homes], axis=2)
        if self.repeats:
            found = found - np.rint(found - middle_uvs)
        reach = SEAM_DETOUR * np.maximum(self.sizes[homes][:, None], self.sizes[triangles]) * distances
        near = np.linalg.norm(found - middle_uvs, axis=2) <= reach
        same = self.charts[triangles] == self.charts[homes][:, None]
        row, corner = np.nonzero(~((near & same) | (triangles == homes[:, None])))
        if len(row):
            asked = _Beyond(points[row, corner], homes[row], middle_uvs[row, 0], reach[row, corner])
            found[row, corner] = self._on_this_side(asked)
        return found

    def _on_this_side(self, asked: _Beyond) -> NDArray[np.float64]:
        """Return UVs for corners beyond a seam, on the near side of it, (n, 2).

        Among points close to where the home triangle would put the corner, in space and in the texture together, the
        closest is taken. From there the texture is extrapolated up to the margin.
        """
        shares = barycentric_coordinates(self.corners[asked.homes], asked.points[:, None])
        expected = (shares @ self.uvs[asked.homes])[:, 0]
        expected = asked.middle_uvs + _shortened(expected - asked.middle_uvs, asked.reach)
        count = min(_CANDIDATES, len(self.corners))
        joint = np.concatenate([asked.points, self.scale * expected], axis=1)
        near = self.tree.query(joint, count)[1].reshape(-1, count)
        candidates = np.concatenate([asked.homes[:, None], near], axis=1)
        flat, each = candidates.ravel(), np.repeat(np.arange(len(asked.points)), candidates.shape[1])
        closest = closest_in_triangles(self.corners[flat], asked.points[each])
        uvs = np.einsum("nc,ncd->nd", closest.shares, self.uvs[flat])
        costs = np.square(closest.distances) + np.square(self.scale * np.linalg.norm(uvs - expected[each], axis=1))
        best = np.arange(len(candidates)) * candidates.shape[1] + costs.reshape(candidates.shape).argmin(axis=1)
        shares = barycentric_coordinates(self.corners[flat[best]], asked.points[:, None])
        ahead = (shares @ self.uvs[flat[best]])[:, 0] - uvs[best]
        return uvs[best] + _shortened(ahead, np.minimum(asked.reach, _MARGIN))


@dataclass(frozen=True)
class _Beyond:
    """Corners whose origins are beyond a seam.

    Attributes
    ----------
    points : (n, 3) float64
        Their origins.
    homes : (n,) int64
        The home triangles of their triangles.
    middle_uvs : (n, 2) float64
        UVs at the centers of their triangles.
    reach : (n,) float64
        Maximum distance of the corners from these centers in the texture.
    """

    points: NDArray[np.float64]
    homes: NDArray[np.int64]
    middle_uvs: NDArray[np.float64]
    reach: NDArray[np.float64]


def home_triangles(
    finder: ClosestPointFinder,
    labels: NDArray[np.int64],
    places: ClosestPoints,
    faces: NDArray[np.int64],
    origins: NDArray[np.floating],
    known: NDArray[np.integer] | None = None,
    owners: NDArray[np.int64] | None = None,
) -> NDArray[np.int64]:
    """Return the home triangle on a shape for each triangle of a blend, (f,).

    Parameters
    ----------
    finder : ClosestPointFinder
        Closest-point finder of the shape.
    labels : (m,) int64
        Part of each triangle of the shape, such as an island or a material.
    places : ClosestPoints
        Origins of the blend's vertices on the shape.
    faces : (f, 3) int64
        Triangles of the blend.
    origins : (n, 3)
        Origins as points, on or close to the shape.
    known : (f,) int, optional
        Home triangles that are known, otherwise -1. An unknown home is that of the first corner if all corners are on
        one part of the shape, and otherwise the triangle closest to the center.
    owners : (f,) int64, optional
        Polygon of each triangle; all triangles of a polygon get the home of the first.
    """
    corners = places.triangles[faces]
    homes = corners[:, 0].copy()
    parts = labels[corners]
    unsure = (parts != parts[:, :1]).any(axis=1)
    if known is not None:
        homes = np.where(known >= 0, known, homes)
        unsure &= known < 0
    if unsure.any():
        homes[unsure] = finder.find_about(origins[faces[unsure]].mean(axis=1)).triangles
    if owners is None:
        return homes
    _, first, polygon = np.unique(owners, return_index=True, return_inverse=True)
    return homes[first][polygon.reshape(-1)]


def _lengths(vectors: NDArray[np.floating]) -> NDArray[np.floating]:
    return np.sqrt(np.einsum("nd,nd->n", vectors, vectors))


def _shortened(vectors: NDArray[np.float64], most: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shorten vectors, (n, d), to at most some lengths, (n,)."""
    lengths = np.linalg.norm(vectors, axis=1)
    factors = np.where(lengths > most, most / np.where(lengths > 0.0, lengths, 1.0), 1.0)
    return factors[:, None] * vectors
