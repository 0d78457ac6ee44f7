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

from ...geometry.barycentric import barycentric_coordinates, clamped_to_triangle
from ...geometry.label_sums import label_sums
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import triangle_normals, unit_vectors, vertex_normals

# Normals of a shape are not used if the cosine of their angle to the triangle of the blend is below this.
_LEAST_COSINE = 0.3
# A vertex whose corners have normals that differ by less than this is smooth.
_SMOOTH = 1e-3
# If the mean cosine between these normals and the blend's own exceeds this, the blend needs no custom normals.
_SAME = np.cos(np.radians(1.0))


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
    active = np.flatnonzero(weights)
    own = vertex_normals(mesh.vertices, mesh.faces)[mesh.faces]
    bases = _bases(mesh.corners)
    total = np.zeros_like(own)
    for i in active:
        total += weights[i] * _carried(shadings[i], origins[i][mesh.faces].astype(np.float64), triangles[i], bases, own)
    if not all(shadings[i].is_smooth for i in active):
        vectors = unit_vectors(total.reshape(-1, 3))
        return FrameNormals(vectors.astype(np.float32), of_corners=True)
    vectors = unit_vectors(label_sums(mesh.faces.ravel(), total.reshape(-1, 3), len(mesh.vertices)))
    if np.einsum("mcd,mcd->mc", vectors[mesh.faces], own).mean() > _SAME:
        return None
    return FrameNormals(vectors.astype(np.float32), of_corners=False)


def _carried(
    shading: Shading,
    origins: NDArray[np.float64],
    triangles: NDArray[np.int32],
    bases: NDArray[np.float64],
    own: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the normals of one shape at the corners of a blend, (m, 3, 3); the blend's own where there are none.

    Parameters
    ----------
    shading : Shading
        Shading of the shape.
    origins : (m, 3, 3)
        Origins of the corners on the shape.
    triangles : (m,)
        The triangle of the shape that each triangle of the blend lies on.
    bases : (m, 3, 3)
        Bases of the triangles of the blend.
    own : (m, 3, 3)
        The blend's own normals.
    """
    known = (triangles >= 0) & (triangles < len(shading.corners))
    chosen = np.where(known, triangles, 0)
    shares = clamped_to_triangle(barycentric_coordinates(shading.corners[chosen], origins))
    normals = shares @ shading.normals[chosen]
    turned = normals @ np.swapaxes(_bases(origins), 1, 2) @ bases
    turned = unit_vectors(turned.reshape(-1, 3)).reshape(-1, 3, 3)
    agreement = np.einsum("mkd,md->mk", turned, bases[:, 2])
    return np.where((known[:, None] & (agreement > _LEAST_COSINE))[..., None], turned, own)


def _bases(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return an orthonormal basis for every triangle, (m, 3, 3): first edge, perpendicular in the plane, normal."""
    normals = triangle_normals(corners)
    along = unit_vectors(corners[:, 1] - corners[:, 0])
    return np.stack([along, np.cross(normals, along), normals], axis=1)
