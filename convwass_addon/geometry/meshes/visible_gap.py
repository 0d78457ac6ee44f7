# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a mesh looks from a closed surface: parts of the mesh inside of it are hidden and do not count."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..arrays.weighted_quantile import weighted_quantile
from .facing_points import FacingPointFinder
from .mesh import TriangleMesh

# The fraction of both surfaces that is within the distance `most`.
_NEARLY_ALL = 0.98


@dataclass(frozen=True)
class VisibleGap:
    """Distances between a mesh and a closed surface, as far as they can be seen.

    Attributes
    ----------
    mean : float
        Larger of the mean distances from the surface to the mesh, and from the mesh to the surface.
    most : float
        Larger of the distances within which 98 % of each area lie.
    outside : (n,) float64
        Distances of the vertices of the mesh from the surface; 0 for those inside of it.
    """

    mean: float
    most: float
    outside: NDArray[np.float64]

    @classmethod
    def between(cls, mesh: TriangleMesh, surface: TriangleMesh, control: Control = UNINTERRUPTED) -> VisibleGap:
        """Measure the gap between a mesh and a closed surface that faces outward."""
        found = FacingPointFinder(surface).find_closest(mesh.vertices, control)
        normals = found.interpolated(surface.vertex_normals[surface.faces])
        apart = mesh.vertices - found.interpolated(surface.corners)
        outside = np.where(np.einsum("nd,nd->n", apart, normals) > 0.0, found.distances, 0.0)
        uncovered = FacingPointFinder(mesh).find_closest(surface.vertices, control).distances
        measured = [(outside, mesh.vertex_areas), (uncovered, surface.vertex_areas)]
        mean = max(float(areas @ distances / areas.sum()) for distances, areas in measured)
        return cls(mean, max(weighted_quantile(*each, _NEARLY_ALL) for each in measured), outside)
