# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarser meshes by clusters of vertices that grow along the surface, never through the air.

Every cluster becomes a vertex, and every triangle whose corners lie in three clusters becomes a triangle between them:
the dual of the Voronoi diagram of the clusters' seeds, with distances along edges. It has the topology of the fine mesh
where every cluster is a disc and every two neighbors meet along one line (the closed ball property; H. Edelsbrunner and
N. Shah, "Triangulating topological spaces", International Journal of Computational Geometry and Applications 7, 1997).
Where that fails, as on thin legs, clusters are made smaller.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from ..progress import UNINTERRUPTED, Control
from .closest_points import closest_in_triangles
from .edges import distinct_corners, vertex_components
from .mesh import TriangleMesh

# Rounds in which seeds move to the middle of their clusters.
_LLOYD_ROUNDS = 3
# Rounds in which clusters that are no discs, or do not meet as they should, are divided.
_DIVIDING_ROUNDS = 16
# Seeds that every connected component gets at least, if it has so many vertices.
_FEWEST_SEEDS = 24
# A coarser mesh with more than this share of the vertices is none.
_LARGEST_SHARE = 0.5
# Pairs of a vertex and a triangle that are measured at once.
_PAIRS_AT_ONCE = 1 << 18
# Cells along an axis of the space-filling curve, as a power of two.
_CURVE_BITS = 16


@dataclass(frozen=True)
class Coarsening:
    """A coarser mesh and how it belongs to the finer one.

    Attributes
    ----------
    mesh : TriangleMesh
        The coarser mesh; all its vertices are used, and they are vertices of the finer one.
    seeds : (c,) int64
        The vertex of the finer mesh that each of its vertices is.
    clusters : (n,) int64
        The vertex of the coarser mesh that every vertex of the finer one belongs to; -1 where no triangle uses it.
    prolongation : (n, c) csr_array
        Takes values at the coarser vertices to the finer ones, linearly, each from the closest point of the coarser
        triangles around its own cluster's seed. Not negative; rows sum to one, or to zero for unused vertices.
    """

    mesh: TriangleMesh
    seeds: NDArray[np.int64]
    clusters: NDArray[np.int64]
    prolongation: csr_array

    def sums(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the sums over every cluster, (k, c), of values at the finer vertices, (k, n)."""
        # Unused vertices go to a cluster of their own, which is dropped.
        count = len(self.seeds)
        labels = np.where(self.clusters < 0, count, self.clusters)
        return np.stack([np.bincount(labels, column, count + 1)[:count] for column in values])


def coarsened(
    mesh: TriangleMesh,
    areas: NDArray[np.float64],
    count: int,
    kept: NDArray[np.int64] | None = None,
    control: Control = UNINTERRUPTED,
) -> Coarsening | None:
    """Return a mesh of about `count` vertices that follows the surface of `mesh`; None where there is none.

    Parameters
    ----------
    mesh : TriangleMesh
        Of any topology, open or closed, in any number of pieces.
    areas : (n,) float64
        Area of every vertex; coarse vertices are spread evenly over it.
    count : int
        Wanted number of vertices. There may be more: every piece keeps enough of them to stay a surface of its
        topology, and thin parts need small triangles.
    kept : (k,) int64, optional
        Vertices that are to be among the coarser mesh's; those that no triangle uses are not.
    control : Control
        Ends the work when cancelled.

    Returns
    -------
    Coarsening or None
        None where even the coarser mesh would have more than half of the vertices, or would fall apart.
    """
    fine = _Fine.of(mesh, areas, control)
    if fine is None:
        return None
    limit = _LARGEST_SHARE * len(fine.points)
    seeds = fine.spread(count)
    for _ in range(_LLOYD_ROUNDS):
        control.check()
        if len(seeds) > limit:
            return None
        clusters = fine.grown(seeds)
        control.check()
        seeds = fine.centered(clusters)
    if kept is not None:
        seeds = fine.with_kept(fine.grown(seeds), kept)
    for _ in range(_DIVIDING_ROUNDS):
        control.check()
        if len(seeds) > limit:
            return None
        clusters = fine.grown(seeds)
        control.check()
        more = fine.dividing(clusters)
        if not len(more):
            break
        seeds = np.concatenate([seeds, more])
    else:
        clusters = fine.grown(seeds)
    control.check()
    labels = clusters.labels[fine.faces]
    a, b, c = labels.T
    coarse = TriangleMesh(fine.points[seeds], labels[(a != b) & (b != c) & (c != a)])
    if not fine.is_whole(coarse, seeds):
        return None
    own = np.full(len(mesh.vertices), -1, np.int64)
    own[fine.used] = clusters.labels
    return Coarsening(coarse, fine.used[seeds], own, _prolongation(mesh, own, coarse, control))


@dataclass(frozen=True)
class _Clusters:
    """Clusters of vertices around seeds.

    Attributes
    ----------
    seeds : (c,) int64
        Vertices.
    labels : (n,) int64
        The cluster of every vertex.
    distances : (n,) float64
        To the cluster's seed, along edges.
    """

    seeds: NDArray[np.int64]
    labels: NDArray[np.int64]
    distances: NDArray[np.float64]

    def farthest(self, chosen: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the vertex farthest from its seed in each chosen cluster that has more than the seed."""
        most = np.zeros(len(self.seeds))
        np.maximum.at(most, self.labels, self.distances)
        last = np.flatnonzero(self.distances == most[self.labels])
        farthest = np.empty(len(self.seeds), np.int64)
        # Of equally far ones the last stays.
        farthest[self.labels[last]] = last
        return np.setdiff1d(farthest[chosen], self.seeds)


@dataclass(frozen=True)
class _Fine:
    """The part of a mesh that triangles with three different corners use, every triangle once.

    Attributes
    ----------
    used : (n,) int64
        Index of every vertex in the mesh.
    points : (n, 3) float64
    areas : (n,) float64
    faces : (m, 3) int64
    edges : (e, 2) int64
        Every edge once.
    graph : (n, n) csr_array
        Lengths of the edges, in one direction.
    pieces : (n,) int64
        The connected piece of every vertex.
    """

    used: NDArray[np.int64]
    points: NDArray[np.float64]
    areas: NDArray[np.float64]
    faces: NDArray[np.int64]
    edges: NDArray[np.int64]
    graph: csr_array
    pieces: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: TriangleMesh, areas: NDArray[np.float64], control: Control) -> _Fine | None:
        """Strip a mesh; None where nothing is left."""
        proper = mesh.faces[distinct_corners(mesh.faces)]
        is_used = np.zeros(len(mesh.vertices), bool)
        is_used[proper] = True
        used = np.flatnonzero(is_used)
        if not len(used):
            return None
        faces = _without_doubles((np.cumsum(is_used) - 1)[proper], len(used))
        points = mesh.vertices[used]
        control.check()
        ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        # Sorted by hand: NumPy's unique takes several times as long for millions of numbers.
        keys = np.sort(ends[:, 0] * len(used) + ends[:, 1])
        edges = np.stack(np.divmod(keys[np.diff(keys, prepend=-1) > 0], len(used)), axis=1)
        lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
        control.check()
        # An edge without length is still an edge.
        lengths = np.maximum(lengths, np.finfo(float).tiny)
        graph = coo_array((lengths, edges.T), shape=(len(used), len(used))).tocsr()
        pieces = vertex_components(TriangleMesh(points, faces))
        return cls(used, points, areas[used], faces, edges, graph, pieces)

    def spread(self, count: int) -> NDArray[np.int64]:
        """Choose about `count` seeds, evenly by area: at even steps along a curve that fills space, piece by piece."""
        order = np.lexsort((_along_curve(self.points), self.pieces))
        sizes = np.bincount(self.pieces)
        by_piece = np.bincount(self.pieces, self.areas)
        wanted = np.round(count * by_piece / by_piece.sum()).astype(np.int64)
        wanted = np.minimum(np.maximum(wanted, _FEWEST_SEEDS), sizes)
        seeds = []
        for own, number in zip(np.split(order, np.cumsum(sizes)[:-1]), wanted, strict=True):
            if number == len(own):
                seeds.append(own)
                continue
            reached = np.cumsum(self.areas[own])
            steps = (np.arange(number) + 0.5) / number * reached[-1]
            seeds.append(own[np.unique(np.minimum(np.searchsorted(reached, steps), len(own) - 1))])
        return np.concatenate(seeds)

    def grown(self, seeds: NDArray[np.int64]) -> _Clusters:
        """Give every vertex to the seed that is nearest along edges."""
        distances, _, sources = dijkstra(
            self.graph, directed=False, indices=seeds, min_only=True, return_predecessors=True
        )
        index = np.empty(len(self.points), np.int64)
        index[seeds] = np.arange(len(seeds))
        return _Clusters(seeds, index[sources], distances)

    def centered(self, clusters: _Clusters) -> NDArray[np.int64]:
        """Return for every cluster its vertex that is closest to its center of mass."""
        mass = np.bincount(clusters.labels, self.areas)
        centers = np.stack([np.bincount(clusters.labels, self.areas * x) / mass for x in self.points.T], axis=1)
        away = np.square(self.points - centers[clusters.labels]).sum(axis=1)
        least = np.full(len(mass), np.inf)
        np.minimum.at(least, clusters.labels, away)
        closest = np.flatnonzero(away == least[clusters.labels])[::-1]
        found = np.empty(len(mass), np.int64)
        # The first of equally close ones is written last, and stays.
        found[clusters.labels[closest]] = closest
        return found

    def with_kept(self, clusters: _Clusters, kept: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return seeds with vertices of the mesh among them; one of each cluster takes the place of its seed."""
        ours = np.flatnonzero(np.isin(self.used, kept))
        labels, first = np.unique(clusters.labels[ours], return_index=True)
        seeds = clusters.seeds.copy()
        seeds[labels] = ours[first]
        return np.union1d(seeds, ours)

    def dividing(self, clusters: _Clusters) -> NDArray[np.int64]:
        """Return more seeds, for clusters that are no discs and for neighbors that do not meet along one line.

        By Euler numbers: vertices - edges + triangles is one for a disc. Edges that cross from one cluster to another,
        less the triangles that two of them bound, is one for a line between them; and at one end of it at least a third
        cluster has to meet them, or they would have no triangle in common.
        """
        count = len(clusters.seeds)
        ends, corners = clusters.labels[self.edges], clusters.labels[self.faces]
        inner = ends[:, 0] == ends[:, 1]
        whole = (corners == corners[:, :1]).all(axis=1)
        euler = np.bincount(clusters.labels, minlength=count) - np.bincount(ends[inner, 0], minlength=count)
        euler += np.bincount(corners[whole, 0], minlength=count)
        pairs, crossings = np.unique(_pair_keys(ends[~inner], count), return_counts=True)
        low, middle, high = np.sort(corners, axis=1).T
        two = (low == middle) != (middle == high)
        meeting = (low != middle) & (middle != high)
        lines = crossings - _counted(pairs, _pair_keys(np.stack([low, high], 1)[two], count))
        at_ends = sum(
            _counted(pairs, _pair_keys(np.stack(sides, 1)[meeting], count))
            for sides in ((low, middle), (middle, high), (low, high))
        )
        bad_pairs = np.stack(np.divmod(pairs[(lines != 1) | (at_ends == 0)], count), axis=1)
        return clusters.farthest(np.union1d(np.flatnonzero(euler != 1), bad_pairs.ravel()))

    def is_whole(self, coarse: TriangleMesh, seeds: NDArray[np.int64]) -> bool:
        """Tell whether triangles hold all vertices of a coarser mesh together as they are held together here."""
        if not len(coarse.faces):
            return False
        found = vertex_components(coarse)
        return bool(found.min() >= 0) and found.max() == self.pieces.max() == len(np.unique(self.pieces[seeds])) - 1


def _without_doubles(faces: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Keep of triangles with the same corners the first."""
    low, middle, high = np.sort(faces, axis=1).T
    order = np.lexsort((high, low * count + middle))
    keys = np.stack([low, middle, high], axis=1)[order]
    is_first = np.ones(len(faces), bool)
    is_first[1:] = (keys[1:] != keys[:-1]).any(axis=1)
    return faces[np.sort(order[is_first])]


def _pair_keys(pairs: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """One number for every pair of clusters, (k, 2), in either order."""
    return pairs.min(axis=1) * count + pairs.max(axis=1)


def _counted(keys: NDArray[np.int64], found: NDArray[np.int64]) -> NDArray[np.int64]:
    """How often each of sorted `keys` is among `found`, all of which are keys."""
    return np.bincount(np.searchsorted(keys, found), minlength=len(keys))


def _along_curve(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Places of points along a Z-order curve (Morton 1966), (n,)."""
    low, extent = points.min(axis=0), float(np.ptp(points, axis=0).max())
    cells = ((points - low) / extent * ((1 << _CURVE_BITS) - 1)).astype(np.int64) if extent > 0 else points * 0
    place = np.zeros(len(points), np.int64)
    for bit in range(_CURVE_BITS):
        for axis in range(3):
            place |= ((cells[:, axis].astype(np.int64) >> bit) & 1) << (3 * bit + axis)
    return place


def _prolongation(mesh: TriangleMesh, clusters: NDArray[np.int64], coarse: TriangleMesh, control: Control) -> csr_array:
    """Interpolate at the closest points of the triangles around every vertex's own seed."""
    vertices = np.flatnonzero(clusters >= 0)
    # Triangles by the vertex that they lie around.
    around = np.argsort(coarse.faces.ravel(), kind="stable") // 3
    counts = np.bincount(coarse.faces.ravel(), minlength=len(coarse.vertices))
    starts = np.cumsum(counts) - counts
    columns = np.empty((len(vertices), 3), np.int64)
    shares = np.empty((len(vertices), 3))
    for some in _chunks(counts[clusters[vertices]]):
        control.check()
        own = clusters[vertices[some]]
        number = counts[own]
        first = np.cumsum(number) - number
        candidates = around[np.arange(number.sum()) + np.repeat(starts[own] - first, number)]
        points = np.repeat(mesh.vertices[vertices[some]], number, axis=0)
        found = closest_in_triangles(coarse.corners[candidates], points)
        # The first of the closest ones of every vertex.
        least = np.repeat(np.minimum.reduceat(found.distances, first), number)
        places = np.flatnonzero(found.distances == least)
        best = places[np.searchsorted(places, first)]
        columns[some], shares[some] = coarse.faces[candidates[best]], found.shares[best]
    # Rounding leaves shares a little below zero.
    np.maximum(shares, 0.0, out=shares)
    shares /= shares.sum(axis=1, keepdims=True)
    rows = np.repeat(vertices, 3)
    entries = coo_array((shares.ravel(), (rows, columns.ravel())), shape=(len(clusters), len(coarse.vertices)))
    matrix = entries.tocsr()
    matrix.eliminate_zeros()
    return matrix


def _chunks(numbers: NDArray[np.int64]) -> Iterator[slice]:
    """Slices of `numbers` whose sums are about as many as are handled at once."""
    blocks = np.cumsum(numbers) // _PAIRS_AT_ONCE
    bounds = [0, *(np.flatnonzero(np.diff(blocks)) + 1), len(numbers)]
    return (slice(start, end) for start, end in pairwise(bounds))
