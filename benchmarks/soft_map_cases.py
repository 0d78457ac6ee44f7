# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases of the soft map benchmark, one per process: ``python -m benchmarks.soft_map_cases CASE OPTIONS``.

Each prints one line of JSON. A pair is made once and written to a file, which the other cases read.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import diags_array
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

from convwass_addon.applications.soft_maps.map_sides import MapSide
from convwass_addon.applications.soft_maps.map_solving import soft_map_steps
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.laplacian import laplacian
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import vertex_normals
from convwass_addon.progress import drained

from .deformed_pairs import PAIRS, DeformedPair, Geodesics, deformed_pair
from .processes import peak_megabytes, run_case

RADII = (0.01, 0.02, 0.03, 0.05, 0.1, 0.2)
"""Radii of the Princeton curve, in square roots of the target's area."""

# Thresholds for a match in robust weight transfer: a fraction of the bounds' diagonal, and an angle in degrees.
_NEAR, _TURN = 0.05, 30.0
# Vertices this far from their mirror image can be flipped; a flip is nearer to the mirror image by a margin.
_OFF_MIDDLE, _MARGIN = 0.1, 0.02


def make(name: str, file: str, path: str, vertices: int) -> dict[str, object]:
    """Make a pair and write it to a file."""
    (kind,) = (kind for kind in PAIRS if kind.name == name)
    pair = deformed_pair(kind, Path(file), vertices)
    nearest = np.linalg.norm(pair.truth[:, None] - pair.target.vertices, axis=2).min(axis=1)
    np.savez(
        path,
        source=pair.source.vertices,
        source_faces=pair.source.faces,
        target=pair.target.vertices,
        target_faces=pair.target.faces,
        truth=pair.truth,
        landmarks=pair.landmarks,
        mirrored=np.empty((0, 3)) if pair.mirrored is None else pair.mirrored,
    )
    sizes = [len(mesh.vertices) for mesh in (pair.source, pair.target)]
    return {"landmarks": kind.landmarks, "vertices": sizes, "floor": 100 * float(nearest.mean())}


def read(path: str) -> DeformedPair:
    """Read a pair from a file."""
    with np.load(path) as stored:
        data = dict(stored)
    source, target = (TriangleMesh.from_arrays(data[side], data[f"{side}_faces"]) for side in ("source", "target"))
    mirrored = data["mirrored"] if len(data["mirrored"]) else None
    return DeformedPair(Path(path).stem, source, target, data["truth"], data["landmarks"], mirrored)


def judged(pair: DeformedPair, points: NDArray[np.float64]) -> dict[str, object]:
    """Compare images of the source's vertices with the true points.

    Returns
    -------
    dict
        The mean error x 100, the percentages of matches below `RADII`, and the percentage of off-center vertices that
        are flipped (None if the shape is not symmetric).
    """
    surface = Geodesics(pair.target)
    points = surface.finder.find(points).interpolated(pair.target.corners)
    errors = surface.between(points, pair.truth)
    found = {"mean": 100 * float(errors.mean()), "curve": [100 * float((errors < r).mean()) for r in RADII]}
    if pair.mirrored is not None:
        off = surface.between(pair.mirrored, pair.truth) > _OFF_MIDDLE
        flipped = surface.between(points, pair.mirrored) < errors - _MARGIN
        found["flipped"] = 100 * float(flipped[off].mean())
    return found


def ours(path: str, landmarks: int) -> dict[str, object]:
    """Compute the soft map as the extension does, from two meshes to one point for every vertex."""
    pair = read(path)
    sides = [MapSide(pair.source, "source"), MapSide(pair.target, "target")]
    begun = time.process_time()
    found = drained(soft_map_steps(*sides, pair.landmarks[:landmarks]))
    seconds = time.process_time() - begun
    points = found.forward.positions(pair.target)
    return {**judged(pair, points), "seconds": seconds, "peak": peak_megabytes()}


def nearest(path: str) -> dict[str, object]:
    """Take nearest points, like Data Transfer, after the best rigid motion, computed from the true points."""
    pair = read(path)
    found = ClosestPointFinder(pair.target.corners).find(_aligned(pair))
    return judged(pair, found.interpolated(pair.target.corners))


def inpainted(path: str) -> dict[str, object]:
    """Take nearest points with similar normals, and fill in the others smoothly.

    This is how R. Abdrashitov, K. Raichstat, J. Monsen and D. Hill, "Robust Skin Weights Transfer via Weight
    Inpainting", SIGGRAPH Asia Technical Communications, 2023, transfer weights; here it transfers coordinates.
    """
    pair = read(path)
    aligned = _aligned(pair)
    found = ClosestPointFinder(pair.target.corners).find(aligned)
    points = found.interpolated(pair.target.corners)
    own = vertex_normals(aligned, pair.source.faces)
    other = pair.target.vertex_normals
    facing = np.einsum("nc,ncd->nd", found.shares, other[pair.target.faces[found.triangles]])
    facing /= np.linalg.norm(facing, axis=1, keepdims=True)
    reach = _NEAR * float(np.linalg.norm(np.ptp(aligned, axis=0)))
    matched = (found.distances < reach) & (np.einsum("nd,nd->n", own, facing) > np.cos(np.radians(_TURN)))
    stiffness = laplacian(pair.source)
    bending = (stiffness.matrix @ diags_array(1.0 / stiffness.areas) @ stiffness.matrix + stiffness.matrix).tocsc()
    free = np.flatnonzero(~matched)
    if len(free) and matched.any():
        points[free] = spsolve(bending[free][:, free].tocsc(), -(bending[free][:, matched] @ points[matched]))
    return judged(pair, points)


def matched(path: str, match: str) -> dict[str, object]:
    """Evaluate vertices found by another program."""
    pair = read(path)
    return judged(pair, pair.target.vertices[np.load(match)])


def _aligned(pair: DeformedPair) -> NDArray[np.float64]:
    center, goal = pair.source.vertices.mean(axis=0), pair.truth.mean(axis=0)
    turn, _ = Rotation.align_vectors(pair.truth - goal, pair.source.vertices - center)
    return turn.apply(pair.source.vertices - center) + goal


if __name__ == "__main__":
    run_case(make, ours, nearest, inpainted, matched)
