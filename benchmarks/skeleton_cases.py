# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Skeletons in bodies, one case per process: ``python -m benchmarks.skeleton_cases CASE OPTIONS``.

A case prints one line of JSON. It needs Blender to read meshes.
"""

from __future__ import annotations

import json
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.skeletons.skeleton_bodies import SkeletonBody, skeleton_body
from convwass_addon.applications.skeletons.skeleton_fit import FittedSkeleton, fit_steps
from convwass_addon.applications.skeletons.skeleton_graph import JointGraph
from convwass_addon.applications.skeletons.skeleton_layout import LayoutProblem
from convwass_addon.applications.skeletons.skeleton_links import chains
from convwass_addon.applications.skeletons.skeleton_settings import SkeletonSettings
from convwass_addon.applications.skeletons.skeleton_settling import settled
from convwass_addon.geometry.meshes.edges import vertex_components
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.inner_balls import inner_balls
from convwass_addon.geometry.solids.solid_angles import winding_numbers
from convwass_addon.progress import drained

from .meshes import blob
from .processes import run_case

_SKELETONS = Path(__file__).parent / "skeletons.json"
# Bones are longer or shorter than by hand by up to this fraction.
_DISTURBANCE = 0.4


def fit(path: str, name: str) -> dict[str, object]:
    """Fit the skeleton of one body by several methods."""
    placed = _skeleton(name)
    mesh = _piece(_read(Path(path)), placed.positions)
    graph = _disturbed(placed)
    start = time.process_time()
    ours = _fitted(mesh, graph, SkeletonSettings())
    seconds = time.process_time() - start
    body = skeleton_body(mesh, placed.positions[placed.pinned], placed.names)
    lengths = graph.lengths
    harmonic = _harmonic(graph, lengths)
    ways = {
        "fit": ours.positions,
        "even": _fitted(mesh, graph, SkeletonSettings(weights="uniform")).positions,
        "means": _means(mesh, graph),
        "harmonic": harmonic,
        "settled": settled(graph, harmonic, lengths, inner_balls(body.surface), body.inside),
        "straight": _straight(graph, lengths),
    }
    scores = {way: _score(placed, positions, body) for way, positions in ways.items()}
    pins = int(placed.pinned.sum())
    return {"joints": len(placed.names), "pins": pins, "seconds": seconds, "record": ours.record, **scores}


def large(vertices: int, joints: int) -> dict[str, object]:
    """Fit a star with five limbs to a bumpy shape."""
    mesh = TriangleMesh.from_arrays(*blob(vertices))
    limbs = 5
    count = (joints - 1) // limbs
    tips = mesh.vertices[np.linspace(0, len(mesh.vertices) - 1, limbs).astype(int)] * 0.85
    positions = [np.zeros(3), *(t * tip for tip in tips for t in np.arange(1, count + 1) / count)]
    edges = [(0 if i % count == 0 else i, i + 1) for i in range(limbs * count)]
    pinned = [i > 0 and i % count == 0 for i in range(limbs * count + 1)]
    start = time.process_time()
    found = _fitted(mesh, JointGraph.from_arrays(positions, edges, pinned), SkeletonSettings())
    seconds = time.process_time() - start
    inside = 100.0 * float(found.inside.mean())
    return {"vertices": vertices, "joints": len(positions), "seconds": seconds, "inside": inside}


def _fitted(mesh: TriangleMesh, graph: JointGraph, settings: SkeletonSettings) -> FittedSkeleton:
    return drained(fit_steps(mesh, graph, settings))


def _means(mesh: TriangleMesh, graph: JointGraph) -> NDArray[np.float64]:
    """Return joints at the means of their distributions, without moving any inside."""
    settings = SkeletonSettings(placement="expected")
    body = skeleton_body(mesh, graph.positions[graph.pinned], graph.names)
    return LayoutProblem(graph, body, settings).solved(settings.gamma).positions


def _harmonic(graph: JointGraph, lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return free joints at the means of their neighbors, weighted by the inverse bone lengths."""
    count = len(graph.positions)
    matrix = np.zeros((count, count))
    for (tail, head), length in zip(graph.edges, lengths, strict=True):
        matrix[[tail, head], [head, tail]] -= 1.0 / length
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    free, pins = ~graph.pinned, graph.pinned
    positions = graph.positions.copy()
    positions[free] = np.linalg.solve(matrix[np.ix_(free, free)], -matrix[np.ix_(free, pins)] @ positions[pins])
    return positions


def _straight(graph: JointGraph, lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return joints along straight lines, with branching joints at the mean of all pins."""
    positions = np.where(graph.pinned[:, None], graph.positions, graph.positions[graph.pinned].mean(axis=0))
    bones = {tuple(edge): length for edge, length in zip(graph.edges.tolist(), lengths, strict=True)}
    for chain in chains(graph):
        gone = np.cumsum([bones[min(a, b), max(a, b)] for a, b in pairwise(chain.tolist())])
        shares = (gone[:-1] / gone[-1])[:, None]
        positions[chain[1:-1]] = (1.0 - shares) * positions[chain[0]] + shares * positions[chain[-1]]
    return positions


def _score(placed: JointGraph, positions: NDArray[np.float64], body: SkeletonBody) -> dict[str, float]:
    free = ~placed.pinned
    errors = np.linalg.norm(positions - placed.positions, axis=1)[free] / body.surface.diagonal
    inside = body.inside.contains(positions[free])
    return {"inside": 100.0 * float(inside.mean()), "error": 100.0 * float(errors.mean())}


def _skeleton(name: str) -> JointGraph:
    """Read joints placed by hand, or for our own shapes along the curves that they were sculpted around."""
    found = json.loads(_SKELETONS.read_text(encoding="utf-8"))[name]
    names = list(found["joints"])
    bones = [[names.index(joint) for joint in bone] for bone in found["bones"]]
    pinned = [joint in found["pinned"] for joint in names]
    return JointGraph.from_arrays(list(found["joints"].values()), bones, pinned, tuple(names))


def _disturbed(graph: JointGraph) -> JointGraph:
    """Return the skeleton in a rest shape with longer and shorter bones, scaled one by one from its first joint."""
    factors = np.random.default_rng(0).uniform(1.0 - _DISTURBANCE, 1.0 + _DISTURBANCE, len(graph.positions))
    rest, known, waiting = graph.rest.copy(), {0}, [0]
    while waiting:
        joint = waiting.pop()
        for other in graph.neighbors[joint]:
            if other not in known:
                rest[other] = rest[joint] + factors[other] * (graph.rest[other] - graph.rest[joint])
                known.add(other)
                waiting.append(other)
    return replace(graph, rest=rest)


def _piece(mesh: TriangleMesh, joints: NDArray[np.float64]) -> TriangleMesh:
    """Return the connected component of a mesh that contains the joints."""
    labels = vertex_components(mesh)[mesh.faces[:, 0]]
    pieces = [TriangleMesh(mesh.vertices, mesh.faces[labels == label]) for label in range(labels.max() + 1)]
    return max(pieces, key=lambda piece: float(winding_numbers(joints, piece).sum()))


def _read(path: Path) -> TriangleMesh:
    import bpy

    from convwass_addon.bridge.files.imports import import_objects
    from convwass_addon.bridge.surfaces import surface_mesh

    bpy.ops.wm.read_factory_settings(use_empty=True)
    (obj,) = import_objects(path, None)
    mesh = surface_mesh(obj, bpy.context.evaluated_depsgraph_get())
    if path.suffix == ".obj":
        # In the file, y points up.
        x, y, z = mesh.vertices.T
        return TriangleMesh(np.stack([x, z, -y], axis=1), mesh.faces)
    return mesh


if __name__ == "__main__":
    run_case(fit, large)
