# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One pair of the benchmark of shape keys per process: ``python -m benchmarks.mesh_cases CASE OPTIONS``."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np

from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.one_mesh.key_paths import KeyDemands, key_paths
from convwass_addon.errors import ConvwassError
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.facing_points import FacingPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained

from .clock import Clock
from .coherence_pairs import pairs_named
from .mesh_measures import MeshFigures, PlayedKeys
from .processes import run_case


def keys(pair: str, error: float, keep: str | None = None) -> dict[str, object]:
    """Make the shape keys of a pair with every method; return their figures by method.

    Parameters
    ----------
    pair : str
        Name of the pair.
    error : float
        Largest distance of vertices from their path between keys, as a fraction of the diagonal.
    keep : str, optional
        A file (.npz) for the keys.
    """
    (chosen,) = pairs_named([pair], None)
    ends = chosen.ends()
    clock = Clock()
    try:
        shapes, demands = [ends.first, ends.second], KeyDemands(error)
        steps = key_paths(shapes, ["first", "second"], demands, GuidedSettings(), (), UNINTERRUPTED)
        (path,) = drained(steps)
    except ConvwassError as refusal:
        return {"error": str(refusal)}
    seconds = clock.read()
    found = {"shape keys": (PlayedKeys(ends.first, path.times, path.positions), seconds)}
    found["linear"] = (_straight(ends.first, path.positions[-1]), seconds)
    for name, wrapped in (("Shrinkwrap", shrinkwrapped), ("facing point", facing)):
        clock = Clock()
        points = wrapped(ends.first, ends.second)
        found[name] = (_straight(ends.first, points), clock.read())
    if keep is not None:
        _write(Path(keep), path.times, path.positions, ends.first, ends.second)
    figures = {name: {**asdict(MeshFigures.of(own, ends.second)), **took} for name, (own, took) in found.items()}
    return {"vertices": len(ends.first.vertices), "score": path.score, "ways": figures}


def shrinkwrapped(mesh: TriangleMesh, target: TriangleMesh) -> np.ndarray:
    """Return the nearest point of the target's surface for each vertex, (n, 3).

    Equals Blender's Shrinkwrap modifier with default settings.
    """
    return ClosestPointFinder(target.corners).find(mesh.vertices).interpolated(target.corners)


def facing(mesh: TriangleMesh, target: TriangleMesh) -> np.ndarray:
    """Return the nearest point with a similar normal for each vertex, (n, 3)."""
    normals = mesh.vertex_normals
    return FacingPointFinder(target).find(mesh.vertices, normals).interpolated(target.corners)


def _straight(mesh: TriangleMesh, points: np.ndarray) -> PlayedKeys:
    return PlayedKeys(mesh, (1.0,), points[None])


def _write(
    path: Path, times: tuple[float, ...], positions: np.ndarray, first: TriangleMesh, second: TriangleMesh
) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    meshes = {f"{kind}{i}": getattr(mesh, kind) for i, mesh in enumerate((first, second)) for kind in _ARRAYS}
    np.savez_compressed(path, times=times, positions=positions, **meshes)


_ARRAYS = ("vertices", "faces")


if __name__ == "__main__":
    run_case(keys)
