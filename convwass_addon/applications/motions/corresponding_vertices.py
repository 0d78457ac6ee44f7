# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes whose vertices correspond by their numbers, such as poses of one mesh: they need no map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from ...geometry.edges import vertex_components
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import triangle_normals
from .carriers import Carrier
from .laid_meshes import Laid
from .map_detour import map_detour
from .pair_maps import PairMap
from .pair_merits import MappedPair
from .pair_registration import LaidPair

# Least share of triangles that meshes with the same polygons have in common: Blender divides a quad along another
# diagonal if the first one would fold it.
_COMMON = 0.7
# Components with equal numbers of vertices and triangles, such as boxes, may have been joined in any order. Their order
# counts if other pairs would move the surface by at most this much less in the mean square, in areas of the shape.
_ARBITRARY = 0.01
# Shapes are scaled by at most this factor to keep their volume. They enclose one if the sum of their oriented areas is
# at most the second number of their area: zero for closed surfaces, and one for a flat sheet.
_MOST_SCALED, _OPEN = 1.1, 0.1
# More components of one kind are compared with the nearest ones instead of the best pairs, which takes seconds for
# thousands, such as strands of hair.
_MOST_PAIRED = 500


@dataclass(frozen=True)
class CommonVertices:
    """Vertices that several shapes have in common, and further points that motions move with them.

    Each shape alone would come to slightly different places in a blend, above all where skinning has collapsed joints.
    Means of stretches have too much volume where parts shear, as in a twist, so their mean is scaled. Its solid would
    be made thinner otherwise, and lose ears and fins.

    Attributes
    ----------
    count : int
        Number of common vertices.
    faces : (m, 3) int64
        Triangles between them, those of the first shape.
    lengths : (k,) float64
        Cube roots of the volumes of the shapes; zeros if one of them does not enclose one.
    corners : tuple of (k, 3) int64
        By shape, the corners of the triangle that each of its further points lies on.
    shares : tuple of (k, 3) float64
        Their barycentric coordinates.
    """

    count: int
    faces: NDArray[np.int64]
    lengths: NDArray[np.float64]
    corners: tuple[NDArray[np.int64], ...]
    shares: tuple[NDArray[np.float64], ...]

    @classmethod
    def of(cls, carriers: Sequence[Carrier], shapes: Sequence[TriangleMesh]) -> CommonVertices:
        """Return the vertices of shapes, which correspond by their numbers, and the further ones of carriers."""
        count, faces, corners, shares = len(shapes[0].vertices), shapes[0].faces, [], []
        meshes = [TriangleMesh(shape.vertices, faces) for shape in shapes]
        volumes = [mesh.volume if _is_nearly_closed(mesh) else 0.0 for mesh in meshes]
        lengths = np.cbrt(volumes) if min(volumes) > 0.0 else np.zeros(len(shapes))
        for carrier, shape in zip(carriers, shapes, strict=True):
            found = carrier.embedding(shape)
            corners.append(shape.faces[found.triangles[count:]])
            shares.append(found.shares[count:])
        return cls(count, faces, lengths, tuple(corners), tuple(shares))

    def met(
        self, moved: Mapping[int, NDArray[np.float64]], weights: NDArray[np.float64], way: float
    ) -> dict[int, NDArray[np.float64]]:
        """Move shapes to their weighted mean, scaled so that it has the mean size of the shapes.

        Parameters
        ----------
        moved : mapping of int to (n, 3)
            The points of some shapes in a blend: first the common vertices, then the further points.
        weights : (k,)
            Weights of these shapes, of sum one.
        way : float
            Fraction of the way to the mean, 0 to 1.
        """
        mean = sum(weight * points[: self.count] for weight, points in zip(weights, moved.values(), strict=True))
        mean = self._sized(mean, weights @ self.lengths[list(moved)])
        found = {}
        for shape, points in moved.items():
            gaps = way * (mean - points[: self.count])
            beside = np.einsum("nk,nkj->nj", self.shares[shape], gaps[self.corners[shape]])
            found[shape] = points + np.concatenate([gaps, beside])
        return found

    def _sized(self, points: NDArray[np.float64], length: float) -> NDArray[np.float64]:
        """Return the common vertices, scaled about their center to a volume, given by its cube root."""
        mesh = TriangleMesh(points, self.faces)
        if not min(length, mesh.volume) > 0.0:
            return points
        scale = np.clip(length / np.cbrt(mesh.volume), 1.0 / _MOST_SCALED, _MOST_SCALED)
        return mesh.area_center + scale * (points - mesh.area_center)


def _is_nearly_closed(mesh: TriangleMesh) -> bool:
    """Return whether a surface encloses a volume, though it may have small openings: normals then add up to little."""
    total = mesh.face_areas @ triangle_normals(mesh.corners)
    return bool(np.linalg.norm(total) <= _OPEN * mesh.area and mesh.volume > 0.0)


def vertices_correspond(first: TriangleMesh, second: TriangleMesh) -> bool:
    """Return whether two shapes are versions of one mesh, so that vertices with the same number correspond.

    They have the same polygons, facing the same way; and if they consist of several components of the same kind, those
    with the same numbers are near each other.
    """
    if len(first.vertices) != len(second.vertices) or len(first.faces) != len(second.faces):
        return False
    if not np.array_equal(first.faces, second.faces) and _common_triangles(first, second) < _COMMON:
        return False
    return _excess_movement(first, second) <= _ARBITRARY


def corresponding_pair(shapes: tuple[TriangleMesh, TriangleMesh], carriers: tuple[Carrier, Carrier]) -> MappedPair:
    """Register two shapes whose vertices correspond: every point moves to the same place of the other shape.

    Parameters
    ----------
    shapes : (TriangleMesh, TriangleMesh)
        The shapes.
    carriers : (Carrier, Carrier)
        Their carriers.
    """
    laid = tuple(_laid(own, shape, other) for own, shape, other in zip(carriers, shapes, shapes[::-1], strict=True))
    meshes = carriers[0].mesh, carriers[1].mesh
    detour = map_detour(meshes, (laid[0].points, laid[1].points))
    return MappedPair(
        LaidPair(*laid, confidence=1.0), PairMap.unneeded(), symmetry=None, detour=detour, by_vertices=True
    )


def _laid(carrier: Carrier, shape: TriangleMesh, other: TriangleMesh) -> Laid:
    places = carrier.embedding(shape).interpolated(other.vertices[shape.faces])[carrier.seeds]
    return Laid(places, np.ones(len(places)))


def _common_triangles(first: TriangleMesh, second: TriangleMesh) -> float:
    """Return the share of the triangles of a mesh that another one of as many triangles has, too."""
    both = np.concatenate([first.faces, second.faces])
    # Every triangle begins with its smallest vertex.
    begun = np.take_along_axis(both, (both.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    order = np.lexsort(begun.T)
    differ = (begun[order[1:]] != begun[order[:-1]]).any(axis=1)
    kinds = np.empty(len(order), np.int64)
    kinds[order] = np.cumsum(np.concatenate([[0], differ]))
    count = len(first.faces)
    counts = [np.bincount(own, minlength=len(order)) for own in (kinds[:count], kinds[count:])]
    return float(np.minimum(*counts).sum() / count)


def _excess_movement(first: TriangleMesh, second: TriangleMesh) -> float:
    """Return how much farther components move than if those of the same kind were paired best, in the mean square.

    In areas of the shapes, and relative to their centers.
    """
    labels = vertex_components(first)
    count, used = int(labels.max(initial=-1)) + 1, labels >= 0
    if count < 2:
        return 0.0
    kinds = np.stack(
        [np.bincount(own[own >= 0], minlength=count) for own in (labels, labels[first.faces[:, 0]])], axis=1
    )
    centers = [_component_centers(mesh, labels[used], used, count) for mesh in (first, second)]
    areas = 0.5 * sum(np.bincount(labels[used], mesh.vertex_areas[used], count) / mesh.area for mesh in (first, second))
    _, kind_of = np.unique(kinds, axis=0, return_inverse=True)
    ordered = np.argsort(kind_of, kind="stable")
    groups = np.split(ordered, np.flatnonzero(np.diff(kind_of[ordered])) + 1)
    return sum(_excess_of_kind(centers[0][own], centers[1][own], areas[own]) for own in groups if len(own) > 1)


def _excess_of_kind(here: NDArray[np.float64], there: NDArray[np.float64], areas: NDArray[np.float64]) -> float:
    """Return how much farther components of one kind move, (k, 3) centers, than if they were paired best."""
    moved = areas @ np.square(here - there).sum(axis=1)
    if len(here) > _MOST_PAIRED:
        return float(moved - areas @ np.square(cKDTree(there).query(here)[0]))
    apart = cdist(here, there, "sqeuclidean") * areas[:, None]
    return float(moved - apart[linear_sum_assignment(apart)].sum())


def _component_centers(
    mesh: TriangleMesh, labels: NDArray[np.int64], used: NDArray[np.bool_], count: int
) -> NDArray[np.float64]:
    """Return the centers of components relative to that of the mesh, (count, 3), in its sizes."""
    sums = [np.bincount(labels, own, count) for own in mesh.vertices[used].T]
    centers = np.stack(sums, axis=1) / np.bincount(labels, minlength=count)[:, None]
    return (centers - mesh.area_center) / np.sqrt(mesh.area)
