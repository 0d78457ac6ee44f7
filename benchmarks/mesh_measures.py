# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well one mesh takes the shape of another, and its quality on the way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from convwass_addon.geometry.arrays.weighted_quantile import weighted_quantile
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.distortion import vertex_distortions
from convwass_addon.geometry.meshes.mesh import TriangleMesh

from .coherence_measures import crossing_share

WAY = tuple(step / 16 for step in range(1, 16))
"""Slider values between the ends at which the volume is measured."""

# Self-intersections are counted at every fourth of these values.
_CROSSINGS_EVERY = 4
# A triangle with less than this fraction of its expected area counts as collapsed.
_COLLAPSED = 0.01


@dataclass(frozen=True)
class PlayedKeys:
    """Shape keys as interpolated by a slider: linearly from one to the next.

    Attributes
    ----------
    mesh : TriangleMesh
        At slider value 0.
    times : tuple of float
        Slider values of the keys, increasing to 1.
    positions : (k, n, 3) float64
        Positions of the vertices in every key.
    """

    mesh: TriangleMesh
    times: tuple[float, ...]
    positions: NDArray[np.float64]

    def at(self, t: float) -> TriangleMesh:
        """Return the mesh at a slider value from 0 to 1."""
        knots = np.array([0.0, *self.times])
        points = [self.mesh.vertices, *self.positions]
        after = int(np.clip(np.searchsorted(knots, t), 1, len(self.times)))
        share = (t - knots[after - 1]) / (knots[after] - knots[after - 1])
        return TriangleMesh((1.0 - share) * points[after - 1] + share * points[after], self.mesh.faces)


@dataclass(frozen=True)
class MeshFigures:
    """Quality of shape keys.

    Attributes
    ----------
    distance, distance_95 : float
        From the mesh in the last key to the other surface, relative to its diagonal: mean and 95th percentile over the
        area.
    uncovered : float
        Distance from the other surface to the mesh in the last key, relative to its diagonal: 95th percentile over the
        area. It shows parts that the mesh does not reach, such as a muzzle or horns.
    normals : float
        Mean angle between their normals, in degrees.
    crossing, crossing_way : float
        Fraction of triangles that cross another one, in excess of the worse of the two shapes: in the last key, and the
        maximum on the way.
    turned, collapsed : int
        Triangles of the last key that face away from the other surface, and those with less than 1 % of their area in
        the first shape, relative to the areas of the shapes.
    volume : float
        Largest error of the volume on the way, relative to the interpolated volume of the mesh at both ends.
    volume_end : float
        Error of the volume in the last key, relative to the other shape's: also of a perfect fit, because the mesh cuts
        off what its triangles are too large for.
    stretch : float
        Median over the area of the ratio of the deformation's singular values, which is the stretch of UV maps.
    keys : int
        Number of keys.
    """

    distance: float
    distance_95: float
    uncovered: float
    normals: float
    crossing: float
    crossing_way: float
    turned: int
    collapsed: int
    volume: float
    volume_end: float
    stretch: float
    keys: int

    @classmethod
    def of(cls, played: PlayedKeys, target: TriangleMesh) -> MeshFigures:
        """Measure keys that lead to `target`; both shapes face outward."""
        first, last = played.mesh, played.at(1.0)
        diagonal = target.diagonal
        finder = ClosestPointFinder(target.corners)
        found = finder.find(last.vertices)
        distances, areas = found.distances / diagonal, last.vertex_areas
        back = ClosestPointFinder(last.corners).find(target.vertices).distances
        shares = areas / areas.sum()
        there = found.interpolated(target.vertex_normals[target.faces])
        own = last.vertex_normals
        cosines = np.einsum("nd,nd->n", own, there) / np.maximum(np.linalg.norm(there, axis=1), 1e-12)
        angles = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
        allowed = max(crossing_share(first), crossing_share(target))
        return cls(
            distance=float(shares @ distances),
            distance_95=weighted_quantile(distances, areas, 0.95),
            uncovered=weighted_quantile(back / diagonal, target.vertex_areas, 0.95),
            normals=float(shares @ angles),
            crossing=max(0.0, crossing_share(last) - allowed),
            crossing_way=max(0.0, max(crossing_share(played.at(t)) for t in WAY[::_CROSSINGS_EVERY]) - allowed),
            turned=_turned(last, target, finder),
            collapsed=int((_areas(last) / last.area < _COLLAPSED * _areas(first) / first.area).sum()),
            volume=volume_error(played, last.volume),
            volume_end=abs(last.volume / target.volume - 1.0),
            stretch=median_stretch(first, last.vertices),
            keys=len(played.times),
        )


def volume_error(played: PlayedKeys, volume: float) -> float:
    """Return the largest error relative to the volume interpolated between the first mesh's and `volume`."""
    before = played.mesh.volume
    return max(abs(played.at(t).volume / ((1.0 - t) * before + t * volume) - 1.0) for t in WAY)


def median_stretch(rest: TriangleMesh, vertices: NDArray[np.float64]) -> float:
    """Return the median over the area of the ratio, at least 1, of the singular values of a deformation."""
    distortions = np.maximum(vertex_distortions(rest, vertices), 1.0)
    return weighted_quantile(distortions + np.sqrt(np.square(distortions) - 1.0), rest.vertex_areas, 0.5)


def _areas(mesh: TriangleMesh) -> NDArray[np.float64]:
    sides = mesh.corners[:, 1:] - mesh.corners[:, :1]
    return 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)


def _turned(mesh: TriangleMesh, target: TriangleMesh, finder: ClosestPointFinder) -> int:
    below = finder.find(mesh.corners.mean(axis=1)).triangles
    own, there = mesh.face_normals, target.face_normals[below]
    return int((np.einsum("nd,nd->n", own, there) < 0).sum())
