# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points attached to a surface: clothes, hair cards, eyes.

Every point is attached to the closest point of the surface. It moves with that point, and its offset is rotated and
scaled with the surface there. Similarity transforms of the whole surface are applied to the points exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..algebra.quotients import quotients
from ..algebra.rotations import nearest_rotations
from ..arrays.label_sums import label_sums
from ..meshes.closest_points import ClosestPointFinder, ClosestPoints
from ..meshes.mesh import TriangleMesh
from .surface_rotations import surface_rotations

# Share of the mean area that is added to the area around every vertex.
_LEAST = 0.1


@dataclass(frozen=True)
class Attachment:
    """Points attached to a surface.

    Attributes
    ----------
    surface : TriangleMesh
        The undeformed surface.
    places : ClosestPoints
        The closest points on it.
    offsets : (n, 3) float64
        Vectors from there to the points.
    """

    surface: TriangleMesh
    places: ClosestPoints
    offsets: NDArray[np.float64]

    @classmethod
    def of(cls, points: NDArray[np.float64], surface: TriangleMesh, control: Control = UNINTERRUPTED) -> Attachment:
        """Attach points, (n, 3), to a surface in the same space."""
        places = ClosestPointFinder(surface.corners).find(points, control)
        return cls(surface, places, points - places.interpolated(surface.corners))

    def followed(self, vertices: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the points, (n, 3), after the vertices of the surface have moved, (m, 3)."""
        faces, moved = self.surface.faces, TriangleMesh(vertices, self.surface.faces)
        turns = surface_rotations(self.surface.vertices, vertices, faces).reshape(-1, 9)
        mixed = self.places.interpolated(turns[faces]).reshape(-1, 3, 3)
        sizes = np.sqrt(_areas_around(moved) / _areas_around(self.surface))
        size = self.places.interpolated(sizes[faces][..., None])
        offsets = np.einsum("nij,nj->ni", _nearest(mixed), self.offsets)
        return self.places.interpolated(moved.corners) + size * offsets


def _areas_around(surface: TriangleMesh) -> NDArray[np.float64]:
    """Return the area around every vertex, (n,), as far as its neighbors', and never much less than the mean.

    The area of a sliver may grow by any factor.
    """
    areas, faces = surface.vertex_areas, surface.faces
    around = np.bincount(faces.ravel(), np.repeat(areas[faces].sum(axis=1), 3), len(areas))
    return around + max(_LEAST * around.mean(), np.finfo(float).tiny)


def rigidly_moved(
    points: NDArray[np.float64], followed: NDArray[np.float64], parts: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Replace the motion of each part of some points by the closest similarity transform.

    Parameters
    ----------
    points, followed : (n, 3) float64
        Positions before and after the motion.
    parts : (n,) int64
        The part of every point, counted from 0.

    Returns
    -------
    (n, 3) float64
        Least squares over rotations, uniform scales and translations (S. Umeyama, "Least-squares estimation of
        transformation parameters between two point patterns", 1991).
    """
    counts = np.maximum(np.bincount(parts), 1)[:, None]
    centers = [label_sums(parts, each, len(counts)) / counts for each in (points, followed)]
    before, after = points - centers[0][parts], followed - centers[1][parts]
    outer = np.einsum("ni,nj->nij", after, before)
    products = label_sums(parts, outer.reshape(-1, 9), len(counts)).reshape(-1, 3, 3)
    turns = _nearest(products)
    spread = np.bincount(parts, np.einsum("ni,ni->n", before, before), len(counts))
    scales = quotients(np.einsum("pij,pij->p", turns, products), spread, 1.0)
    return centers[1][parts] + scales[parts, None] * np.einsum("nij,nj->ni", turns[parts], before)


def _nearest(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation nearest to each of some matrices, (n, 3, 3)."""
    return np.moveaxis(nearest_rotations(np.ascontiguousarray(np.moveaxis(matrices, 0, -1))).rotations, -1, 0)
