# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh rescaled to unit area, with the quantities needed to compare it with others."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..meshes.facing_points import OrientedSamples
from ..meshes.laplacian import Laplacian, laplacian
from ..meshes.mesh import TriangleMesh
from ..meshes.surface_graph import surface_graph
from .elastic_surface import ElasticSurface

TURN = 0.2
"""Distance, on surfaces of unit area, that counts as much as a normal turned by 60 degrees."""


@dataclass(frozen=True)
class UnitShape:
    """A mesh of unit area centered at the origin.

    Attributes
    ----------
    mesh : TriangleMesh
    laplacian : Laplacian
        Its Laplacian, with areas of sum one.
    """

    mesh: TriangleMesh
    laplacian: Laplacian

    @classmethod
    def of(cls, mesh: TriangleMesh) -> UnitShape:
        """Rescale and center a mesh.

        Raises
        ------
        InputError
            The mesh has no area.
        """
        found = laplacian(mesh)
        total = found.areas.sum()
        areas = found.areas / total
        # The stiffness does not depend on the scale.
        unit = Laplacian(found.matrix, areas, found.method, found.clamped)
        center = areas @ mesh.vertices
        return cls(TriangleMesh((mesh.vertices - center) / np.sqrt(total), mesh.faces), unit)

    @cached_property
    def elastic(self) -> ElasticSurface:
        """Its edges and their elastic energy, with what all registrations of it share."""
        return ElasticSurface(self.vertices, self.laplacian)

    @cached_property
    def samples(self) -> OrientedSamples:
        """Samples for finding its nearest points with similar normals."""
        return OrientedSamples(self.mesh, TURN)

    @property
    def areas(self) -> NDArray[np.float64]:
        """Area of every vertex, (n,)."""
        return self.laplacian.areas

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Positions, (n, 3)."""
        return self.mesh.vertices

    @cached_property
    def graph(self) -> csr_array:
        """Graph of lines along the surface, (n, n); see :func:`surface_graph`."""
        return surface_graph(self.mesh)

    def mirrored(self) -> UnitShape:
        """Return the mirror image, with its faces flipped so that they point outward again."""
        return UnitShape(TriangleMesh(self.vertices * (-1.0, 1.0, 1.0), self.mesh.flipped().faces), self.laplacian)
