# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices spread over a surface, and which of them see each other through the solid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from ..progress import UNINTERRUPTED, Control
from .edges import vertex_components
from .mesh import TriangleMesh
from .normals import vertex_normals

# Points between two samples, as shares of the line, that must lie in the solid, and how far outside they may be, in
# sizes of the surface (the square root of its area).
_BETWEEN, _OUTSIDE = (0.25, 0.5, 0.75), 0.01
# Rounds in which the regions of the samples are blurred.
_BLURS = 6
# Distances that differ by less than this share are equal: the choice must not depend on rounding.
_EQUAL = 1e-9
# Lengths along the surface are counted in steps of this many sizes.
_STEP = 1e-6


@dataclass(frozen=True)
class SurfaceSamples:
    """Vertices of a mesh that stand for the regions around them.

    Attributes
    ----------
    seeds : (s,) int64
        The vertices.
    areas : (s,) float64
        Of their regions.
    pairs : (p, 2) int64
        Places in `seeds` of samples within reach between which the line stays in the solid, or which are on different
        components.
    blend : (n, s) csr_array
        How much each vertex belongs to each sample; rows sum to one.
    """

    seeds: NDArray[np.int64]
    areas: NDArray[np.float64]
    pairs: NDArray[np.int64]
    blend: csr_array

    @classmethod
    def of(cls, mesh: TriangleMesh, count: int, reach: float, control: Control = UNINTERRUPTED) -> SurfaceSamples:
        """Spread samples evenly over a surface.

        Parameters
        ----------
        mesh : TriangleMesh
            Facing outward, of any topology, with at least one triangle.
        count : int
            At most so many samples.
        reach : float
            Pairs are no longer than this, in sizes of the surface.
        control : Control
            Stops the work.
        """
        labels = vertex_components(mesh)
        used = np.flatnonzero(labels >= 0)
        seeds = used[_far_apart(mesh.vertices[used], min(count, len(used)))]
        control.check()
        size = float(np.sqrt(mesh.area))
        pairs = cKDTree(mesh.vertices[seeds]).query_pairs(reach * size, output_type="ndarray").astype(np.int64)
        pairs = np.unique(np.sort(pairs, axis=1), axis=0)
        apart = labels[seeds[pairs[:, 0]]] != labels[seeds[pairs[:, 1]]]
        kept = apart | _through_the_solid(mesh, seeds[pairs], _OUTSIDE * size)
        control.check()
        blend = _blended(mesh, seeds)
        return cls(seeds, blend.T @ mesh.vertex_areas, pairs[kept], blend)


def _far_apart(points: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Return places of points each of which is as far as possible from those before, the first of equal ones."""
    apart = np.square(points - points.mean(axis=0)).sum(axis=1)
    chosen: list[int] = []
    for _ in range(count):
        chosen.append(int(np.argmax(apart >= (1.0 - _EQUAL) * apart.max())))
        own = np.square(points - points[chosen[-1]]).sum(axis=1)
        apart = own if len(chosen) == 1 else np.minimum(apart, own)
    return np.array(chosen, np.int64)


def _through_the_solid(mesh: TriangleMesh, ends: NDArray[np.int64], outside: float) -> NDArray[np.bool_]:
    """Tell which lines between two vertices stay inside, or at most so far outside, (p,)."""
    normals, tree = vertex_normals(mesh.vertices, mesh.faces), cKDTree(mesh.vertices)
    inside = np.ones(len(ends), bool)
    first, last = (mesh.vertices[ends[:, k]] for k in (0, 1))
    for share in _BETWEEN:
        points = (1.0 - share) * first + share * last
        nearest = tree.query(points)[1]
        inside &= np.einsum("nd,nd->n", points - mesh.vertices[nearest], normals[nearest]) < outside
    return inside


def _blended(mesh: TriangleMesh, seeds: NDArray[np.int64]) -> csr_array:
    """Return blurred regions of the vertices that are nearest along edges to each seed, (n, s)."""
    points, count = mesh.vertices, len(mesh.vertices)
    ends = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    lengths = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    # Entries of edges that two triangles share would be added up: the graph of ones says how many there are.
    shape = (count, count)
    both = np.concatenate([ends, ends[:, ::-1]])
    uses = coo_array((np.ones(len(both)), both.T), shape=shape).tocsr()
    # Whole numbers add up without rounding, so that equal ways stay equal wherever the mesh stands.
    steps = np.maximum(np.round(lengths / (_STEP * np.sqrt(mesh.area))), 1.0)
    graph = coo_array((np.tile(steps, 2), both.T), shape=shape).tocsr()
    graph.data = np.round(graph.data / uses.data)
    away, _, sources = dijkstra(graph, directed=False, indices=seeds, min_only=True, return_predecessors=True)
    place = np.full(count, -1)
    place[seeds] = np.arange(len(seeds))
    # Components without a seed go with the nearest one.
    own = np.where(np.isfinite(away), place[np.maximum(sources, 0)], cKDTree(points[seeds]).query(points)[1])
    blend = csr_array((np.ones(count), (np.arange(count), own)), shape=(count, len(seeds)))
    around = (uses > 0).astype(np.float64) + diags_array(np.ones(count))
    average = diags_array(1.0 / np.asarray(around.sum(axis=1)).ravel()) @ around
    for _ in range(_BLURS):
        blend = average @ blend
    return csr_array(blend)
