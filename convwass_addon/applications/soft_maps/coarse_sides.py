# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of about a thousand vertices that stand for the ones that a soft map is wanted for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...errors import InputError
from ...geometry.coarsening import coarsened
from ...geometry.edges import distinct_corners
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import area_normals
from ...progress import UNINTERRUPTED, Control
from .map_sides import MapSide
from .surface_maps import VertexInterpolation

# Chosen by eye; what they and the other constants of soft maps give is measured in docs/performance.md, "Soft maps".
# A mesh with up to so many times the wanted vertices is taken as it is: a coarser one would be worse for little.
_NEAR_ENOUGH = 1.3
# A coarser mesh has at most this share of the vertices.
_LARGEST_SHARE = 0.45
# Where thin parts need more vertices than are wanted, up to so many are taken.
_MOST_VERTICES = 4000


@dataclass(frozen=True)
class CoarseSide:
    """A mesh that stands for a finer one.

    Attributes
    ----------
    side : MapSide
        The coarser mesh with the groups of the finer one. All its vertices are used.
    vertices : (c,) int64
        The vertices of the finer mesh that they are.
    interpolation : VertexInterpolation
        The finer mesh's vertices as means of them.
    masses : (c,) float64
        The share of the finer mesh's area that each stands for, of sum 1.
    centers : (c, 3) float64
        Where on average that share lies.
    normals : (c, 3) float64
        Its mean normal, shorter where the surface bends.
    """

    side: MapSide
    vertices: NDArray[np.int64]
    interpolation: VertexInterpolation
    masses: NDArray[np.float64]
    centers: NDArray[np.float64]
    normals: NDArray[np.float64]

    def places(self, fine: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the coarse vertices, (k,), that some of the finer mesh's, (k,), are."""
        order = np.argsort(self.vertices)
        return order[np.searchsorted(self.vertices[order], fine)]


def coarse_side(side: MapSide, count: int, kept: NDArray[np.int64], control: Control = UNINTERRUPTED) -> CoarseSide:
    """Return a coarser mesh of about `count` vertices, some of the finer one's, `kept` (k,), among them.

    Cancelling `control` ends the work.

    Raises
    ------
    InputError
        The mesh has no area, or has no coarser one that could be solved on.
    """
    mesh = side.mesh
    areas = mesh.vertex_areas
    if not areas.sum() > 0:
        raise InputError("{name} has no area: the corners of every face lie on a line or in a point.", name=side.name)
    is_used = np.zeros(len(mesh.vertices), bool)
    is_used[mesh.faces[distinct_corners(mesh.faces)]] = True
    used = np.flatnonzero(is_used)
    if len(used) <= _NEAR_ENOUGH * count:
        return _as_it_is(side, used, areas)
    for wanted in (count, 2 * count, 4 * count):
        found = coarsened(mesh, areas, min(wanted, int(_LARGEST_SHARE * len(used))), kept, control)
        if found is not None and len(found.seeds) <= _MOST_VERTICES:
            return _of(side, found.mesh, found.seeds, _interpolation(found.prolongation), areas)
        if wanted > len(used):
            break
    if len(used) <= _MOST_VERTICES:
        return _as_it_is(side, used, areas)
    raise InputError(
        "{name} cannot be simplified to fewer than {most} vertices: it has too many pieces or holes. Remesh it.",
        name=side.name,
        most=_MOST_VERTICES,
    )


def _as_it_is(side: MapSide, used: NDArray[np.int64], areas: NDArray[np.float64]) -> CoarseSide:
    """Take the part of a mesh that triangles use."""
    place = np.zeros(len(areas), np.int32)
    place[used] = np.arange(len(used))
    shares = np.zeros((len(areas), 3), np.float32)
    shares[used, 0] = 1.0
    columns = np.zeros((len(areas), 3), np.int32)
    columns[:, 0] = place
    faces = side.mesh.faces[distinct_corners(side.mesh.faces)]
    mesh = TriangleMesh(side.mesh.vertices[used], place[faces].astype(np.int64))
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
    # Vertices without area in a mesh that has some still want a place and weights.
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
    """Write a matrix of up to three entries a row as two arrays."""
    counts = np.diff(prolongation.indptr)
    rows = np.repeat(np.arange(len(counts)), counts)
    places = np.arange(len(rows)) - np.repeat(prolongation.indptr[:-1], counts)
    columns, shares = np.zeros((len(counts), 3), np.int32), np.zeros((len(counts), 3), np.float32)
    columns[rows, places] = prolongation.indices
    shares[rows, places] = prolongation.data
    return VertexInterpolation(columns, shares)
