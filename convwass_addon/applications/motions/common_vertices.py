# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Let shapes whose vertices correspond meet in a blend, at the volume between theirs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ..registrations.carriers import Carrier

# Shapes are scaled by at most this factor to keep their volume. They enclose one if the sum of their oriented areas is
# at most the second number of their area: zero for closed surfaces, and one for a flat sheet.
_MOST_SCALED, _OPEN = 1.1, 0.1


@dataclass(frozen=True)
class VersionOfMesh:
    """A shape whose vertices correspond to those of others, and the further points that motions move with them.

    Attributes
    ----------
    count : int
        Number of its vertices.
    faces : (m, 3) int64
        Its triangles.
    length : float
        Cube root of its volume; zero if it does not enclose one.
    corners : (k, 3) int64
        The corners of the triangle that each of the further points lies on.
    shares : (k, 3) float64
        Their barycentric coordinates.
    """

    count: int
    faces: NDArray[np.int64]
    length: float
    corners: NDArray[np.int64]
    shares: NDArray[np.float64]

    @classmethod
    def of(cls, carrier: Carrier, shape: TriangleMesh) -> VersionOfMesh:
        """Return a shape with the further points of its carrier."""
        count, found = len(shape.vertices), carrier.embedding(shape)
        corners, shares = shape.faces[found.triangles[count:]], found.shares[count:]
        return cls(count, shape.faces, _length(shape), corners, shares)

    def posed(self, shape: TriangleMesh) -> VersionOfMesh:
        """Return another pose of the shape: its volume may be another one."""
        return replace(self, length=_length(shape))

    def moved_by(self, gaps: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return by how much its vertices and the further points move if its vertices move by gaps, (count, 3)."""
        return np.concatenate([gaps, np.einsum("nk,nkj->nj", self.shares, gaps[self.corners])])

    def sized(self, points: NDArray[np.float64], length: float) -> NDArray[np.float64]:
        """Return positions of the vertices, scaled about their center to a volume, given by its cube root."""
        mesh = TriangleMesh(points, self.faces)
        if not min(length, mesh.volume) > 0.0:
            return points
        scale = np.clip(length / np.cbrt(mesh.volume), 1.0 / _MOST_SCALED, _MOST_SCALED)
        center = mesh.area_center
        return center + scale * (points - center)


def versions_of_mesh(carriers: Sequence[Carrier], shapes: Sequence[TriangleMesh]) -> tuple[VersionOfMesh, ...]:
    """Return shapes whose vertices correspond in all pairs that are blended."""
    return tuple(VersionOfMesh.of(*both) for both in zip(carriers, shapes, strict=True))


def met(
    versions: Sequence[VersionOfMesh],
    moved: Mapping[int, NDArray[np.float64]],
    weights: NDArray[np.float64],
    way: float,
) -> dict[int, NDArray[np.float64]]:
    """Move shapes to their weighted mean, scaled so that it has the mean size of the shapes.

    Each shape alone would come to slightly different places in a blend, above all where skinning has collapsed joints.
    Means of stretches have too much volume where parts shear, as in a twist. Without the scaling, the solid would be
    made thinner, and lose ears and fins.

    Parameters
    ----------
    versions : sequence of VersionOfMesh
        All shapes.
    moved : mapping of int to (n, 3)
        By index, the points of those in a blend: first their vertices, then the further points.
    weights : (k,)
        Weights of these shapes, of sum one.
    way : float
        Fraction of the way to the mean, 0 to 1.
    """
    own = [versions[shape] for shape in moved]
    count, lengths = own[0].count, np.array([version.length for version in own])
    mean = sum(weight * points[:count] for weight, points in zip(weights, moved.values(), strict=True))
    mean = own[0].sized(mean, float(weights @ lengths) if lengths.all() else 0.0)
    return {
        shape: points + version.moved_by(way * (mean - points[:count]))
        for version, (shape, points) in zip(own, moved.items(), strict=True)
    }


def _length(mesh: TriangleMesh) -> float:
    """Return the cube root of the volume that a surface encloses, apart from small openings, or zero.

    Oriented areas of a closed surface add up to zero.
    """
    total = mesh.face_areas @ mesh.face_normals
    is_closed = np.linalg.norm(total) <= _OPEN * mesh.area and mesh.volume > 0.0
    return float(np.cbrt(mesh.volume)) if is_closed else 0.0
