# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The shading of the shapes on the blends between them: flat and smooth faces, sharp edges, normals set by hand.

All of that is in the normals of a shape's corners. Every triangle of a blend lies on a triangle of each shape. The
shape's normals there, turned as the triangle is turned, are averaged with the weights of the blend.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...geometry.barycentric import barycentric_coordinates, clamped_to_triangle
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import triangle_normals, unit_vectors, vertex_normals

# Normals of a shape that turn away from a triangle of the blend by more than this cosine are not used.
_LEAST_COSINE = 0.3
# Corners of one vertex with normals that differ by less than this are smooth.
_SMOOTH = 1e-3
# Normals that differ from those of the blend itself by less than this cosine in the mean are left to it.
_SAME = np.cos(np.radians(1.0))


@dataclass(frozen=True)
class Shading:
    """How one shape is shaded.

    Attributes
    ----------
    corners : (m, 3, 3) float64
        Triangles, in the space that origins are in.
    faces : (m, 3) int64
        Their vertices.
    normals : (m, 3, 3) float32
        Unit normals of the corners, as renders show them.
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
    """Normals that a blend is to be shown with.

    Attributes
    ----------
    vectors : (n, 3) or (3m, 3) float32
        Unit normals of the vertices, or of the corners of the triangles.
    of_corners : bool
        Which of both.
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
    """Return the normals of a blend; None where those of its own surface do.

    Parameters
    ----------
    mesh : TriangleMesh
        The blend.
    origins : (k, n, 3) float32
        Where its vertices come from.
    triangles : (k, m) int32
        On which triangle of every shape each of its triangles lies, -1 for none.
    shadings : sequence of Shading
        Of the shapes.
    weights : (k,)
        Of the blend.
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
    sums = [np.bincount(mesh.faces.ravel(), part.ravel(), len(mesh.vertices)) for part in np.moveaxis(total, 2, 0)]
    vectors = unit_vectors(np.stack(sums, axis=1))
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
        Of the shape.
    origins : (m, 3, 3)
        Where the corners are on the shape.
    triangles : (m,)
        In which of its triangles.
    bases : (m, 3, 3)
        Of the triangles of the blend.
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
    """Return an orthonormal basis for every triangle, (m, 3, 3): its first edge, what is across it, and the normal."""
    normals = triangle_normals(corners)
    along = unit_vectors(corners[:, 1] - corners[:, 0])
    return np.stack([along, np.cross(normals, along), normals], axis=1)
