# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Methods to mesh a level set, one per process: ``python -m benchmarks.meshing_cases CASE OPTIONS`` prints JSON."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.spatial.transform import Rotation

from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.bridge.objects import triangle_mesh, write_mesh
from convwass_addon.geometry.level_sets.even_surface import even_surface
from convwass_addon.geometry.level_sets.isosurface import LevelSurface, surface_enclosing
from convwass_addon.geometry.meshes.edges import edge_use, topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.occupancy import occupancy
from tests.shapes import ball, box, torus

from .blends import ASSETS, read_meshes
from .clock import Clock
from .coherence_measures import WORST_PERCENTILE, smallest_angles
from .processes import run_case

# Blur of a morph's density before its surface is extracted.
_BLUR = 0.7
_TURN = Rotation.from_euler("xyz", (0.4, 0.3, 0.2))
_HALF = np.array([0.5, 0.4, 0.3])
_FINE = 200_000


@dataclass(frozen=True)
class Solid:
    """A shape to mesh.

    Attributes
    ----------
    mesh : TriangleMesh
        In scene units.
    depth : callable or None
        Signed distance of points, (n, 3), to its surface, positive inside; None if unknown.
    """

    mesh: TriangleMesh
    depth: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None


def solid(name: str) -> Solid:
    """Return a ball, torus or box with known distances, or a sample shape."""
    if name == "ball":
        return Solid(ball(points=_FINE // 4), lambda points: 1.0 - np.linalg.norm(points, axis=1))
    if name == "torus":
        return Solid(torus(segments=(600, 300)), _depth_of_torus)
    if name == "turned box":
        return Solid(box(2.0 * _HALF, angles=_TURN.as_euler("xyz")), _depth_of_box)
    (shape,) = read_meshes([ASSETS / f"{name}.ply"])
    return Solid(shape)


def _depth_of_torus(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return 0.35 - np.hypot(np.hypot(points[:, 0], points[:, 1]) - 1.0, points[:, 2])


def _depth_of_box(points: NDArray[np.float64]) -> NDArray[np.float64]:
    beyond = np.abs(_TURN.inv().apply(points)) - _HALF
    return np.where((beyond > 0).any(axis=1), -np.linalg.norm(np.maximum(beyond, 0.0), axis=1), -beyond.max(axis=1))


def marching_cubes(surface: LevelSurface, density: NDArray[np.float32]) -> TriangleMesh:
    """Return the level surface unchanged."""
    return surface.mesh


def even(surface: LevelSurface, density: NDArray[np.float32]) -> TriangleMesh:
    """Mesh the surface as morphs do."""
    return even_surface(surface, density).mesh


def remeshed(adaptivity: float) -> Callable[[LevelSurface, NDArray[np.float32]], TriangleMesh]:
    """Return a function that remeshes a surface with Blender's Remesh modifier (OpenVDB) at voxels of one cell."""

    def remesh(surface: LevelSurface, density: NDArray[np.float32]) -> TriangleMesh:
        mesh = bpy.data.meshes.new("Drawn")
        write_mesh(mesh, surface.mesh)
        obj = bpy.data.objects.new("Drawn", mesh)
        bpy.context.scene.collection.objects.link(obj)
        modifier = obj.modifiers.new("Remesh", "REMESH")
        modifier.mode, modifier.voxel_size, modifier.adaptivity = "VOXEL", 1.0, adaptivity
        return triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())

    return remesh


METHODS = {
    "marching cubes": marching_cubes,
    "ours": even,
    "Remesh, voxel": remeshed(0.0),
    "Remesh, adaptivity 0.1": remeshed(0.1),
    "Remesh, adaptivity 1": remeshed(1.0),
}


def meshed(shape: str, method: str, cells: int) -> dict[str, object]:
    """Mesh a shape as a morph does, and measure the mesh."""
    whole = solid(shape)
    lattice = Lattice.around([whole.mesh], cells, 1.25)
    filled = occupancy(lattice.to_cells(whole.mesh, 0), lattice.shape)
    density = gaussian_filter(filled, _BLUR)
    volume = float(filled.sum(dtype=np.float64))
    surface = surface_enclosing(density, volume)
    clock = Clock()
    mesh = METHODS[method](surface, density)
    seconds = clock.read()["cpu"]
    sides = np.linalg.norm(mesh.corners - np.roll(mesh.corners, 1, axis=1), axis=2)
    angles = smallest_angles(mesh)
    found = topology(mesh)
    figures = {
        "triangles": len(mesh.faces),
        "angle": float(np.percentile(angles, WORST_PERCENTILE)),
        "median_angle": float(np.median(angles)),
        "edges": [float(length) for length in np.percentile(sides, (1, 50, 99))],
        "volume": mesh.volume / volume - 1.0,
        "euler": found.euler - topology(surface.mesh).euler,
        "uneven": int((edge_use(mesh.faces).count != 2).sum()),
        "cpu": seconds,
        "off": None,
        "turn": None,
    }
    if whole.depth is not None:
        placed = lattice.to_scene(mesh, np.ones(1)).vertices
        figures["off"] = float(np.abs(whole.depth(placed)).mean() / lattice.spacing)
        figures["turn"] = _turn(whole.depth, placed, mesh.vertex_normals, lattice.spacing)
    return figures


def _turn(
    depth: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    spacing: float,
) -> float:
    """Return the mean angle in degrees between normals and the true ones, where the surface is smooth."""
    step = 1e-3 * spacing
    slopes = np.stack([depth(points - step * axis) - depth(points + step * axis) for axis in np.eye(3)], axis=1)
    slopes /= np.linalg.norm(slopes, axis=1, keepdims=True)
    return float(np.degrees(np.arccos(np.clip(np.einsum("nd,nd->n", slopes, normals), -1.0, 1.0))).mean())


if __name__ == "__main__":
    run_case(meshed)
