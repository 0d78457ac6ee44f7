# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove folds of a mesh that has been deformed to lie on another surface.

Around each group of folded triangles, a disc of the mesh is embedded in a flattened disc of the surface, with its rim
fixed (:mod:`.planar_embedding`). An embedding has no folds if the rim is convex, and rarely any otherwise; those that
appear because triangles of the surface are not flat are removed by moving single vertices. Every step leaves fewer
folds, and none uncovers a part of the surface: flattening shrinks what protrudes, and a muzzle could be cut off without
a fold.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...progress import Control, Progress, Work
from ...sentence import Sentence
from ..arrays.distinct import sorted_distinct
from ..meshes.closest_points import ClosestPointFinder, ClosestPoints
from ..meshes.mesh import TriangleMesh
from ..meshes.mesh_discs import FaceGraph, MeshDisc
from ..meshes.normals import triangle_normals, unit_vectors, vertex_normals
from .fold_finder import FOLDED, FoldFinder
from .planar_embedding import embedded, on_unit_disc, reembedded

# No step of a sweep may uncover points of the surface, such as a muzzle, by more than this, relative to the square root
# of its area; number of sweeps.
_UNCOVERED = (0.02, 0.06)
# Rings of triangles around folds that are embedded, one after the other, up to this multiple of the square root of the
# number of triangles: folds of finer meshes are as wide and have more triangles. Embeddings of wider discs distort more
# than they unfold. Horse as a cow with 86 000 triangles: 4 rings leave 45 of them turned over in 48 CPU s, these rings
# leave 1 in 26 CPU s; with 21 600 triangles, 5 and none.
_RINGS, _WIDEST = (1, 2, 3, 4, 6, 9, 13, 19, 27), 0.095
# Folds closer together than this many rings are embedded together.
_APART = 2
# Rings by which discs may grow until they have no holes, on the mesh and on the surface, which may be much finer.
_MORE_RINGS, _MORE_TARGET_RINGS = 4, 12
# Points of the unit disc this close to a triangle are inside of it, up to rounding.
_INSIDE = 1e-14
# Fraction of the work until folds are found, from a man to another pose with 1 040 000 vertices.
_FOUND = 0.4
# Rounds in which single vertices are moved, and how far towards their neighbors, from where they are and from the
# middle of the neighbors.
_ROUNDS, _STEPS, _MIDDLE_STEPS = 6, (0.2, 0.45), (0.0, 0.25, 0.5, 0.75)


def unfolded(
    folds: FoldFinder, vertices: NDArray[np.float64], message: Sentence, control: Control
) -> Work[NDArray[np.float64]]:
    """Return the vertices, (n, 3), of a mesh on a surface with as few folds as possible.

    Parameters
    ----------
    folds : FoldFinder
        Of the undeformed mesh and the surface, both facing outward.
    vertices : (n, 3) float64
        Deformed positions on the surface. Vertices away from folds stay there.
    message : Sentence
        Reported with the progress.
    control : Control
        Stops the work.
    """
    yield Progress(0.0, message)
    found = folds.folded(vertices, control)
    if not found.any():
        return vertices
    control.check()
    graph = FaceGraph.of(folds.rest)
    control.check()
    unfolding = _Unfolding(folds, graph, FaceGraph.of(folds.target), vertices.copy(), found)
    widest = _WIDEST * np.sqrt(len(folds.rest.faces))
    chosen = _RINGS[: np.searchsorted(_RINGS, widest, side="right")]
    parts = (len(chosen) + 1) * len(_UNCOVERED)

    def report(done: float) -> Progress[None]:
        return Progress(_FOUND + (1.0 - _FOUND) * done / parts, message)

    for sweep, uncovered in enumerate(_UNCOVERED):
        done = sweep * (len(chosen) + 1)
        for number, rings in enumerate(chosen):
            for share in unfolding.embed(rings, uncovered * folds.target.root_area, control):
                yield report(done + number + share)
        for share in unfolding.move_single(control):
            yield report(done + len(chosen) + share)
        if not found.any():
            break
    return unfolding.vertices


@dataclass(frozen=True)
class _Unfolding:
    """The state of a mesh that is unfolded in place: its vertices, and which triangles are folded."""

    folds: FoldFinder
    graph: FaceGraph
    below: FaceGraph
    vertices: NDArray[np.float64]
    folded: NDArray[np.bool_]

    def embed(self, rings: int, most: float, control: Control) -> Iterator[float]:
        """Embed discs around groups of folds where that leaves fewer, and uncovers no point by more than `most`.

        Yields the finished share of the groups before each.
        """
        if not self.folded.any():
            return
        near = self.graph.grown(np.flatnonzero(self.folded), _APART)
        groups = self.graph.components(near)
        for number, group in enumerate(groups):
            control.check()
            yield number / len(groups)
            own = group[self.folded[group]]
            disc = self.graph.disc_around(self.graph.grown(own, rings), _MORE_RINGS) if len(own) else None
            patch = None if disc is None else self._patch(disc)
            # Places change less if the vertices that are not folded say where the others go.
            for embed in () if patch is None else (_Patch.reembedded, _Patch.embedded):
                if self._placed(patch, embed(patch), most):
                    break

    def _patch(self, disc: MeshDisc) -> _Patch | None:
        """Flatten the surface below a disc; None if no disc of the surface holds it."""
        own = self.folds.rest.faces[self.graph.touching(disc.vertices)]
        used = sorted_distinct(own.ravel())
        normals = vertex_normals(self.vertices[used], np.searchsorted(used, own))[np.searchsorted(used, disc.vertices)]
        hits = self.folds.finder.find(self.vertices[disc.vertices], normals)
        area = self.below.disc_around(self.below.grown(sorted_distinct(hits.triangles)), _MORE_TARGET_RINGS)
        return None if area is None else _Patch.of(self.folds, disc, area, hits)

    def _placed(self, patch: _Patch, places: NDArray[np.float64], most: float) -> bool:
        """Move the inner vertices of a patch if that leaves fewer folds and does not uncover the surface."""
        disc = patch.disc
        chosen, faces = disc.vertices[disc.inner], self.folds.rest.faces[disc.triangles]
        touched, before = self.graph.touching(chosen), self.vertices[chosen]
        uncovered = patch.uncovered(self.vertices[faces])
        self.vertices[chosen] = places[disc.inner]
        left = self.folds.scores(self.vertices[self.folds.rest.faces[touched]], touched) < FOLDED
        better = left.sum() < self.folded[touched].sum()
        if not better or (patch.uncovered(self.vertices[faces]) > uncovered + most).any():
            self.vertices[chosen] = before
            return False
        self.folded[touched] = left
        return True

    def move_single(self, control: Control) -> Iterator[float]:
        """Move single corners of folded triangles to where the worst triangle around them is best.

        Yields the finished share of the rounds before each vertex.
        """
        for done in range(_ROUNDS):
            moved = False
            corners = np.unique(self.folds.rest.faces[self.folded])
            for number, vertex in enumerate(corners):
                control.check()
                yield (done + number / len(corners)) / _ROUNDS
                moved |= self._improve(int(vertex))
            if not moved:
                break

    def _improve(self, vertex: int) -> bool:
        """Move a vertex to the best of some places around it; tell whether one is better than its own."""
        touched = self.graph.touching(np.array([vertex]))
        faces = self.folds.rest.faces[touched]
        tried = np.concatenate([self.vertices[None, vertex], self._places_around(vertex, faces)])
        corners = np.repeat(self.vertices[faces][None], len(tried), axis=0)
        corners[:, faces == vertex] = tried[:, None]
        scores = self.folds.scores(corners.reshape(-1, 3, 3), np.tile(touched, len(tried))).reshape(len(tried), -1)
        # Fewest folds first, then the highest least score; the own place wins ties.
        best = int(np.lexsort((-scores.min(axis=1), (scores < FOLDED).sum(axis=1)))[0])
        self.vertices[vertex] = tried[best]
        self.folded[touched] = scores[best] < FOLDED
        return best > 0

    def _places_around(self, vertex: int, faces: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return places on the surface among the neighbors of a vertex, (k, 3)."""
        ring = self.vertices[np.setdiff1d(faces, [vertex])]
        own, middle = self.vertices[vertex], ring.mean(axis=0)
        places = [own + step * (ring - own) for step in _STEPS]
        places += [middle + step * (ring - middle) for step in _MIDDLE_STEPS]
        target = self.folds.target
        facing = triangle_normals(target.corners[self.folds.finder.closest.find(ring).triangles])
        normal = unit_vectors(facing.mean(axis=0, keepdims=True))
        flat = np.concatenate(places)
        hits = self.folds.finder.find(flat, np.repeat(normal, len(flat), axis=0))
        return hits.interpolated(target.corners)


@dataclass(frozen=True)
class _Patch:
    """A disc of the mesh and the flattened disc of the surface below it.

    `plane`, (k, 2), are the places of the vertices of `area` in the plane, and `places`, (v, 2), those of `disc`.
    """

    target: TriangleMesh
    rest: NDArray[np.float64]
    disc: MeshDisc
    area: MeshDisc
    plane: NDArray[np.float64]
    places: NDArray[np.float64]

    @classmethod
    def of(cls, folds: FoldFinder, disc: MeshDisc, area: MeshDisc, hits: ClosestPoints) -> _Patch:
        plane = on_unit_disc(folds.target.vertices[area.vertices], area)
        rows = np.searchsorted(area.triangles, hits.triangles)
        places = np.einsum("nc,ncd->nd", hits.shares, plane[area.faces[rows]])
        return cls(folds.target, folds.rest.vertices[disc.vertices], disc, area, plane, places)

    def embedded(self) -> NDArray[np.float64]:
        """Return positions on the surface, (v, 3), where springs of the undeformed mesh put the vertices."""
        return self._lifted(embedded(self.rest, self.disc, self.places[self.disc.rim]))

    def reembedded(self) -> NDArray[np.float64]:
        """Return positions on the surface, (v, 3), close to where the vertices are."""
        return self._lifted(reembedded(self.places, self.disc))

    def _lifted(self, flat: NDArray[np.float64]) -> NDArray[np.float64]:
        finder, points = ClosestPointFinder(_in_space(self.plane)[self.area.faces]), _in_space(flat)
        above = finder.find_about(points)
        # No triangle is closer to points inside of one.
        outside = np.flatnonzero(above.distances > _INSIDE)
        if len(outside):
            above = above.replaced(outside, finder.find(points[outside]))
        return above.interpolated(self.target.vertices[self.area.vertices][self.area.faces])

    def uncovered(self, corners: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distances from the surface's vertices inside the disc, (k,), to triangles above it, (m, 3, 3)."""
        points = self.target.vertices[self.area.vertices[self.area.inner]]
        # Corners, middles of edges and centers; exact distances take twenty times as long.
        samples = np.concatenate([corners, 0.5 * (corners + np.roll(corners, 1, axis=1))], axis=1)
        samples = np.concatenate([samples, corners.mean(axis=1, keepdims=True)], axis=1)
        return cKDTree(samples.reshape(-1, 3)).query(points)[0]


def _in_space(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return places in the plane, (n, 2), as points of space, (n, 3)."""
    return np.pad(places, ((0, 0), (0, 1)))
