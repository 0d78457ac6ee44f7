# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sample vertices of a surface, and find pairs of samples whose connecting line stays in the solid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.sparse.csgraph import dijkstra

from ..arrays.far_points import far_points
from .edges import edge_lengths, vertex_components
from .mesh import TriangleMesh
from .point_tree import point_tree

# Positions along the line between two samples that must lie in the solid, those first that are most often outside, and
# how far outside they may be, relative to the square root of the surface's area.
_BETWEEN, _OUTSIDE = (0.5, 0.25, 0.75), 0.01
# Rounds of blurring the samples' regions.
_BLURS = 6
# Distances with a smaller relative difference count as equal, so that rounding does not affect the choice.
_EQUAL = 1e-9
# Quantization of lengths along the surface, relative to its size.
_STEP = 1e-6


@dataclass(frozen=True)
class SurfaceSamples:
    """Vertices of a mesh that represent the regions around them.

    Attributes
    ----------
    seeds : (s,) int64
        The vertices.
    areas : (s,) float64
        Areas of their regions.
    pairs : (p, 2) int64
        Indices into `seeds` of samples within reach whose line stays in the solid or that belong to different
        components.
    blend : (n, s) csr_array
        Weights of the samples at each vertex; rows sum to one.
    """

    seeds: NDArray[np.int64]
    areas: NDArray[np.float64]
    pairs: NDArray[np.int64]
    blend: csr_array

    @classmethod
    def of(cls, mesh: TriangleMesh, count: int, reach: float) -> SurfaceSamples:
        """Distribute samples evenly over a surface.

        Parameters
        ----------
        mesh : TriangleMesh
            Oriented outward, of any topology, with at least one triangle.
        count : int
            Largest number of samples.
        reach : float
            Longest pair, relative to the size of the surface.
        """
        labels = vertex_components(mesh)
        used = np.flatnonzero(labels >= 0)
        seeds = used[far_points(mesh.vertices[used], min(count, len(used)), _EQUAL)]
        size = mesh.root_area
        pairs = point_tree(mesh.vertices[seeds]).query_pairs(reach * size, output_type="ndarray").astype(np.int64)
        pairs = np.unique(np.sort(pairs, axis=1), axis=0)
        apart = labels[seeds[pairs[:, 0]]] != labels[seeds[pairs[:, 1]]]
        kept = apart.copy()
        kept[~apart] = _inside_solid(mesh, seeds[pairs[~apart]], _OUTSIDE * size)
        blend = _blended(mesh, seeds)
        return cls(seeds, blend.T @ mesh.vertex_areas, pairs[kept], blend)


def _inside_solid(mesh: TriangleMesh, ends: NDArray[np.int64], outside: float) -> NDArray[np.bool_]:
    """Return which lines between two vertices leave the solid by less than `outside`, (p,)."""
    normals, tree = mesh.vertex_normals, point_tree(mesh.vertices)
    inside = np.ones(len(ends), bool)
    for share in _BETWEEN:
        left = np.flatnonzero(inside)
        first, last = (mesh.vertices[ends[left, k]] for k in (0, 1))
        points = (1.0 - share) * first + share * last
        nearest = tree.query(points)[1]
        inside[left] = np.einsum("nd,nd->n", points - mesh.vertices[nearest], normals[nearest]) < outside
    return inside


def _blended(mesh: TriangleMesh, seeds: NDArray[np.int64]) -> csr_array:
    """Return the blurred Voronoi regions (along edges) of the seeds, (n, s)."""
    points, count = mesh.vertices, len(mesh.vertices)
    ends = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    lengths = edge_lengths(points, ends)
    # Duplicate entries of edges shared by two triangles are summed; the graph of ones tells how many there are.
    shape = (count, count)
    both = np.concatenate([ends, ends[:, ::-1]])
    uses = coo_array((np.ones(len(both)), both.T), shape=shape).tocsr()
    # Integers are summed without rounding, so ties do not depend on where the mesh is.
    steps = np.maximum(np.round(lengths / (_STEP * mesh.root_area)), 1.0)
    graph = coo_array((np.tile(steps, 2), both.T), shape=shape).tocsr()
    graph.data = np.round(graph.data / uses.data)
    away, _, sources = dijkstra(graph, directed=False, indices=seeds, min_only=True, return_predecessors=True)
    place = np.full(count, -1)
    place[seeds] = np.arange(len(seeds))
    # Components without a seed use the nearest one.
    own = np.where(np.isfinite(away), place[np.maximum(sources, 0)], point_tree(points[seeds]).query(points)[1])
    blend = csr_array((np.ones(count), (np.arange(count), own)), shape=(count, len(seeds)))
    around = (uses > 0).astype(np.float64) + diags_array(np.ones(count))
    average = diags_array(1.0 / np.asarray(around.sum(axis=1)).ravel()) @ around
    for _ in range(_BLURS):
        blend = average @ blend
    return csr_array(blend)
