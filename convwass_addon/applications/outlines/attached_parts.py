# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is attached to solids of revolution, such as handles, spouts and fins: how it retracts into them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.quotients import quotients
from ...geometry.arrays.label_sums import label_sums
from ...geometry.meshes.edges import rim_vertices, vertex_components
from ...geometry.meshes.mesh import TriangleMesh

# Vertices farther from the surface of the body than this share of the longest side are on attached parts, and move with
# these entirely if they are twice as far.
_APART = 0.01
# A part that is wound around the body, so that its mean direction is shorter than this, has no middle. The angle that
# others take up around the axis changes at most by this factor.
_WOUND, _MOST_TURNED = 0.5, 2.0
# Parts are flat if they reach less far than this share of the root of their area. Handles, spouts and fins have 0.64 to
# 1.4, a penguin's wings, face and belly at most 0.55.
_FLAT = 0.6
# The root of a part is at the axis if it is closer to it, on average, than this share of the reach. An apple's stem has
# 0.2, the spout of a watering can 0.4, and the handle of a mug more than 1.
_NEAR_AXIS = 0.3


@dataclass(frozen=True)
class AttachedParts:
    """The vertices of a shape that are on parts attached to its body.

    Attributes
    ----------
    looseness : (n,) float64
        How far vertices move with a part, from 0, on the body, to 1.
    reaches : (n,) float64
        Largest distance of a vertex of the same part from the body.
    angles : (n,) float64
        Angles about the axis from the middle of the part, in radians.
    labels : (n,) int64
        Which part a vertex is on, counted from 1; 0 for the body, and for vertices that are loose alone.
    flatness : float
        Share of the surface that is on flat parts: bulges of the body, and what lies along it.
    leaning : float
        Largest reach, as a share of the longest side, of a part that is an end of the body beside the axis, such as the
        stem of an apple.
    """

    looseness: NDArray[np.float64]
    reaches: NDArray[np.float64]
    angles: NDArray[np.float64]
    labels: NDArray[np.int64]
    flatness: float
    leaning: float

    @classmethod
    def of(
        cls,
        mesh: TriangleMesh,
        distances: NDArray[np.float64],
        radii: NDArray[np.float64],
        directions: NDArray[np.float64],
        axis: NDArray[np.float64],
    ) -> AttachedParts:
        """Find the parts of a shape.

        Parameters
        ----------
        mesh : TriangleMesh
            The shape.
        distances : (n,)
            Distances of the vertices from the body.
        radii : (n,)
            Distances of the vertices from the axis.
        directions : (n, 3)
            Unit vectors from the axis to the vertices.
        axis : (3,)
            Direction of the axis.
        """
        looseness = (distances / (_APART * mesh.longest_side) - 1.0).clip(0.0, 1.0)
        is_loose = looseness > 0.0
        loose = TriangleMesh(mesh.vertices, mesh.faces[is_loose[mesh.faces].all(axis=1)])
        parts = vertex_components(loose) + 1
        reaches = np.zeros(parts.max(initial=0) + 1)
        np.maximum.at(reaches, parts, distances)
        middles = label_sums(parts, directions, len(reaches))
        has_middle = np.linalg.norm(middles, axis=1) > _WOUND * np.bincount(parts)
        middle = middles[parts]
        angles = np.arctan2(np.cross(middle, directions) @ axis, (middle * directions).sum(axis=1))
        areas = np.bincount(parts[mesh.faces].ravel(), np.repeat(mesh.face_areas / 3.0, 3), len(reaches))
        is_part = np.arange(len(reaches)) > 0
        is_flat = is_part & (reaches < _FLAT * np.sqrt(areas))
        rim = rim_vertices(loose.faces)
        counts = np.bincount(parts[rim], minlength=len(reaches))
        roots = np.bincount(parts[rim], radii[rim], len(reaches))
        is_end = is_part & (roots < _NEAR_AXIS * reaches * counts)
        return cls(
            looseness,
            np.where(parts > 0, reaches[parts], distances),
            np.where((parts > 0) & has_middle[parts], angles, 0.0),
            parts,
            float(areas[is_flat].sum() / areas.sum()),
            float(reaches[is_end].max(initial=0.0) / mesh.longest_side),
        )

    @classmethod
    def none(cls, count: int) -> AttachedParts:
        """Return that none of `count` vertices is on a part."""
        return cls(*np.zeros((3, count)), np.zeros(count, np.int64), 0.0, 0.0)

    def retracted(self, offsets: NDArray[np.float64], left: float) -> NDArray[np.float64]:
        """Return offsets of vertices from the body, (n, 2), with parts drawn into it, without becoming thinner.

        Parameters
        ----------
        offsets : (n, 2)
            Offsets at rest.
        left : float
            The share of its reach by which a part stands out.
        """
        lengths = np.linalg.norm(offsets, axis=1)
        shares = quotients(np.maximum(lengths - (1.0 - left) * self.reaches, 0.0), lengths)
        return (1.0 - self.looseness * (1.0 - shares))[:, None] * offsets

    def turns(self, ratios: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return angles about the axis, (n,), by which vertices turn, so that parts stay as wide.

        Parameters
        ----------
        ratios : (n,)
            Distances from the axis at rest over those of the moved vertices.
        """
        return self.looseness * self.angles * (ratios.clip(1.0 / _MOST_TURNED, _MOST_TURNED) - 1.0)
