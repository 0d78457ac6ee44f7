# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove folds of a mesh that has been deformed to lie on another surface.

Around each group of folded triangles, a disc of the mesh is embedded in a flattened disc of the surface, with its rim
fixed (:mod:`.planar_embedding`). An embedding has no folds if the rim is convex, and rarely any otherwise; those that
appear because triangles of the surface are not flat are removed by moving single vertices. No step is taken that does
not leave fewer folds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..progress import UNINTERRUPTED, Control
from .closest_points import ClosestPointFinder
from .fold_finder import FOLDED, FoldFinder
from .mesh_discs import FaceGraph, MeshDisc
from .normals import triangle_normals, unit_vectors, vertex_normals
from .planar_embedding import embedded, on_unit_disc

# How often all is done, and rings of triangles around folds that are embedded, one after the other. Embeddings of more
# rings distort more than they unfold (horse as a cow, benchmark `mesh`).
_SWEEPS, _RINGS = 4, (1, 2, 3, 4, 5, 6)
# Folds closer together than this many rings are embedded together.
_APART = 2
# Rings by which discs may grow until they have no holes, on the mesh and on the surface, which may be much finer.
_MORE_RINGS, _MORE_TARGET_RINGS = 4, 12
# Rounds in which single vertices are moved, and how far towards their neighbors, from where they are and from the
# middle of the neighbors.
_ROUNDS, _STEPS, _MIDDLE_STEPS = 6, (0.2, 0.45), (0.0, 0.25, 0.5, 0.75)


def unfolded(folds: FoldFinder, vertices: NDArray[np.float64], control: Control = UNINTERRUPTED) -> NDArray[np.float64]:
    """Return the vertices, (n, 3), of a mesh on a surface with as few folds as possible.

    Parameters
    ----------
    folds : FoldFinder
        Of the undeformed mesh and the surface, both facing outward.
    vertices : (n, 3) float64
        Deformed positions on the surface. Vertices away from folds stay there.
    control : Control
        Stops the work.
    """
    found = folds.folded(vertices, control)
    if not found.any():
        return vertices
    unfolding = _Unfolding(folds, FaceGraph.of(folds.rest), FaceGraph.of(folds.target), vertices.copy(), found)
    for _ in range(_SWEEPS):
        before = found.sum()
        for rings in _RINGS:
            unfolding.embed(rings, control)
        unfolding.move_single(control)
        if not found.any() or found.sum() >= before:
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

    def embed(self, rings: int, control: Control) -> None:
        """Embed discs around all groups of folds anew where that leaves fewer."""
        if not self.folded.any():
            return
        near = self.graph.grown(np.flatnonzero(self.folded), _APART)
        for group in self.graph.components(near):
            control.check()
            own = group[self.folded[group]]
            disc = self.graph.disc_around(self.graph.grown(own, rings), _MORE_RINGS) if len(own) else None
            places = None if disc is None else self._embedded(disc)
            if places is not None:
                self._place(disc.vertices[disc.inner], places[disc.inner])

    def _embedded(self, disc: MeshDisc) -> NDArray[np.float64] | None:
        """Return new positions of the vertices of a disc; None if there is no disc of the surface below it."""
        own = self.folds.rest.faces[self.graph.touching(disc.vertices)]
        used, faces = np.unique(own, return_inverse=True)
        normals = vertex_normals(self.vertices[used], faces.reshape(-1, 3))[np.searchsorted(used, disc.vertices)]
        hits = self.folds.finder.find(self.vertices[disc.vertices], normals)
        area = self.below.disc_around(self.below.grown(np.unique(hits.triangles)), _MORE_TARGET_RINGS)
        if area is None:
            return None
        plane = on_unit_disc(self.folds.target.vertices[area.vertices], area)
        row = np.searchsorted(area.triangles, hits.triangles[disc.rim])
        rim = np.einsum("nc,ncd->nd", hits.shares[disc.rim], plane[area.faces[row]])
        flat = embedded(self.folds.rest.vertices[disc.vertices], disc, rim)
        above = ClosestPointFinder(_in_space(plane)[area.faces]).find(_in_space(flat))
        return above.interpolated(self.folds.target.vertices[area.vertices][area.faces])

    def _place(self, chosen: NDArray[np.int64], places: NDArray[np.float64]) -> None:
        """Move some vertices if that leaves fewer folds."""
        touched, before = self.graph.touching(chosen), self.vertices[chosen]
        self.vertices[chosen] = places
        left = self.folds.scores(self.vertices[self.folds.rest.faces[touched]], touched) < FOLDED
        if left.sum() < self.folded[touched].sum():
            self.folded[touched] = left
        else:
            self.vertices[chosen] = before

    def move_single(self, control: Control) -> None:
        """Move single corners of folded triangles to where the worst triangle around them is best."""
        for _ in range(_ROUNDS):
            moved = False
            for vertex in np.unique(self.folds.rest.faces[self.folded]):
                control.check()
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


def _in_space(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return places in the plane, (n, 2), as points of space, (n, 3)."""
    return np.pad(places, ((0, 0), (0, 1)))
