# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer the shading of shapes to blends: flat and smooth faces, sharp edges, custom normals.

All of these are contained in the normals of a shape's corners. Every triangle of a blend lies on a triangle of each
shape. The shape's normals there, rotated like the triangle, are averaged with the weights of the blend.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays.chunks import chunks
from ...geometry.arrays.label_sums import label_sums
from ...geometry.meshes.barycentric import barycentric_coordinates, clamped_to_triangle
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import cross_coordinates, dot_coordinates, unit_vectors, vertex_normals

# Normals of a shape are not used if the cosine of their angle to the triangle of the blend is below this.
_LEAST_COSINE = 0.3
# A vertex whose corners have normals that differ by less than this is smooth.
_SMOOTH = 1e-3
# If the mean cosine between these normals and the blend's own exceeds this, the blend needs no custom normals.
_SAME = np.cos(np.radians(1.0))
# Arrays of so many triangles fit into the cache of a processor. They have one row for every coordinate: products of
# many small matrices take three times as long.
_AT_ONCE = 4096


@dataclass(frozen=True)
class Shading:
    """The shading of one shape.

    Attributes
    ----------
    corners : (m, 3, 3) float64
        Triangles, in the same space as the origins of blends.
    faces : (m, 3) int64
        Vertices of the triangles.
    normals : (m, 3, 3) float32
        Unit normals of the corners, as rendered.
    """

    corners: NDArray[np.float64]
    faces: NDArray[np.int64]
    normals: NDArray[np.float32]

    @cached_property
    def is_smooth(self) -> bool:
        """Whether all corners of a vertex have the same normal."""
        of_vertices = np.zeros((int(self.faces.max(initial=-1)) + 1, 3), np.float32)
        of_vertices[self.faces] = self.normals
        return bool(np.abs(of_vertices[self.faces] - self.normals).max(initial=0.0) < _SMOOTH)


@dataclass(frozen=True)
class FrameNormals:
    """Custom normals for a blend.

    Attributes
    ----------
    vectors : (n, 3) or (3m, 3) float32
        Unit normals of the vertices, or of the corners of the triangles.
    of_corners : bool
        Whether the normals belong to corners of triangles rather than to vertices.
    """

    vectors: NDArray[np.float32]
    of_corners: bool


def frame_normals(
    mesh: TriangleMesh,
    origins: NDArray[np.float32],
    triangles: NDArray[np.int32],
    shadings: Sequence[Shading],
    weights: Sequence[float],
) -> FrameNormals | None:
    """Return custom normals for a blend; None if its own normals are sufficient.

    Parameters
    ----------
    mesh : TriangleMesh
        The blend.
    origins : (k, n, 3) float32
        Origins of its vertices.
    triangles : (k, m) int32
        The triangle of every shape that each of its triangles lies on, -1 for none.
    shadings : sequence of Shading
        Shadings of the shapes.
    weights : (k,)
        Weights of the blend.
    """
    active, faces = np.flatnonzero(weights), mesh.faces
    vertices, starts = _columns(mesh.vertices), [_columns(own) for own in origins]
    own = _at_corners(_columns(vertex_normals(mesh.vertices, faces)), faces)
    total = np.zeros_like(own)
    for some in chunks(len(faces), _AT_ONCE):
        bases = _bases(_at_corners(vertices, faces[some]))
        for i in active:
            there = _at_corners(starts[i], faces[some])
            found = _carried(shadings[i], there, triangles[i, some], bases, own[..., some])
            total[..., some] += weights[i] * found
    if not all(shadings[i].is_smooth for i in active):
        return FrameNormals(_rows(total), of_corners=True)
    vectors = unit_vectors(label_sums(faces.T.ravel(), total.reshape(3, -1).T, len(mesh.vertices)))
    if dot_coordinates(_at_corners(_columns(vectors), faces), own).mean() > _SAME:
        return None
    return FrameNormals(vectors.astype(np.float32), of_corners=False)


def _columns(vectors: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the coordinates of vectors, (n, 3), one after the other, (3, n)."""
    return np.ascontiguousarray(vectors.T, dtype=np.float64)


def _at_corners(columns: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the vectors of vertices, (3, n), at the corners of triangles: coordinate, corner, triangle, (3, 3, m)."""
    return columns.take(faces.T, axis=1)


def _rows(vectors: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return normalized vectors of the corners of triangles, (3m, 3), of vectors by coordinates, (3, 3, m)."""
    return np.ascontiguousarray(_units(vectors).T, dtype=np.float32).reshape(-1, 3)


def _carried(
    shading: Shading,
    origins: NDArray[np.float64],
    triangles: NDArray[np.int32],
    bases: NDArray[np.float64],
    own: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the normals of one shape at the corners of a blend; the blend's own where there are none.

    Parameters
    ----------
    shading : Shading
        Shading of the shape.
    origins : (3, 3, m)
        Origins of the corners on the shape: coordinate, corner, triangle.
    triangles : (m,)
        The triangle of the shape that each triangle of the blend lies on.
    bases : (3, 3, m)
        Bases of the triangles of the blend: vector, coordinate, triangle.
    own : (3, 3, m)
        The blend's own normals.

    Returns
    -------
    (3, 3, m) float64
        Coordinate, corner, triangle.
    """
    known = (triangles >= 0) & (triangles < len(shading.corners))
    chosen = np.where(known, triangles, 0)
    corners, normals = (values.take(chosen, axis=0) for values in (shading.corners, shading.normals))
    shares = clamped_to_triangle(barycentric_coordinates(corners, origins.T)).T
    there = [dot_coordinates(shares, normals[:, :, axis].T[:, None]) for axis in range(3)]
    along = [dot_coordinates(there, vector[:, None]) for vector in _bases(origins)]
    turned = _units(np.stack([dot_coordinates(along, bases[:, axis, None]) for axis in range(3)]))
    agreement = dot_coordinates(turned, bases[2, :, None])
    return np.where(known & (agreement > _LEAST_COSINE), turned, own)


def _bases(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return an orthonormal basis for every triangle, (3, 3, m): first edge, perpendicular in the plane, normal.

    Corners are by coordinate, corner and triangle, (3, 3, m), and bases by vector, coordinate and triangle.
    """
    first, second, third = corners.transpose(1, 0, 2)
    along, normals = _units(second - first), _units(np.stack(cross_coordinates(second - first, third - first)))
    return np.stack([along, np.stack(cross_coordinates(normals, along)), normals])


def _units(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return normalized vectors, given by coordinates, (3, ...); zero vectors stay zero."""
    lengths = np.sqrt(dot_coordinates(vectors, vectors))
    return vectors / np.where(lengths > 0.0, lengths, 1.0)
