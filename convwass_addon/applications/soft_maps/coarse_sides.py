# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse meshes of about a thousand vertices, on which soft maps are solved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...errors import InputError
from ...geometry.arrays.integer_ranges import integer_ranges
from ...geometry.meshes.edges import proper_part
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import area_normals
from ...geometry.remeshing.coarsening import coarsened
from ...progress import Control
from ..usable_meshes import too_intricate
from .map_sides import MapSide
from .surface_maps import VertexInterpolation

# Chosen by eye; docs/performance, "Soft maps", lists what these and the other constants of soft maps achieve.
# A mesh with up to this multiple of the target vertices is used directly, since coarsening would gain little.
_NEAR_ENOUGH = 1.3
# Largest fraction of the vertices in a coarser mesh.
_LARGEST_SHARE = 0.45
# Upper limit if thin parts need more vertices than requested.
_MOST_VERTICES = 4000


@dataclass(frozen=True)
class CoarseSide:
    """A coarse mesh that represents a finer one.

    Attributes
    ----------
    side : MapSide
        The coarse mesh with the groups of the finer one. All its vertices are used.
    vertices : (c,) int64
        Index in the finer mesh of every coarse vertex.
    interpolation : VertexInterpolation
        The finer mesh's vertices as weighted means of coarse ones.
    masses : (c,) float64
        Fraction of the finer mesh's area that each coarse vertex represents, of sum 1.
    centers : (c, 3) float64
        Centroids of these areas.
    normals : (c, 3) float64
        Mean normals of these areas, shorter where the surface bends.
    """

    side: MapSide
    vertices: NDArray[np.int64]
    interpolation: VertexInterpolation
    masses: NDArray[np.float64]
    centers: NDArray[np.float64]
    normals: NDArray[np.float64]

    def places(self, fine: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the coarse vertices, (k,), for vertices of the finer mesh, (k,), that were kept."""
        order = np.argsort(self.vertices)
        return order[np.searchsorted(self.vertices[order], fine)]


def coarse_side(side: MapSide, count: int, kept: NDArray[np.int64], control: Control) -> CoarseSide:
    """Return a coarse mesh of about `count` vertices that includes the vertices `kept`, (k,), of the finer one.

    Cancelling `control` stops the work.

    Raises
    ------
    InputError
        The mesh has no area, or cannot be coarsened enough.
    """
    mesh = side.mesh
    areas = mesh.vertex_areas
    if not areas.sum() > 0:
        raise InputError("{name} has no area: the corners of every face lie on a line or in a point.", name=side.name)
    used, faces = proper_part(mesh)
    if len(used) <= _NEAR_ENOUGH * count:
        return _as_it_is(side, used, faces, areas)
    for wanted in (count, 2 * count, 4 * count):
        found = coarsened(mesh, areas, min(wanted, int(_LARGEST_SHARE * len(used))), kept, control)
        if found is not None and len(found.seeds) <= _MOST_VERTICES:
            return _of(side, found.mesh, found.seeds, _interpolation(found.prolongation), areas)
        if wanted > len(used):
            break
    if len(used) <= _MOST_VERTICES:
        return _as_it_is(side, used, faces, areas)
    raise too_intricate(side.name, _MOST_VERTICES)


def _as_it_is(
    side: MapSide, used: NDArray[np.int64], faces: NDArray[np.int64], areas: NDArray[np.float64]
) -> CoarseSide:
    """Use the part of a mesh that triangles use, without coarsening."""
    shares = np.zeros((len(areas), 3), np.float32)
    shares[used, 0] = 1.0
    columns = np.zeros((len(areas), 3), np.int32)
    columns[used, 0] = np.arange(len(used))
    mesh = TriangleMesh(side.mesh.vertices[used], faces)
    return _of(side, mesh, used, VertexInterpolation(columns, shares), areas)


def _of(
    side: MapSide,
    mesh: TriangleMesh,
    vertices: NDArray[np.int64],
    interpolation: VertexInterpolation,
    areas: NDArray[np.float64],
) -> CoarseSide:
    entries = csr_array(
        (
            interpolation.shares.ravel().astype(float),
            interpolation.columns.ravel(),
            np.arange(0, interpolation.shares.size + 1, 3),
        ),
        shape=(len(areas), len(vertices)),
    )
    gather = entries.T.tocsr()
    masses = gather @ areas
    # Vertices without area still need a position and weights.
    safe = np.where(masses > 0, masses, 1.0)[:, None]
    centers = np.where(masses[:, None] > 0, gather @ (areas[:, None] * side.mesh.vertices) / safe, mesh.vertices)
    normals = gather @ area_normals(side.mesh.vertices, side.mesh.faces) / safe
    groups = {
        name: np.where(masses > 0, gather @ (areas * weights) / safe[:, 0], weights[vertices])
        for name, weights in side.groups.items()
    }
    return CoarseSide(
        MapSide(mesh, side.name, groups), vertices, interpolation, masses / masses.sum(), centers, normals
    )


def _interpolation(prolongation: csr_array) -> VertexInterpolation:
    """Convert a matrix with up to three entries per row to two arrays."""
    counts = np.diff(prolongation.indptr)
    rows, places = integer_ranges(0, counts)
    columns, shares = np.zeros((len(counts), 3), np.int32), np.zeros((len(counts), 3), np.float32)
    columns[rows, places] = prolongation.indices
    shares[rows, places] = prolongation.data
    return VertexInterpolation(columns, shares)
