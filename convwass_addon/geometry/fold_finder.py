# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find flipped and collapsed triangles of a mesh that has been deformed to lie on another surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..progress import UNINTERRUPTED, Control
from .closest_points import ClosestPointFinder
from .facing_points import FacingPointFinder
from .mesh import TriangleMesh
from .normals import triangle_normals

FOLDED = 0.1
"""Triangles count as folded below this score, see :meth:`FoldFinder.scores`."""

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
        Nearest-point queries on the target that respect the orientation.
    closest : ClosestPointFinder
        Exact ones that do not.
    """

    rest: TriangleMesh
    target: TriangleMesh
    finder: FacingPointFinder
    closest: ClosestPointFinder

    @classmethod
    def of(cls, rest: TriangleMesh, target: TriangleMesh) -> FoldFinder:
        """Prepare queries."""
        return cls(rest, target, FacingPointFinder(target), ClosestPointFinder(target.corners))

    def agreements(
        self, vertices: NDArray[np.float64], control: Control = UNINTERRUPTED, some: NDArray[np.int64] | None = None
    ) -> NDArray[np.float64]:
        """Return the cosine, (m,), between the normals of triangles, all or some, and the surface's below them."""
        return self._agreements(vertices[self._faces(some)], control)

    def collapsed(self, vertices: NDArray[np.float64], some: NDArray[np.int64] | None = None) -> NDArray[np.bool_]:
        """Tell which triangles, (m,), have lost nearly all of their area, relative to the areas of both shapes."""
        faces = self._faces(some)
        return self._area_ratios(vertices[faces], faces) < _COLLAPSED

    def scores(
        self, corners: NDArray[np.float64], some: NDArray[np.int64], control: Control = UNINTERRUPTED
    ) -> NDArray[np.float64]:
        """Return how far triangles are from being folded, (k,): the cosine to the surface, less where they collapse.

        Parameters
        ----------
        corners : (k, 3, 3) float64
            Their corners.
        some : (k,) int64
            Which triangles they are.
        control : Control
            Stops the work.
        """
        ratios = self._area_ratios(corners, self.rest.faces[some])
        return np.minimum(self._agreements(corners, control), FOLDED / _COLLAPSED * ratios)

    def folded(
        self, vertices: NDArray[np.float64], control: Control = UNINTERRUPTED, some: NDArray[np.int64] | None = None
    ) -> NDArray[np.bool_]:
        """Tell which triangles, (m,), are flipped, perpendicular to the surface, or collapsed."""
        chosen = np.arange(len(self.rest.faces)) if some is None else some
        return self.scores(vertices[self.rest.faces[chosen]], chosen, control) < FOLDED

    def _faces(self, some: NDArray[np.int64] | None) -> NDArray[np.int64]:
        return self.rest.faces if some is None else self.rest.faces[some]

    def _agreements(self, corners: NDArray[np.float64], control: Control) -> NDArray[np.float64]:
        below = self.closest.find(corners.mean(axis=1), control).triangles
        return np.einsum("md,md->m", triangle_normals(corners), triangle_normals(self.target.corners[below]))

    def _area_ratios(self, corners: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return areas relative to those at rest and to the areas of both shapes; 1 without area at rest."""
        expected = _areas(self.rest.vertices[faces]) * (self.target.area / self.rest.area)
        return np.where(expected > 0.0, _areas(corners) / np.where(expected > 0.0, expected, 1.0), 1.0)


def _areas(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    return 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
