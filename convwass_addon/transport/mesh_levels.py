# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A hierarchy of ever coarser meshes of one surface, built on demand and shared by all kernels on it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..geometry.meshes.laplacian import Laplacian, laplacian
from ..geometry.meshes.mesh import TriangleMesh
from ..geometry.remeshing.coarsening import Coarsening, coarsened
from ..progress import UNINTERRUPTED, Control

FEWEST_VERTICES = 8000
"""Coarsening a smaller mesh takes as long as solving on it: 24 steps take 0.8 CPU seconds on 1000 vertices, 3 on 10 000
(docs/performance, "Meshes")."""

# Fraction of the vertices that the next coarser mesh keeps: half the resolution, as on grids. The gain of coarser
# meshes is measured in docs/performance, "Meshes".
_SHARE = 0.25


@dataclass(frozen=True)
class MeshLevel:
    """One mesh of the hierarchy.

    Attributes
    ----------
    mesh : TriangleMesh
        The mesh.
    laplacian : Laplacian
        Its stiffness, with the areas of the finest mesh. Lengths are therefore the same on all levels, and heat spreads
        over a crumpled surface as slowly as its true area demands.
    control : Control
        Stops long work on the mesh when cancelled.
    """

    mesh: TriangleMesh
    laplacian: Laplacian
    control: Control = UNINTERRUPTED

    @classmethod
    def of(cls, mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> MeshLevel:
        """Calculate the Laplacian of a mesh.

        Raises
        ------
        InputError
            The mesh has no area, or coordinates too large or too small to compute with.
        """
        return cls(mesh, laplacian(mesh, control), control)

    @cached_property
    def mean_edge_length(self) -> float:
        """In units of the vertices; interior edges count twice."""
        faces, points = self.mesh.faces, self.mesh.vertices
        lengths = []
        for tail, head in ((0, 1), (1, 2), (2, 0)):
            self.control.check()
            lengths.append(np.linalg.norm(points[faces[:, tail]] - points[faces[:, head]], axis=1))
        return float(np.concatenate(lengths).mean())

    @cached_property
    def coarser(self) -> CoarserLevel | None:
        """The next coarser mesh; None where it would save nothing or would not be a surface."""
        areas = self.laplacian.areas
        used = int(np.count_nonzero(areas))
        if used < FEWEST_VERTICES:
            return None
        coarsening = coarsened(self.mesh, areas, round(_SHARE * used), control=self.control)
        if coarsening is None:
            return None
        try:
            stiffness = laplacian(coarsening.mesh, self.control)
        except InputError:
            # Only degenerate triangles are left.
            return None
        summed = replace(stiffness, areas=coarsening.sums(areas[None])[0])
        return CoarserLevel(coarsening, MeshLevel(coarsening.mesh, summed, self.control))

    @property
    def levels_below(self) -> int:
        """Approximate number of coarser meshes."""
        used = np.count_nonzero(self.laplacian.areas)
        return max(0, math.ceil(math.log(max(used, 1) / FEWEST_VERTICES, 1.0 / _SHARE)))


@dataclass(frozen=True)
class CoarserLevel:
    """A coarser mesh and how it maps to the finer one.

    Attributes
    ----------
    coarsening : Coarsening
        Assigns the vertices of the finer mesh to its own.
    level : MeshLevel
        The coarser mesh.
    """

    coarsening: Coarsening
    level: MeshLevel

    def restrict(self, densities: NDArray[np.float64], areas: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the means of densities, (k, n), over every cluster, (k, c), which preserve the mass."""
        return self.coarsening.sums(densities * areas) / self.level.laplacian.areas

    def prolong(self, columns: NDArray[np.float64], index: NDArray[np.int64] | None) -> NDArray[np.float64]:
        """Interpolate columns, (k, c), to some or all vertices of the finer mesh, (k, len)."""
        rows = self.coarsening.prolongation if index is None else self.coarsening.prolongation[index]
        return np.ascontiguousarray((rows @ columns.T).T)
