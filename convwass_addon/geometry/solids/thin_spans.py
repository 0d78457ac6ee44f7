# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Spans across thin parts of a solid: segments inside it from one side of a sheet, rod or horn to the other.

They are found at rest and move with the surface, so their middles stay in the middle of a part that is deformed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...one_line import one_line
from ..meshes.closest_points import TriangleSamples, closest_in_triangles
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import triangle_normals
from ..meshes.opposite_sides import OPPOSITE
from ..meshes.point_tree import point_tree
from .touching_balls import ball_radii

# Samples of the surface are about so far apart relative to the longest span: where thin parts are sought, and on them.
_COARSE, _FINE = 0.15, 0.07
# Of spans whose middles are closer together than this, relative to the longest span, one is enough.
_DISTINCT = 0.05


@dataclass(frozen=True)
class ThinSpans:
    """Spans across the thin parts of a solid.

    Attributes
    ----------
    triangles : (2, k) int64
        The triangles that both ends lie on.
    shares : (2, k, 3) float64
        Barycentric coordinates of the ends in these triangles.
    """

    triangles: NDArray[np.int64]
    shares: NDArray[np.float64]

    __repr__ = one_line("triangles")

    @classmethod
    def of(cls, mesh: TriangleMesh, longest: float) -> ThinSpans:
        """Find spans up to a length all over the thin parts of a closed mesh that faces outward.

        A span is a diameter of the largest ball that touches the surface from inside.
        """
        coarse = _Sides.of(mesh, np.arange(len(mesh.faces)), _COARSE * longest)
        diameters = 2.0 * ball_radii(coarse.points, coarse.normals, coarse.tree, 0.5 * longest)
        begins = np.flatnonzero(diameters < longest)
        thin = coarse.triangles[begins[coarse.opposite(begins, diameters[begins])[1]]]
        sides = _Sides.of(mesh, np.unique(thin), _FINE * longest)
        across = diameters[coarse.tree.query(sides.points)[1]]
        begins = np.flatnonzero(across < longest)
        ends, found = sides.opposite(begins, across[begins])
        begins, ends = begins[found], ends[found]
        # Both sides of a part have spans, and so do neighbors.
        middles = np.floor(0.5 * (sides.points[begins] + sides.points[ends]) / (_DISTINCT * longest)).astype(np.int64)
        some = np.unique(middles, axis=0, return_index=True)[1]
        chosen = np.stack([begins[some], ends[some]])
        triangles = sides.triangles[chosen]
        shares = [
            closest_in_triangles(mesh.corners[own], sides.points[points]).shares
            for own, points in zip(triangles, chosen, strict=True)
        ]
        return cls(triangles, np.stack(shares))

    def middles(self, mesh: TriangleMesh, longest: float) -> NDArray[np.float64]:
        """Return the middles, (j, 3), of those spans that are at most so long now that the mesh is deformed."""
        begins, ends = (
            np.einsum("kc,kcd->kd", shares, mesh.corners.take(own, axis=0))
            for own, shares in zip(self.triangles, self.shares, strict=True)
        )
        return 0.5 * (begins + ends)[np.linalg.norm(ends - begins, axis=1) <= longest]


@dataclass(frozen=True)
class _Sides:
    """Samples of some triangles of a mesh, with the directions that these face, and a search tree of the points."""

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    triangles: NDArray[np.int64]
    tree: cKDTree
    spacing: float

    @classmethod
    def of(cls, mesh: TriangleMesh, some: NDArray[np.int64], spacing: float) -> _Sides:
        if not len(some):
            nothing = np.empty((0, 3))
            return cls(nothing, nothing, some, point_tree(nothing), spacing)
        corners = mesh.corners[some]
        samples = TriangleSamples.spaced(corners, spacing)
        normals = triangle_normals(corners)[samples.triangles]
        return cls(samples.points, normals, some[samples.triangles], point_tree(samples.points), spacing)

    def opposite(
        self, begins: NDArray[np.int64], across: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return the samples at a distance below others, (k,), and whether these are on the opposite side."""
        if not len(begins):
            return begins, np.empty(0, bool)
        missed, ends = self.tree.query(self.points[begins] - across[:, None] * self.normals[begins])
        cosines = np.einsum("nd,nd->n", self.normals[begins], self.normals[ends])
        return ends, (cosines < OPPOSITE) & (missed < 0.5 * across + self.spacing)
