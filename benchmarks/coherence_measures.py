# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the frames of a morph hold together and run evenly, in numbers that mean the same for every motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import bpy  # noqa: F401  mathutils is there once bpy has been imported
import numpy as np
from mathutils.bvhtree import BVHTree
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from convwass_addon.geometry.centroid import centroid
from convwass_addon.geometry.closest_points import ClosestPointFinder
from convwass_addon.geometry.mesh import TriangleMesh

from .coherence_pairs import LimbPath
from .rival_measures import Hold

REACH_SHARE = 0.95
"""Share of the volume that a shape's reach holds."""

WORST_PERCENTILE = 1.0
"""Triangles with a lower corner in this percentile are the worst."""

# A step that has a point moving more than so many times the mean is a jump.
_JUMP = 2.0
# A limb is looked for within this angle about its direction, and no farther than so many times its length.
_CONE, _OVERLONG = np.radians(13.0), 1.25
# A limb may be ahead of its time or behind it by so much without being taken for shorter.
_LAGS = np.linspace(-0.15, 0.15, 7)
# Vertices beyond this share of the reach are the limb's tip.
_TIP_SHARE = 0.95


@dataclass(frozen=True)
class Step:
    """How far the surface is from one frame to the next.

    Attributes
    ----------
    mean, largest : float
        Distance of the vertices of either surface to the other one, weighted by area, in cells.
    """

    mean: float
    largest: float


@dataclass(frozen=True)
class Evenness:
    """How evenly the surface moves over all frames, the two shapes included.

    Attributes
    ----------
    jumps : int
        Steps whose largest distance is more than twice the mean of all.
    largest : float
        The largest distance of a step, over the mean of all steps.
    at_ends : float
        Mean distance from a shape to the frame beside it over that of the steps inside, the worse end.
    """

    jumps: int
    largest: float
    at_ends: float

    @classmethod
    def of(cls, steps: Sequence[Step]) -> Evenness:
        """Judge steps, at least three."""
        largest = np.array([step.largest for step in steps])
        means = np.array([step.mean for step in steps])
        ends = float(max(means[0], means[-1]))
        return cls(
            jumps=int((largest > _JUMP * largest.mean()).sum()),
            largest=float(largest.max() / largest.mean()),
            at_ends=ends / float(means[1:-1].mean()),
        )


def steps_between(meshes: Sequence[TriangleMesh], spacing: float) -> list[Step]:
    """Measure every step from a frame to the next, in cells of size `spacing`."""
    finders = [ClosestPointFinder(mesh.corners) for mesh in meshes]
    found = []
    for i, j in pairwise(range(len(meshes))):
        there, back = (finders[b].find_about(meshes[a].vertices).distances for a, b in ((i, j), (j, i)))
        areas = [meshes[k].vertex_areas for k in (i, j)]
        means = [far @ area / area.sum() for far, area in zip((there, back), areas, strict=True)]
        largest = max(there.max(), back.max())
        found.append(Step(float(np.mean(means)) / spacing, float(largest) / spacing))
    return found


def reach(mesh: TriangleMesh) -> float:
    """Radius about the center of mass that holds 95 % of a closed mesh's volume.

    Every triangle stands for the cone from the center to it, of which a ball cuts off what lies beyond.
    """
    points = mesh.moved(-centroid(mesh))
    cones = points.face_volumes
    far = np.linalg.norm(points.corners.mean(axis=1), axis=1)

    def missing(radius: float) -> float:
        held = cones @ np.minimum(1.0, radius / np.maximum(far, 1e-300)) ** 3
        return float(held / cones.sum()) - REACH_SHARE

    return float(brentq(missing, 0.0, far.max(), xtol=1e-6 * far.max()))


def least_needed(values: Sequence[int]) -> int:
    """Count changes of a number along a path beyond those that lead from its first to its last value directly."""
    return int(np.abs(np.diff(values)).sum() - abs(values[-1] - values[0]))


def changes_of_topology(meshes: Sequence[TriangleMesh]) -> int:
    """Count changes of genus and of the number of pieces along a path beyond the least possible."""
    holds = [Hold.of(mesh) for mesh in meshes]
    return least_needed([hold.handles for hold in holds]) + least_needed([len(hold.shares) for hold in holds])


def worst_angle(mesh: TriangleMesh) -> float:
    """Return the first percentile of the smallest angles of the triangles, in degrees."""
    return float(np.percentile(smallest_angles(mesh), WORST_PERCENTILE))


def smallest_angles(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return the smallest angle of every triangle, (m,), in degrees."""
    sides = np.roll(mesh.corners, -1, axis=1) - mesh.corners
    lengths = np.maximum(np.linalg.norm(sides, axis=2, keepdims=True), 1e-300)
    units = sides / lengths
    cosines = -np.einsum("fcd,fcd->fc", units, np.roll(units, 1, axis=1))
    return np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0))).min(axis=1)


def crossing_share(mesh: TriangleMesh) -> float:
    """Return the share of triangles that cross another one with which they share no vertex."""
    tree = BVHTree.FromPolygons(mesh.vertices.tolist(), mesh.faces.tolist(), all_triangles=True)
    pairs = np.array(tree.overlap(tree), np.int64).reshape(-1, 2)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    shared = (mesh.faces[pairs[:, 0], :, None] == mesh.faces[pairs[:, 1], None, :]).any(axis=(1, 2))
    return len(np.unique(pairs[~shared])) / len(mesh.faces)


@dataclass(frozen=True)
class LimbErrors:
    """A limb beside the one that swings about its joints.

    Attributes
    ----------
    length : float
        Largest error of its length relative to the length it should have.
    tip : float
        Largest distance of its tip from where it should be, over the diagonal of the shapes' bounds.
    """

    length: float
    tip: float


def limb_errors(meshes: Sequence[TriangleMesh], times: Sequence[float], limb: LimbPath) -> LimbErrors:
    """Compare the limb of frames with the swinging one.

    Parameters
    ----------
    meshes : sequence of TriangleMesh
        Frames, the first and the last of which are the shapes: there the surface reaches as far beyond the joints as
        it should.
    times : (n,)
        From 0 to 1.
    limb : LimbPath
        Its joints, in the space of the meshes.
    """
    ends = [limb_tip(mesh, limb.at(t), limb.root) for mesh, t in ((meshes[0], 0.0), (meshes[-1], 1.0))]
    factors = [
        _length(tip, limb.at(t), limb.root) / _chord(limb.at(t), limb.root) for tip, t in zip(ends, (0, 1), strict=True)
    ]
    offsets = [tip - _expected(limb.at(t), limb.root, f) for tip, t, f in zip(ends, (0, 1), factors, strict=True)]
    diagonal = max(float(np.linalg.norm(np.ptp(mesh.bounds, axis=0))) for mesh in (meshes[0], meshes[-1]))
    lengths, tips = [], []
    for mesh, t in zip(meshes, times, strict=True):
        factor = (1.0 - t) * factors[0] + t * factors[1]
        lengths.append(min(_length_error(mesh, limb, u, factor) for u in np.clip(t + _LAGS, 0.0, 1.0)))
        joints = limb.at(t)
        tip = limb_tip(mesh, joints, limb.root)
        aside = (1.0 - t) * np.linalg.norm(offsets[0]) + t * np.linalg.norm(offsets[1])
        away = float(np.linalg.norm(tip - _expected(joints, limb.root, factor)))
        tips.append(max(away - aside, 0.0) / diagonal)
    return LimbErrors(float(max(lengths)), float(max(tips)))


def limb_tip(mesh: TriangleMesh, joints: NDArray[np.float64], root: int) -> NDArray[np.float64]:
    """Return the middle of the vertices that are farthest from a joint in the direction of the limb, (3,).

    Where the surface has nothing in that direction, the joint itself.
    """
    start, limb = joints[root], joints[-1] - joints[root]
    length = np.linalg.norm(limb)
    offsets = mesh.vertices - start
    far = np.linalg.norm(offsets, axis=1)
    in_cone = (offsets @ limb > np.cos(_CONE) * far * length) & (far < _OVERLONG * length)
    if not in_cone.any():
        return start
    farthest = far[in_cone].max()
    at_tip = in_cone & (far >= _TIP_SHARE * farthest)
    return np.average(mesh.vertices[at_tip], axis=0, weights=np.maximum(mesh.vertex_areas[at_tip], 1e-300))


def _length_error(mesh: TriangleMesh, limb: LimbPath, t: float, factor: float) -> float:
    joints = limb.at(t)
    return abs(
        _length(limb_tip(mesh, joints, limb.root), joints, limb.root) / (factor * _chord(joints, limb.root)) - 1.0
    )


def _chord(joints: NDArray[np.float64], root: int) -> float:
    return float(np.linalg.norm(joints[-1] - joints[root]))


def _length(tip: NDArray[np.float64], joints: NDArray[np.float64], root: int) -> float:
    return float(np.linalg.norm(tip - joints[root]))


def _expected(joints: NDArray[np.float64], root: int, factor: float) -> NDArray[np.float64]:
    return joints[root] + factor * (joints[-1] - joints[root])


@dataclass(frozen=True)
class Along:
    """Figures of every frame between the two shapes, relative to what these have, interpolated.

    Attributes
    ----------
    area, volume, reach : (n,) float64
        1 where a frame has as much.
    """

    area: NDArray[np.float64]
    volume: NDArray[np.float64]
    reach: NDArray[np.float64]

    @classmethod
    def of(cls, meshes: Sequence[TriangleMesh], times: ArrayLike) -> Along:
        """Measure frames, the first and the last of which are the shapes."""
        t = np.asarray(times, float)

        def relative(values: list[float]) -> NDArray[np.float64]:
            return (np.array(values) / ((1.0 - t) * values[0] + t * values[-1]))[1:-1]

        return cls(
            relative([mesh.area for mesh in meshes]),
            relative([mesh.volume for mesh in meshes]),
            relative([reach(mesh) for mesh in meshes]),
        )
