# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh that is guided to another shape, and at the end projected onto its surface or moved to its vertices."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.fold_finder import FoldFinder
from ...geometry.deformation.surface_projection import PROJECTION_ROUNDS, projection_rounds
from ...geometry.deformation.unfolding import unfolded
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import vertex_normals
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from ..motions.motion import Motion, weights_between
from .mirror_symmetry import MirrorSymmetry
from .turned_offsets import TurnedOffsets

# Motions move only shapes with weight, so the end of a path is evaluated at this small weight.
_CLOSE = 1e-6
# Fraction of the work of moving a mesh onto the surface until it is unfolded, where there are few folds: measured with
# 1 040 000 vertices.
_PROJECTED = 0.55
# Fractions of the work of making samples symmetric before and after the last one is projected, measured likewise.
_SYMMETRIC, _ENDED = 0.1, 0.9


@dataclass(frozen=True)
class GuidedWay:
    """The mesh on its way to one of the shapes.

    Attributes
    ----------
    motion : Motion
        The guided motion of all shapes, the first of which is the mesh.
    count : int
        Number of shapes.
    index : int
        Index of the other shape.
    folds : FoldFinder
        Of the mesh and the other shape.
    heights : (n,) float64
        Remaining distances to the other surface at the end, along the normals of the guided mesh.
    mended : TurnedOffsets
        Further offsets of vertices near folds.
    ends_on_vertices : bool
        Whether vertices end at those of the other shape with the same numbers.
    """

    motion: Motion
    count: int
    index: int
    folds: FoldFinder
    heights: NDArray[np.float64]
    mended: TurnedOffsets
    ends_on_vertices: bool = False

    @classmethod
    def of(cls, motion: Motion, count: int, index: int, mesh: TriangleMesh, target: TriangleMesh) -> GuidedWay:
        """Guide the mesh to the end, and leave it there."""
        nothing = TurnedOffsets.of(mesh, mesh.vertices, np.zeros_like(mesh.vertices))
        return cls(motion, count, index, FoldFinder.of(mesh, target), np.zeros(len(mesh.vertices)), nothing)

    def onto_surface(self, message: Sentence, control: Control) -> Work[GuidedWay]:
        """Project the guided mesh onto the surface at the end, and unfold it."""
        guided = self.guided(1.0)
        control.check()
        normals = vertex_normals(guided.vertices, self.mesh.faces)
        drawn = yield from within(self._projected(guided, message, control), 0.0, _PROJECTED)
        heights = np.einsum("nd,nd->n", drawn - guided.vertices, normals)
        laid = guided.vertices + heights[:, None] * normals
        final = yield from within(unfolded(self.folds, laid, message, control), _PROJECTED, 1.0)
        # Normals change abruptly where the guided mesh folds, so vertices there get their whole offset as `mended`.
        mended = (final != laid).any(axis=1)
        heights[mended] = 0.0
        offsets = np.where(mended[:, None], final - guided.vertices, 0.0)
        return replace(self, heights=heights, mended=TurnedOffsets.of(self.mesh, guided.vertices, offsets))

    def _projected(self, guided: TriangleMesh, message: Sentence, control: Control) -> Work[NDArray[np.float64]]:
        """Return the vertices, (n, 3), of a mesh close to the surface after moving them closer to it."""
        rounds = projection_rounds(guided, self.target, self.folds.finder, control)
        for number in range(PROJECTION_ROUNDS):
            yield Progress(number / PROJECTION_ROUNDS, message)
            drawn = next(rounds)
        return drawn

    def onto_vertices(self) -> GuidedWay:
        """Move the vertices of the guided mesh on to those of the other shape with the same numbers."""
        guided = self.guided(1.0).vertices
        offsets = TurnedOffsets.of(self.mesh, guided, self.target.vertices - guided)
        return replace(self, mended=offsets, ends_on_vertices=True)

    @property
    def mesh(self) -> TriangleMesh:
        """The mesh, undeformed."""
        return self.folds.rest

    @property
    def target(self) -> TriangleMesh:
        """The other shape, undeformed."""
        return self.folds.target

    def guided(self, t: float) -> TriangleMesh:
        """Return the guided mesh; at the end, its limit, since a shape without weight is not moved."""
        weights = weights_between(self.count, (0, self.index), min(t, 1.0 - _CLOSE))
        moved = self.motion.moved(weights)[0]
        return TriangleMesh(moved.vertices[: len(self.mesh.vertices)], self.mesh.faces)

    def at(self, t: float) -> NDArray[np.float64]:
        """Return the vertices at a time from 0 to 1, (n, 3)."""
        if t == 0.0:
            return self.mesh.vertices
        guided = self.guided(t)
        drawn = guided.vertices + (t * self.heights)[:, None] * vertex_normals(guided.vertices, self.mesh.faces)
        return self.mended.added(drawn, guided.vertices, t)

    def sampled(self, count: int, message: Sentence, control: Control) -> Work[NDArray[np.float64]]:
        """Return the vertices at `count` even steps of time, (count, n, 3)."""
        samples = np.empty((count, *self.mesh.vertices.shape))
        for index, t in enumerate(np.linspace(0.0, 1.0, count)):
            control.check()
            yield Progress(index / count, message)
            samples[index] = self.at(float(t))
        return samples

    def symmetrized(
        self, samples: NDArray[np.float64], symmetry: MirrorSymmetry, message: Sentence, control: Control
    ) -> Work[NDArray[np.float64]]:
        """Make samples symmetric, and distribute the projection of the last one onto the surface evenly over all."""
        found = np.empty_like(samples)
        found[0] = samples[0]
        for index in range(1, len(samples)):
            control.check()
            yield Progress(_SYMMETRIC * index / len(samples), message)
            found[index] = symmetry.symmetrized(samples[index])
        if self.ends_on_vertices:
            return found
        end = yield from within(self._symmetric_end(found[-1], symmetry, message, control), _SYMMETRIC, _ENDED)
        added = end - found[-1]
        for index, t in enumerate(np.linspace(0.0, 1.0, len(samples))[1:], start=1):
            control.check()
            yield Progress(_ENDED + (1.0 - _ENDED) * index / len(samples), message)
            found[index] = symmetry.symmetrized(found[index] + t * added)
        return found

    def _symmetric_end(
        self, points: NDArray[np.float64], symmetry: MirrorSymmetry, message: Sentence, control: Control
    ) -> Work[NDArray[np.float64]]:
        """Project symmetric vertices onto the surface, and unfold them."""
        projected = self._projected(TriangleMesh(points, self.mesh.faces), message, control)
        drawn = symmetry.symmetrized((yield from within(projected, 0.0, _PROJECTED)))
        return (yield from within(self._unfolded_symmetrically(drawn, symmetry, message, control), _PROJECTED, 1.0))

    def _unfolded_symmetrically(
        self, points: NDArray[np.float64], symmetry: MirrorSymmetry, message: Sentence, control: Control
    ) -> Work[NDArray[np.float64]]:
        """Remove folds of symmetric vertices on one side, and mirror that side onto the other."""
        unfolded_points = yield from unfolded(self.folds, points, message, control)
        if unfolded_points is points:
            return points
        choices = (points, *symmetry.mirrored_sides(unfolded_points))
        return min(choices, key=lambda own: int(self.folds.folded(own, control).sum()))
