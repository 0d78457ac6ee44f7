# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarser meshes from clusters of vertices that grow along the surface, never through space.

Every cluster becomes a vertex, and every triangle whose corners lie in three clusters becomes a triangle between them:
the dual of the Voronoi diagram of the clusters' seeds, with distances along edges. It has the topology of the fine mesh
if every cluster is a disc and every two adjacent clusters meet along one line (the closed ball property; H.
Edelsbrunner and N. Shah, "Triangulating topological spaces", International Journal of Computational Geometry and
Applications 7, 1997). Where this fails, as on thin legs, clusters are divided.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from ...progress import UNINTERRUPTED, Control, drained
from ..arrays.chunks import chunks_by_sizes
from ..arrays.equal_shares import at_equal_shares
from ..arrays.integer_ranges import integer_ranges
from ..arrays.label_sums import label_sums
from ..meshes.closest_points import closest_in_triangles
from ..meshes.edges import edge_lengths, mesh_edges, proper_faces, proper_part, vertex_components
from ..meshes.mesh import TriangleMesh

# Rounds of Lloyd's algorithm, in which seeds move to the centers of their clusters.
_LLOYD_ROUNDS = 3
# Largest number of rounds in which clusters that violate the closed ball property are divided.
_DIVIDING_ROUNDS = 16
# Least number of seeds of a connected component, if it has that many vertices.
_FEWEST_SEEDS = 24
# By default, a coarser mesh with more than this fraction of the vertices is rejected.
_LARGEST_SHARE = 0.5
# Pairs of a vertex and a triangle processed together.
_PAIRS_AT_ONCE = 1 << 18
# Bits per axis of the cells of the space-filling curve.
_CURVE_BITS = 16


@dataclass(frozen=True)
class Coarsening:
    """A coarser mesh and its relation to the finer one.

    Attributes
    ----------
    mesh : TriangleMesh
        The coarser mesh. It uses all of its vertices, which are vertices of the finer mesh.
    seeds : (c,) int64
        Index in the finer mesh of every coarser vertex.
    clusters : (n,) int64
        Index of the coarser vertex that every finer vertex belongs to; -1 for vertices without triangles.
    prolongation : (n, c) csr_array
        Interpolates values linearly from coarser vertices to finer ones, each at its closest point on the coarser
        triangles around its cluster's seed. Nonnegative; rows sum to one, or to zero for unused vertices.
    """

    mesh: TriangleMesh
    seeds: NDArray[np.int64]
    clusters: NDArray[np.int64]
    prolongation: csr_array

    def sums(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the sums over every cluster, (k, c), of values at the finer vertices, (k, n)."""
        # Unused vertices are put into an extra cluster, which is dropped.
        count = len(self.seeds)
        labels = np.where(self.clusters < 0, count, self.clusters)
        return np.stack([np.bincount(labels, column, count + 1)[:count] for column in values])


def coarsened(
    mesh: TriangleMesh,
    areas: NDArray[np.float64],
    count: int,
    kept: NDArray[np.int64] | None = None,
    control: Control = UNINTERRUPTED,
    *,
    most: float = _LARGEST_SHARE,
) -> Coarsening | None:
    """Return a mesh of about `count` vertices that follows the surface of `mesh`, or None if there is no useful one.

    Parameters
    ----------
    mesh : TriangleMesh
        Of any topology, open or closed, with any number of connected components.
    areas : (n,) float64
        Area of every vertex; coarse vertices are distributed evenly by area.
    count : int
        Desired number of vertices. There may be more: every component keeps enough of them to preserve its topology,
        and thin parts need small triangles.
    kept : (k,) int64, optional
        Vertices that the coarser mesh must contain; vertices without triangles are ignored.
    control : Control
        Stops the work when cancelled.
    most : float
        Largest fraction of the vertices that the coarser mesh may keep.

    Returns
    -------
    Coarsening or None
        None if the coarser mesh would keep more than `most` of the vertices or change the connected components.
    """
    return drained(coarsening_steps(mesh, areas, count, kept, control, most=most))


def coarsening_steps(
    mesh: TriangleMesh,
    areas: NDArray[np.float64],
    count: int,
    kept: NDArray[np.int64] | None,
    control: Control,
    *,
    most: float = _LARGEST_SHARE,
) -> Generator[float, None, Coarsening | None]:
    """Yield the finished share of the rounds before each, and return the same as :func:`coarsened`."""
    fine = _Fine.of(mesh, areas, control)
    if fine is None:
        return None
    limit = most * len(fine.points)
    seeds = fine.spread(count)
    rounds = _LLOYD_ROUNDS + _DIVIDING_ROUNDS
    for done in range(_LLOYD_ROUNDS):
        control.check()
        yield done / rounds
        if len(seeds) > limit:
            return None
        clusters = fine.grown(seeds)
        control.check()
        seeds = fine.centered(clusters)
    if kept is not None:
        seeds = fine.with_kept(fine.grown(seeds), kept)
    for done in range(_LLOYD_ROUNDS, rounds):
        control.check()
        yield done / rounds
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
    coarse = TriangleMesh(fine.points[seeds], proper_faces(clusters.labels[fine.faces]))
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
        Distance along edges to the cluster's seed.
    """

    seeds: NDArray[np.int64]
    labels: NDArray[np.int64]
    distances: NDArray[np.float64]

    def farthest(self, chosen: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the vertex farthest from its seed in each chosen cluster that has more than its seed."""
        most = np.zeros(len(self.seeds))
        np.maximum.at(most, self.labels, self.distances)
        last = np.flatnonzero(self.distances == most[self.labels])
        farthest = np.empty(len(self.seeds), np.int64)
        # Among equally distant vertices, the last one wins.
        farthest[self.labels[last]] = last
        return np.setdiff1d(farthest[chosen], self.seeds)


@dataclass(frozen=True)
class _Fine:
    """The part of a mesh that non-degenerate triangles use, without duplicate triangles.

    Attributes
    ----------
    used : (n,) int64
        Index in the mesh of every vertex.
    points : (n, 3) float64
    areas : (n,) float64
    faces : (m, 3) int64
    edges : (e, 2) int64
        Undirected edges.
    graph : (n, n) csr_array
        Lengths of the edges, stored in one direction.
    pieces : (n,) int64
        The connected component of every vertex.
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
        """Extract this part of a mesh; None if it is empty."""
        used, faces = proper_part(mesh)
        if not len(used):
            return None
        control.check()
        faces = _without_duplicates(faces, len(used))
        points = mesh.vertices[used]
        control.check()
        edges = mesh_edges(faces)
        lengths = edge_lengths(points, edges)
        control.check()
        # An edge of length zero must remain an edge of the sparse graph.
        lengths = np.maximum(lengths, np.finfo(float).tiny)
        graph = coo_array((lengths, edges.T), shape=(len(used), len(used))).tocsr()
        pieces = vertex_components(TriangleMesh(points, faces))
        return cls(used, points, areas[used], faces, edges, graph, pieces)

    def spread(self, count: int) -> NDArray[np.int64]:
        """Choose about `count` seeds, evenly by area along a space-filling curve, for each component separately."""
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
            seeds.append(own[np.unique(at_equal_shares(self.areas[own], number))])
        return np.concatenate(seeds)

    def grown(self, seeds: NDArray[np.int64]) -> _Clusters:
        """Assign every vertex to the seed that is nearest along edges."""
        distances, _, sources = dijkstra(
            self.graph, directed=False, indices=seeds, min_only=True, return_predecessors=True
        )
        index = np.empty(len(self.points), np.int64)
        index[seeds] = np.arange(len(seeds))
        return _Clusters(seeds, index[sources], distances)

    def centered(self, clusters: _Clusters) -> NDArray[np.int64]:
        """Return for every cluster the vertex closest to its center of mass."""
        # All vertices of a cluster may belong to triangles without area only.
        weights = np.where(np.bincount(clusters.labels, self.areas)[clusters.labels] > 0.0, self.areas, 1.0)
        mass = np.bincount(clusters.labels, weights)
        centers = label_sums(clusters.labels, weights[:, None] * self.points, len(mass)) / mass[:, None]
        away = np.square(self.points - centers[clusters.labels]).sum(axis=1)
        least = np.full(len(mass), np.inf)
        np.minimum.at(least, clusters.labels, away)
        closest = np.flatnonzero(away == least[clusters.labels])[::-1]
        found = np.empty(len(mass), np.int64)
        # The order is reversed, so among equally close vertices the first one wins.
        found[clusters.labels[closest]] = closest
        return found

    def with_kept(self, clusters: _Clusters, kept: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the seeds with the vertices to keep; one of them replaces the seed of its cluster."""
        ours = np.flatnonzero(np.isin(self.used, kept))
        labels, first = np.unique(clusters.labels[ours], return_index=True)
        seeds = clusters.seeds.copy()
        seeds[labels] = ours[first]
        return np.union1d(seeds, ours)

    def dividing(self, clusters: _Clusters) -> NDArray[np.int64]:
        """Return more seeds, for clusters that are not discs and for adjacent clusters that do not meet in one line.

        Both are tested by Euler characteristics. A disc has vertices - edges + triangles = 1. For a line between two
        clusters, the edges that cross from one to the other minus the triangles that lie in these two clusters only is
        1; and a third cluster must meet the line at one of its ends, or the two would have no triangle in common.
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
        """Return whether the coarser mesh uses all its vertices and has the same connected components."""
        if not len(coarse.faces):
            return False
        found = vertex_components(coarse)
        return bool(found.min() >= 0) and found.max() == self.pieces.max() == len(np.unique(self.pieces[seeds])) - 1


def _without_duplicates(faces: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Keep the first of all triangles with the same corners."""
    low, middle, high = np.sort(faces, axis=1).T
    order = np.lexsort((high, low * count + middle))
    keys = np.stack([low, middle, high], axis=1)[order]
    is_first = np.ones(len(faces), bool)
    is_first[1:] = (keys[1:] != keys[:-1]).any(axis=1)
    return faces[np.sort(order[is_first])]


def _pair_keys(pairs: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Encode pairs of clusters, (k, 2), in either order, as single numbers."""
    return pairs.min(axis=1) * count + pairs.max(axis=1)


def _counted(keys: NDArray[np.int64], found: NDArray[np.int64]) -> NDArray[np.int64]:
    """Count how often each of the sorted `keys` occurs in `found`, all of which are keys."""
    return np.bincount(np.searchsorted(keys, found), minlength=len(keys))


def _along_curve(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Positions of points along a Z-order curve (Morton 1966), (n,)."""
    low, extent = points.min(axis=0), float(np.ptp(points, axis=0).max())
    cells = ((points - low) / extent * ((1 << _CURVE_BITS) - 1)).astype(np.int64) if extent > 0 else points * 0
    place = np.zeros(len(points), np.int64)
    for bit in range(_CURVE_BITS):
        for axis in range(3):
            place |= ((cells[:, axis].astype(np.int64) >> bit) & 1) << (3 * bit + axis)
    return place


def _prolongation(mesh: TriangleMesh, clusters: NDArray[np.int64], coarse: TriangleMesh, control: Control) -> csr_array:
    """Interpolation at the closest points on the triangles around every vertex's own seed."""
    vertices = np.flatnonzero(clusters >= 0)
    # Triangles grouped by vertex.
    around = np.argsort(coarse.faces.ravel(), kind="stable") // 3
    counts = np.bincount(coarse.faces.ravel(), minlength=len(coarse.vertices))
    starts = np.cumsum(counts) - counts
    columns = np.empty((len(vertices), 3), np.int64)
    shares = np.empty((len(vertices), 3))
    for some in chunks_by_sizes(counts[clusters[vertices]], _PAIRS_AT_ONCE):
        control.check()
        own = clusters[vertices[some]]
        number = counts[own]
        first = np.cumsum(number) - number
        candidates = around[integer_ranges(starts[own], number)[1]]
        points = np.repeat(mesh.vertices[vertices[some]], number, axis=0)
        found = closest_in_triangles(coarse.corners[candidates], points)
        # The first of the closest triangles of every vertex.
        least = np.repeat(np.minimum.reduceat(found.distances, first), number)
        places = np.flatnonzero(found.distances == least)
        best = places[np.searchsorted(places, first)]
        columns[some], shares[some] = coarse.faces[candidates[best]], found.shares[best]
    # Rounding may leave shares slightly negative.
    np.maximum(shares, 0.0, out=shares)
    shares /= shares.sum(axis=1, keepdims=True)
    rows = np.repeat(vertices, 3)
    entries = coo_array((shares.ravel(), (rows, columns.ravel())), shape=(len(clusters), len(coarse.vertices)))
    matrix = entries.tocsr()
    matrix.eliminate_zeros()
    return matrix
