# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer UV maps to another mesh along a point map, with their seams.

Every face of the receiver belongs to one side of every seam: the side that contains its center. Corners whose points
lie on the other side are moved to the nearest point on this side, so that no face extends across the texture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from ...errors import InputError
from ...geometry.arrays.components import component_labels
from ...geometry.arrays.label_sums import label_sums
from ...geometry.meshes.closest_points import ClosestPointFinder, closest_in_triangles
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import doubled_areas, triangle_areas
from ...geometry.meshes.uv_charts import SEAM_DETOUR, SharedEdges, chart_labels, uv_sizes
from ...sentence import Sentence
from .surface_maps import PointMap
from .transfer import check_giver

# Number of triangles near a corner, and of points on the line to it from its face's center, that are tried for it.
_NEAR, _ON_THE_WAY = 32, 8
# Corners of adjacent faces are merged if they differ by less than this fraction of their shared edge.
_WELDED = 0.5
# If more than this fraction of the faces is flipped, the islands are too small for the receiver's faces.
_MOST_FOLDED = 0.1


@dataclass(frozen=True)
class TransferredUvs:
    """A UV map for a mesh.

    Attributes
    ----------
    uvs : (f, 3, 2) float64
        At the corners of every triangle; equal at all corners of a vertex within a polygon. Zero without a point.
    seams : (s, 2) int64
        Edges, as pairs of vertices, whose UVs differ between the two sides.
    notices : tuple of Sentence
        Warnings for the user.
    """

    uvs: NDArray[np.float64]
    seams: NDArray[np.int64]
    notices: tuple[Sentence, ...] = ()


def transferred_uvs(
    points: PointMap,
    giver: TriangleMesh,
    uvs: ArrayLike,
    receiver: TriangleMesh,
    polygons: ArrayLike | None = None,
) -> TransferredUvs:
    """Transfer the UV map of one mesh to another.

    Parameters
    ----------
    points : PointMap
        A point on the giver for each vertex of the receiver.
    giver : TriangleMesh
        The mesh that provides the UV map.
    uvs : (g, 3, 2)
        UVs at the corners of the giver's triangles.
    receiver : TriangleMesh
        The mesh that receives the UV map.
    polygons : (f,) int, optional
        The polygon of each of the receiver's triangles; no seam runs through a polygon. By default all are separate.

    Raises
    ------
    InputError
        Arrays that do not match the meshes, a UV map without area, or islands that are too small for the receiver's
        faces.
    """
    given = np.asarray(uvs, dtype=np.float64)
    check_giver(points, giver)
    if given.shape != (len(giver.faces), 3, 2) or not np.isfinite(given).all():
        raise InputError("A UV map must have two numbers for every corner of every face.")
    if len(points) != len(receiver.vertices):
        raise InputError("The map belongs to a mesh with other vertices; compute it again.")
    if not doubled_areas(given).any():
        raise InputError("The UV map has no area; unwrap the mesh that gives it first.")
    owners = np.arange(len(receiver.faces)) if polygons is None else np.asarray(polygons)
    known = points.found[receiver.faces].all(axis=1)
    # A polygon is transferred completely or not at all.
    unknown = np.unique(owners[~known])
    known = ~np.isin(owners, unknown)
    if not known.any():
        raise InputError("No face has all of its corners on the map; compute it again.")
    sides = _Sides.of(giver, given)
    found = np.zeros((len(receiver.faces), 3, 2))
    is_own = np.ones((len(receiver.faces), 3), bool)
    homes = np.zeros(len(receiver.faces), np.int64)
    found[known], is_own[known], homes[known] = sides.corners(points, receiver.faces[known], owners[known])
    shared = SharedEdges.of(receiver.faces)
    welded = _welded(found, is_own, shared, receiver.faces, owners, known)
    _check_folds(welded[known], given[homes[known]], receiver.corners[known])
    notices = []
    if not known.all():
        values = {"count": int((~known).sum())}
        notices.append(Sentence("{count} triangles have no counterpart and are missing from the UV map.", values))
    return TransferredUvs(welded, _seams(welded, shared, known), tuple(notices))


@dataclass(frozen=True)
class _Sides:
    """The giver's surface and texture, for finding points on one side of all seams.

    Attributes
    ----------
    mesh : TriangleMesh
    uvs : (g, 3, 2) float64
    charts : (g,) int64
        Island of every triangle.
    sizes : (g,) float64
        Texture length of a unit of length.
    finder : ClosestPointFinder
    centers : cKDTree
        Tree of the triangles' centers.
    """

    mesh: TriangleMesh
    uvs: NDArray[np.float64]
    charts: NDArray[np.int64]
    sizes: NDArray[np.float64]
    finder: ClosestPointFinder
    centers: cKDTree

    @classmethod
    def of(cls, mesh: TriangleMesh, uvs: NDArray[np.float64]) -> _Sides:
        sizes = uv_sizes(mesh.corners, uvs)
        finder = ClosestPointFinder(mesh.corners)
        return cls(mesh, uvs, chart_labels(mesh.faces, uvs), sizes, finder, cKDTree(mesh.corners.mean(axis=1)))

    def corners(
        self, points: PointMap, faces: NDArray[np.int64], owners: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.int64]]:
        """Return UVs of triangles' corners, (f, 3, 2), whether each is that of its own point, and the home triangles.

        The home triangle contains the center of the polygon.
        """
        images = points.at(self.mesh, self.mesh.vertices)[faces]
        rank = np.unique(owners, return_inverse=True)[1]
        counts = np.bincount(rank)[:, None]
        means = images.mean(axis=1)
        middles = label_sums(rank, means, len(counts)) / counts
        home = self.finder.find_about(middles)
        middle_uvs = home.interpolated(self.uvs)
        middle_points = home.interpolated(self.mesh.corners)
        # Continue with one entry per corner.
        asked = _Asked(
            np.repeat(home.triangles[rank], 3),
            np.repeat(middle_points[rank], 3, axis=0),
            np.repeat(middle_uvs[rank], 3, axis=0),
            images.reshape(-1, 3),
        )
        own_faces = points.faces[faces].ravel()
        shares = points.barycentric[faces].reshape(-1, 3).astype(np.float64)
        found = np.einsum("nk,nkd->nd", shares, self.uvs[own_faces])
        is_own = self._is_near(asked, own_faces, found, asked.images)
        away = np.flatnonzero(~is_own)
        if len(away):
            found[away] = self._nearest(asked.some(away))
        return found.reshape(-1, 3, 2), is_own.reshape(-1, 3), home.triangles[rank]

    def _is_near(
        self,
        asked: _Asked,
        faces: NDArray[np.int64],
        uvs: NDArray[np.float64],
        places: NDArray[np.float64],
    ) -> NDArray[np.bool_]:
        """Return whether points on triangles are on the same side of the seams as the homes."""
        size = np.maximum(self.sizes[asked.homes], self.sizes[faces])
        reach = SEAM_DETOUR * size * np.linalg.norm(places - asked.middles, axis=1)
        near = np.linalg.norm(uvs - asked.middle_uvs, axis=1) <= reach
        return (near & (self.charts[faces] == self.charts[asked.homes])) | (faces == asked.homes)

    def _nearest(self, asked: _Asked) -> NDArray[np.float64]:
        """Return the UVs of the nearest points on the same side of the seams as the homes, (n, 2)."""
        count = len(asked.homes)
        near = self.centers.query(asked.images, min(_NEAR, len(self.mesh.faces)))[1].reshape(count, -1)
        steps = (np.arange(_ON_THE_WAY) / _ON_THE_WAY)[:, None, None]
        way = asked.middles + steps * (asked.images - asked.middles)
        passed = self.finder.find_about(way.reshape(-1, 3)).triangles.reshape(_ON_THE_WAY, count).T
        candidates = np.concatenate([asked.homes[:, None], passed, near], axis=1)
        flat = candidates.ravel()
        each = asked.some(np.repeat(np.arange(count), candidates.shape[1]))
        closest = closest_in_triangles(self.mesh.corners[flat], each.images)
        uvs = np.einsum("nk,nkd->nd", closest.shares, self.uvs[flat])
        places = np.einsum("nk,nkd->nd", closest.shares, self.mesh.corners[flat])
        allowed = self._is_near(each, flat, uvs, places)
        distances = np.where(allowed, closest.distances, np.inf).reshape(candidates.shape)
        best = np.arange(count) * candidates.shape[1] + distances.argmin(axis=1)
        return uvs[best]


@dataclass(frozen=True)
class _Asked:
    """Corners whose UVs are looked up.

    Attributes
    ----------
    homes : (n,) int64
        Triangles of the giver that contain the centers of the corners' faces.
    middles, middle_uvs : (n, 3), (n, 2) float64
        These centers, on the surface and in the texture.
    images : (n, 3) float64
        Points of the corners themselves.
    """

    homes: NDArray[np.int64]
    middles: NDArray[np.float64]
    middle_uvs: NDArray[np.float64]
    images: NDArray[np.float64]

    def some(self, chosen: NDArray[np.int64]) -> _Asked:
        return _Asked(self.homes[chosen], self.middles[chosen], self.middle_uvs[chosen], self.images[chosen])


def _welded(
    uvs: NDArray[np.float64],
    is_own: NDArray[np.bool_],
    shared: SharedEdges,
    faces: NDArray[np.int64],
    owners: NDArray[np.int64],
    known: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """Merge nearly equal corners of adjacent faces, preferring corners at their own points."""
    ends = shared.values(uvs)
    lengths = np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=2).max(axis=1)
    apart = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=2).max(axis=1)
    same = owners[shared.faces[:, 0]] == owners[shared.faces[:, 1]]
    joined = (same | (apart <= _WELDED * lengths)) & known[shared.faces].all(axis=1)
    corners = 3 * shared.faces[joined][:, :, None] + shared.corners[joined]
    pairs = np.concatenate([corners[:, :, 0], corners[:, :, 1]])
    labels = component_labels(*pairs.T, faces.size)
    # Corners at their own points have a million times the weight of those moved to a seam.
    weights = np.where(is_own.ravel(), 1.0, 1e-6)
    sums = np.bincount(labels, weights)
    means = label_sums(labels, weights[:, None] * uvs.reshape(-1, 2), len(sums)) / sums[:, None]
    return means[labels].reshape(uvs.shape)


def _seams(uvs: NDArray[np.float64], shared: SharedEdges, known: NDArray[np.bool_]) -> NDArray[np.int64]:
    ends = shared.values(uvs)
    apart = np.abs(ends[:, 0] - ends[:, 1]).max(axis=(1, 2)) > 1e-6 * float(np.abs(uvs).max(initial=0.0))
    return np.unique(shared.vertices[apart & known[shared.faces].all(axis=1)], axis=0)


def _check_folds(uvs: NDArray[np.float64], homes: NDArray[np.float64], corners: NDArray[np.float64]) -> None:
    """Raise if too much of a surface is flipped in its UVs relative to the triangles that they come from."""
    areas = triangle_areas(corners)
    turns = np.sign(doubled_areas(uvs)) * np.sign(doubled_areas(homes))
    # A map between mirror images flips all triangles.
    side = 1.0 if (areas * turns).sum() >= 0 else -1.0
    folded = float(areas[side * turns <= 0].sum() / max(areas.sum(), np.finfo(float).tiny))
    if folded > _MOST_FOLDED:
        raise InputError(
            "{folded:.0%} of the surface would be folded in the UV map: its faces are too large for the islands. "
            "Subdivide the mesh that receives it, or improve the map.",
            folded=folded,
        )
