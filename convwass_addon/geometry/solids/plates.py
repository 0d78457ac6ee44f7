# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets beside solids, such as fins, wings, petals and capes, as plates of some thickness.

A sheet encloses nothing. The winding number is about one half on its front and minus one half behind it, and what of a
bent sheet counts as full is chance: a grid shows shreds of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.label_sums import label_sums
from ..meshes.edges import edge_use
from ..meshes.face_neighbors import FaceNeighbors
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import unit_vectors
from ..meshes.welding import place_labels
from .orientation import orient_outward, points_in_front
from .solid_angles import winding_numbers

# Samples per patch at which winding numbers are measured, and how far in front of it, relative to its longest side.
_PROBES, _WITHIN = 7, 1e-4
# On a sheet, the mean of the winding numbers on both sides is a whole number: 0, or 1 in a solid. On the surface of a
# solid it is a half, also if there are holes in it. On bent sheets it differs from a whole number by up to this, on a
# hemisphere, which is filled like other solids with a hole, by more.
_NEARLY = 0.2
# Smaller patches, as a fraction of the area of the shape, are not examined; nor are so many that this takes long.
_LEAST_AREA, _MOST_PAIRS = 2e-3, 1e8


@dataclass(frozen=True)
class Plates:
    """The triangles of a shape whose sheets have become plates.

    Attributes
    ----------
    faces : (m, 3) int64
        The triangles of the shape, facing outward, those of the backs of the plates, and those of their rims.
    sources : (m,) int64
        The triangle of the shape that each belongs to.
    copied : (k,) int64
        Vertices of the shape whose copies, in this order after all vertices, form the backs.
    sheets : (s, 3) int64
        Triangles of the sheets, with indices of `copied`.
    places : (k,) int64
        The place of every copy; copies at the same place of a sheet stay together.
    """

    faces: NDArray[np.int64]
    sources: NDArray[np.int64]
    copied: NDArray[np.int64]
    sheets: NDArray[np.int64]
    places: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: TriangleMesh) -> Plates | None:
        """Find the sheets of a shape; return None if it has none, or nothing else.

        Parameters
        ----------
        mesh : TriangleMesh
            Any triangles.
        """
        use = edge_use(mesh.faces)
        return cls.of_outward(orient_outward(mesh, use)) if (use.count == 1).any() else None

    @classmethod
    def of_outward(cls, outward: TriangleMesh) -> Plates | None:
        """Find the sheets of a shape that is oriented outward, as :meth:`of` does."""
        patches = _Patches.of(outward)
        chosen = np.isin(patches.labels, patches.sheets(outward))
        if chosen.all() or not chosen.any():
            return None
        return cls._plated(outward, patches, np.flatnonzero(chosen))

    @classmethod
    def _plated(cls, outward: TriangleMesh, patches: _Patches, rows: NDArray[np.int64]) -> Plates:
        """Make plates of some triangles of a shape."""
        count = len(outward.vertices)
        own = outward.faces[rows]
        # Patches that touch have copies of their own.
        keys = patches.labels[rows][:, None] * count + own
        known, sheets = np.unique(keys, return_inverse=True)
        sheets = sheets.reshape(own.shape)
        copied = known % count
        places = np.unique(known - copied + patches.places[copied], return_inverse=True)[1]
        owners, corners = patches.rims(rows)
        here, there = own[owners, corners], own[owners, (corners + 1) % 3]
        back, beyond = (count + sheets[owners, corner] for corner in (corners, (corners + 1) % 3))
        rims = np.concatenate([np.stack([there, here, back], axis=1), np.stack([there, back, beyond], axis=1)])
        return cls(
            np.concatenate([outward.faces, count + sheets[:, ::-1], rims]),
            np.concatenate([np.arange(len(outward.faces)), rows, np.tile(rows[owners], 2)]),
            copied,
            sheets,
            places,
        )

    def thick(self, vertices: NDArray[np.float64], thickness: float) -> TriangleMesh:
        """Return the shape with plates of a thickness, behind the sheets.

        Parameters
        ----------
        vertices : (n, 3) float64
            Those of the shape, in any pose.
        thickness : float
            In units of the vertices.
        """
        points = vertices[self.copied]
        corners = points[self.sheets]
        areas = np.repeat(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), 3, axis=0)
        normals = unit_vectors(label_sums(self.places[self.sheets].ravel(), areas, int(self.places.max()) + 1))
        backs = points - thickness * normals[self.places]
        return TriangleMesh(np.concatenate([vertices, backs]), self.faces)


@dataclass(frozen=True)
class _Patches:
    """Patches of triangles that agree across edges which only they have.

    Attributes
    ----------
    places : (n,) int64
        Places of the vertices, so that seams are no edges.
    labels : (m,) int64
        The patch of every triangle.
    is_open : (m, 3) bool
        Which sides of the triangles have no other triangle.
    is_rim : (m, 3) bool
        Which sides are at the border of a patch.
    """

    places: NDArray[np.int64]
    labels: NDArray[np.int64]
    is_open: NDArray[np.bool_]
    is_rim: NDArray[np.bool_]

    @classmethod
    def of(cls, mesh: TriangleMesh) -> _Patches:
        places = place_labels(mesh.vertices)
        corners = places[mesh.faces]
        proper = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
        faces = corners[proper]
        use = edge_use(faces)
        # Triangles that lie on each other, facing opposite ways, are no sheet.
        neighbors = FaceNeighbors.of(use).agreeing().unless_same(faces)
        is_rim, is_open = (np.zeros(mesh.faces.shape, bool) for _ in range(2))
        is_rim[proper] = ~_marked(neighbors.sides, len(faces))
        is_open[proper] = _marked(use.side[use.start[use.count == 1]], len(faces))
        return cls(places, neighbors.among(proper).labels(len(mesh.faces)), is_open, is_rim)

    def rims(self, rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the sides of some triangles at the borders of their patches: indices of `rows`, and corners."""
        return np.nonzero(self.is_rim[rows])

    def sheets(self, outward: TriangleMesh) -> NDArray[np.int64]:
        """Return the patches of a mesh that enclose nothing, alone or together with others."""
        areas = np.bincount(self.labels, outward.face_areas)
        tested = np.unique(self.labels[self.is_open.any(axis=1)])
        tested = tested[areas[tested] > _LEAST_AREA * outward.area]
        most = int(_MOST_PAIRS // (_PROBES * len(outward.faces)))
        tested = tested[np.argsort(-areas[tested], kind="stable")][:most]
        probes = np.concatenate([_probes(outward, self.labels == patch) for patch in tested] or [np.empty((0, 3))])
        # Behind the triangles, winding numbers are larger by one.
        middles = winding_numbers(probes, outward).reshape(-1, _PROBES) + 0.5
        found = np.zeros(len(tested), bool)
        while True:
            added = ~found & (np.abs(middles - np.round(middles)).mean(axis=1) < _NEARLY)
            if not added.any():
                return tested[found]
            found |= added
            # Sheets change the winding numbers around others.
            sheets = TriangleMesh(outward.vertices, outward.faces[np.isin(self.labels, tested[added])])
            middles[~found] -= winding_numbers(probes.reshape(-1, _PROBES, 3)[~found], sheets).reshape(-1, _PROBES)


def _marked(sides: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    """Return which sides of so many triangles are among some, (count, 3)."""
    marked = np.zeros(3 * count, bool)
    marked[sides] = True
    return marked.reshape(-1, 3)


def _probes(mesh: TriangleMesh, chosen: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return points just in front of some triangles of a mesh, evenly spread over their area, (_PROBES, 3)."""
    return points_in_front(TriangleMesh(mesh.vertices, mesh.faces[chosen]), _PROBES, _WITHIN)
