# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find flipped and collapsed triangles of a mesh that has been deformed to lie on another surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..algebra.quotients import quotients
from ..meshes.facing_points import FacingPointFinder
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import triangle_areas, triangle_normals

FOLDED = 0.1
"""Triangles count as folded below this score, see :meth:`FoldFinder.scores`."""

# Closest points of so many triangles are found exactly, in a second.
_MOST_EXACT = 20_000
# Triangles count as collapsed below this fraction of their expected area.
_COLLAPSED = 0.01


@dataclass(frozen=True)
class FoldFinder:
    """Finds flipped and collapsed triangles of a mesh on a surface.

    Attributes
    ----------
    rest : TriangleMesh
        The undeformed mesh.
    target : TriangleMesh
        The surface that the mesh is deformed to.
    finder : FacingPointFinder
        Nearest-point queries on the target.
    """

    rest: TriangleMesh
    target: TriangleMesh
    finder: FacingPointFinder

    @classmethod
    def of(cls, rest: TriangleMesh, target: TriangleMesh) -> FoldFinder:
        """Prepare queries."""
        return cls(rest, target, FacingPointFinder(target))

    def agreements(self, vertices: NDArray[np.float64], control: Control = UNINTERRUPTED) -> NDArray[np.float64]:
        """Return the cosine between the normals of all triangles and of the surface below their centers, (m,)."""
        return self._agreements(vertices[self.rest.faces], control)

    def collapsed(self, vertices: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which triangles, (m,), have lost nearly all of their area, relative to the areas of both shapes."""
        return self._area_ratios(vertices[self.rest.faces], self.rest.faces) < _COLLAPSED

    def folded(self, vertices: NDArray[np.float64], control: Control = UNINTERRUPTED) -> NDArray[np.bool_]:
        """Return which triangles, (m,), are flipped, perpendicular to the surface, or collapsed."""
        return (self.agreements(vertices, control) < FOLDED) | self.collapsed(vertices)

    def scores(self, corners: NDArray[np.float64], some: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return how far triangles are from being folded, (k,): the cosine to the surface, less where they collapse.

        Parameters
        ----------
        corners : (k, 3, 3) float64
            Their corners.
        some : (k,) int64
            Which triangles they are.
        """
        ratios = self._area_ratios(corners, self.rest.faces[some])
        agreements = self._agreements(corners, UNINTERRUPTED)
        return np.minimum(agreements, FOLDED / _COLLAPSED * ratios)

    def _agreements(self, corners: NDArray[np.float64], control: Control) -> NDArray[np.float64]:
        """Return the cosines, (k,), of some triangles given by their corners, (k, 3, 3).

        On fine meshes, a fast search hardly ever returns another triangle of the surface than the closest one.
        """
        centers = corners.mean(axis=1)
        is_fine = len(self.rest.faces) > _MOST_EXACT
        below = self.finder.find_closest(centers, control) if is_fine else self.finder.closest.find(centers, control)
        facing = triangle_normals(self.target.corners[below.triangles])
        return np.einsum("md,md->m", triangle_normals(corners), facing)

    def _area_ratios(self, corners: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return areas relative to those at rest and to the areas of both shapes; 1 without area at rest."""
        expected = triangle_areas(self.rest.vertices[faces]) * (self.target.area / self.rest.area)
        return quotients(triangle_areas(corners), expected, 1.0)
