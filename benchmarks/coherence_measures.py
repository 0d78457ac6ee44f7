# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures of the coherence and evenness of a morph's frames, comparable between motions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import bpy  # noqa: F401  mathutils is there once bpy has been imported
import numpy as np
from mathutils.bvhtree import BVHTree
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from convwass_addon.geometry.meshes.centroid import centroid
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder, TriangleSamples
from convwass_addon.geometry.meshes.mesh import TriangleMesh

from .limb_paths import LimbPath, PosedLimb
from .rival_measures import Connectivity

REACH_SHARE = 0.95
"""Fraction of the volume that defines a shape's reach."""

WORST_PERCENTILE = 1.0
"""Triangle quality is judged at this percentile of the smallest angles."""

# A step is a jump if its largest distance is more than this many times the mean distance.
_JUMP = 2.0
# A limb is searched within this angle around its direction, and up to this many times its length.
_CONE, _OVERLONG = np.radians(13.0), 1.25
# A limb may be ahead or behind by this much time and still count as having its full length.
_LAGS = np.linspace(-0.15, 0.15, 7)
# The length of a limb is known at so many evenly spaced poses between the shapes, if bodies can be sculpted in them.
_POSES = 7
# Vertices beyond this fraction of the reach form the limb's tip.
_TIP_SHARE = 0.95


@dataclass(frozen=True)
class Step:
    """Distance between the surfaces of two consecutive frames.

    Attributes
    ----------
    mean : float
        Mean distance of either surface from the other, in cells.
    largest : float
        The largest distance of a vertex of either surface from the other, in cells.
    """

    mean: float
    largest: float


@dataclass(frozen=True)
class Evenness:
    """Evenness of the surface's motion over all frames, including the two shapes.

    Attributes
    ----------
    jumps : int
        Number of steps whose largest distance is more than twice the mean distance of all steps.
    largest : float
        The largest distance of a step over the mean distance of all steps.
    at_ends : float
        Mean distance from a shape to its adjacent frame over that of the inner steps, worse end.
    """

    jumps: int
    largest: float
    at_ends: float

    @classmethod
    def of(cls, steps: Sequence[Step]) -> Evenness:
        """Compute the evenness of at least three steps."""
        largest = np.array([step.largest for step in steps])
        means = np.array([step.mean for step in steps])
        ends = float(max(means[0], means[-1]))
        return cls(
            jumps=int((largest > _JUMP * largest.mean()).sum()),
            largest=float(largest.max() / largest.mean()),
            at_ends=ends / float(means[1:-1].mean()),
        )


def steps_between(meshes: Sequence[TriangleMesh], spacing: float) -> list[Step]:
    """Measure every step between consecutive frames, in cells of size `spacing`."""
    finders = [ClosestPointFinder(mesh.corners) for mesh in meshes]
    # The vertices are not enough for means: those of a cube are all at corners, which move farthest.
    samples = [TriangleSamples.of(mesh.corners) for mesh in meshes]
    shares = [own.divided(mesh.face_areas) / mesh.area for own, mesh in zip(samples, meshes, strict=True)]
    found = []
    for i, j in pairwise(range(len(meshes))):
        ways = (i, j), (j, i)
        largest = max(finders[b].find_about(meshes[a].vertices).distances.max() for a, b in ways)
        means = [shares[a] @ finders[b].find_about(samples[a].points).distances for a, b in ways]
        found.append(Step(float(np.mean(means)) / spacing, float(largest) / spacing))
    return found


def reach(mesh: TriangleMesh) -> float:
    """Radius around the center of mass that holds 95 % of a closed mesh's volume.

    Every triangle contributes the signed cone from the center to it, which a ball truncates.
    """
    points = mesh.moved(-centroid(mesh))
    cones = points.face_volumes
    far = np.linalg.norm(points.corners.mean(axis=1), axis=1)

    def missing(radius: float) -> float:
        held = cones @ np.minimum(1.0, radius / np.maximum(far, 1e-300)) ** 3
        return float(held / cones.sum()) - REACH_SHARE

    return float(brentq(missing, 0.0, far.max(), xtol=1e-6 * far.max()))


def least_needed(values: Sequence[int]) -> int:
    """Count changes of a number along a path beyond the minimum needed to get from its first to its last value."""
    return int(np.abs(np.diff(values)).sum() - abs(values[-1] - values[0]))


def changes_of_topology(meshes: Sequence[TriangleMesh]) -> int:
    """Count changes of genus and of the number of components along a path beyond the minimum possible."""
    connectivities = [Connectivity.of(mesh) for mesh in meshes]
    return least_needed([each.handles for each in connectivities]) + least_needed(
        [len(each.shares) for each in connectivities]
    )


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
    """Return the fraction of triangles that cross another one without sharing a vertex."""
    tree = BVHTree.FromPolygons(mesh.vertices.tolist(), mesh.faces.tolist(), all_triangles=True)
    pairs = np.array(tree.overlap(tree), np.int64).reshape(-1, 2)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    shared = (mesh.faces[pairs[:, 0], :, None] == mesh.faces[pairs[:, 1], None, :]).any(axis=(1, 2))
    return len(np.unique(pairs[~shared])) / len(mesh.faces)


@dataclass(frozen=True)
class LimbErrors:
    """Errors of a limb compared with one that swings about its joints.

    Attributes
    ----------
    length : float
        Largest relative error of its length.
    tip : float
        Largest distance of its tip from the expected position, over the diagonal of the shapes' bounds.
    """

    length: float
    tip: float


def limb_errors(meshes: Sequence[TriangleMesh], times: Sequence[float], limb: LimbPath) -> LimbErrors:
    """Compare the limb in the frames with the swinging one.

    Parameters
    ----------
    meshes : sequence of TriangleMesh
        Frames. The first and the last are the shapes; they define how far the surface reaches beyond the joints.
    times : (n,)
        From 0 to 1.
    limb : LimbPath
        Its joints, in the space of the meshes.
    """
    ends = [PosedLimb(meshes[0], limb.at(0.0)), PosedLimb(meshes[-1], limb.at(1.0))]
    factors = [_factor(end.mesh, end.joints, limb.root) for end in ends]
    offsets = [
        limb_tip(end.mesh, end.joints, limb.root) - _expected(end.joints, limb.root, f)
        for end, f in zip(ends, factors, strict=True)
    ]
    diagonal = max(mesh.diagonal for mesh in (meshes[0], meshes[-1]))
    full, lengths, tips = _full_factors(limb, factors), [], []
    for mesh, t in zip(meshes, times, strict=True):
        reached = np.clip(t + _LAGS, 0.0, 1.0)
        lengths.append(min(abs(_factor(mesh, limb.at(u), limb.root) / full(u) - 1.0) for u in reached))
        joints = limb.at(t)
        tip = limb_tip(mesh, joints, limb.root)
        aside = (1.0 - t) * np.linalg.norm(offsets[0]) + t * np.linalg.norm(offsets[1])
        away = float(np.linalg.norm(tip - _expected(joints, limb.root, full(t))))
        tips.append(max(away - aside, 0.0) / diagonal)
    return LimbErrors(float(max(lengths)), float(max(tips)))


def _full_factors(limb: LimbPath, ends: Sequence[float]) -> Callable[[float], float]:
    """Return the factor of the full length at any time; it is measured on bodies sculpted in poses in between.

    Their triangles differ from those of the shapes, at which the factor is `ends`.
    """
    if limb.posed is None:
        return lambda t: (1.0 - t) * ends[0] + t * ends[1]
    times = np.linspace(0.0, 1.0, _POSES + 2)
    known = np.array([_factor(posed.mesh, posed.joints, limb.root) for posed in map(limb.posed, times)])
    known += (1.0 - times) * (ends[0] - known[0]) + times * (ends[1] - known[-1])
    return lambda t: float(np.interp(t, times, known))


def limb_tip(mesh: TriangleMesh, joints: NDArray[np.float64], root: int) -> NDArray[np.float64]:
    """Return the mean of the vertices that are farthest from a joint in the direction of the limb, (3,).

    If the surface has nothing in that direction, returns the joint itself.
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


def _factor(mesh: TriangleMesh, joints: NDArray[np.float64], root: int) -> float:
    """Return the length of a limb, over the distance of its joints."""
    reached = np.linalg.norm(limb_tip(mesh, joints, root) - joints[root])
    return float(reached / np.linalg.norm(joints[-1] - joints[root]))


def _expected(joints: NDArray[np.float64], root: int, factor: float) -> NDArray[np.float64]:
    return joints[root] + factor * (joints[-1] - joints[root])


@dataclass(frozen=True)
class Along:
    """Figures of every frame between the two shapes, relative to the interpolated figures of the shapes.

    Attributes
    ----------
    area, volume, reach : (n,) float64
        1 if equal to the interpolated figure.
    """

    area: NDArray[np.float64]
    volume: NDArray[np.float64]
    reach: NDArray[np.float64]

    @classmethod
    def of(cls, meshes: Sequence[TriangleMesh], times: ArrayLike) -> Along:
        """Measure frames; the first and the last are the shapes."""
        t = np.asarray(times, float)

        def relative(values: list[float]) -> NDArray[np.float64]:
            return (np.array(values) / ((1.0 - t) * values[0] + t * values[-1]))[1:-1]

        return cls(
            relative([mesh.area for mesh in meshes]),
            relative([mesh.volume for mesh in meshes]),
            relative([reach(mesh) for mesh in meshes]),
        )
