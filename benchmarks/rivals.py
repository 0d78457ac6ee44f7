# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Alternatives to transport in Blender: the same two shapes, blended by five methods.

All receive the same meshes, with centers of mass aligned, and the same cell size:

- ``fade``: linear mix of the occupancies of the cells, and the surface that encloses the interpolated volume;
- ``shrinkwrap``: the first mesh wrapped onto the second by a Shrinkwrap modifier with default settings (nearest surface
  point), kept as a shape key whose value goes from 0 to 1;
- ``sdf``: Mesh to SDF Grid of both, mixed linearly, Grid to Mesh, in Geometry Nodes (on their menus since Blender 5.0);
- ``transport``: a morph by transport alone, otherwise with default settings;
- ``automatic``: a morph at default settings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.volumes import Lattice, voxelized
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.objects import triangle_mesh, write_mesh
from convwass_addon.geometry.level_sets.isosurface import surface_enclosing
from convwass_addon.geometry.meshes.centroid import centroid
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import payloads

STEPS = 4
TIMES = tuple(step / STEPS for step in range(STEPS + 1))
"""Times of the frames, including both ends."""

# Half-width in voxels of the band with signed distances; a wider band yields the same surfaces.
_BAND = 24
# Blur of a linear mix before its surface is extracted, as for a morph.
_READING_BLUR = 0.7


@dataclass(frozen=True)
class Ends:
    """Two shapes, each with its center of mass at the origin, and the grid that all methods use.

    Attributes
    ----------
    names : (str, str)
        Names of the files.
    shapes : (TriangleMesh, TriangleMesh)
        The meshes.
    cells : int
        Along the longest side.
    lattice : Lattice
        A grid that holds both.
    """

    names: tuple[str, str]
    shapes: tuple[TriangleMesh, TriangleMesh]
    cells: int
    lattice: Lattice

    @classmethod
    def read(cls, paths: Sequence[str | Path], cells: int) -> Ends:
        """Read two meshes, smoothed by one subdivision; the grid has `cells` along its longest side."""
        bpy.ops.wm.read_factory_settings(use_empty=True)
        shapes = tuple(_smoothed(Path(path)) for path in paths)
        names = tuple(Path(path).stem for path in paths)
        return cls(names, shapes, cells, Lattice.around(shapes, cells, MorphSettings(resolution=cells).sigma))

    def occupancies(self) -> NDArray[np.float32]:
        """Return the filled fraction of every cell for each shape, (2, nx, ny, nz)."""
        shapes = enumerate(zip(self.shapes, self.names, strict=True))
        return np.stack([voxelized(shape, name, index, self.lattice, 0.0) for index, (shape, name) in shapes])


def _smoothed(path: Path) -> TriangleMesh:
    (obj,) = import_objects(path, None)
    obj.modifiers.new("Finer", "SUBSURF").levels = 1
    mesh = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())
    return mesh.moved(-centroid(mesh))


def faded(ends: Ends) -> list[TriangleMesh]:
    """Mix the occupancies linearly."""
    occupancies = ends.occupancies()
    volumes = occupancies.sum(axis=(1, 2, 3), dtype=np.float64)
    frames = []
    for t in TIMES:
        weights = np.array([1.0 - t, t])
        mixed = gaussian_filter(np.tensordot(weights.astype(np.float32), occupancies, 1), _READING_BLUR)
        surface = surface_enclosing(mixed, float(weights @ volumes))
        frames.append(ends.lattice.to_scene(surface.mesh, weights))
    return frames


def shrinkwrapped(ends: Ends) -> list[TriangleMesh]:
    """Wrap the first mesh onto the second, and keep the result as a shape key."""
    with _objects(ends) as (source, target):
        source.shape_key_add(name="Basis")
        modifier = source.modifiers.new("Wrapped", "SHRINKWRAP")
        modifier.target = target
        with bpy.context.temp_override(object=source, active_object=source):
            bpy.ops.object.modifier_apply_as_shapekey(modifier=modifier.name)
        key = source.data.shape_keys.key_blocks["Wrapped"]
        return [_at(source, key, "value", t) for t in TIMES]


def sdf_mixed(ends: Ends) -> list[TriangleMesh]:
    """Mix the signed distances linearly with Geometry Nodes.

    Raises
    ------
    RuntimeError
        Blender is older than version 5.0.
    """
    if not has_sdf_grids():
        raise RuntimeError("Geometry Nodes have no SDF grids before Blender 5.0")
    with _objects(ends) as pair:
        mixer = bpy.data.objects.new("Mixer", bpy.data.meshes.new("Mixer"))
        bpy.context.scene.collection.objects.link(mixer)
        tree = bpy.data.node_groups.new("SDF Mix", "GeometryNodeTree")
        try:
            mixer.modifiers.new("Mix", "NODES").node_group = tree
            factor = _sdf_mix(tree, pair, ends.lattice.spacing)
            # The surface of a mixed grid faces inward.
            return [_at(mixer, factor, "default_value", t).flipped() for t in TIMES]
        finally:
            mesh = mixer.data
            bpy.data.objects.remove(mixer)
            bpy.data.meshes.remove(mesh)
            bpy.data.node_groups.remove(tree)


def has_sdf_grids() -> bool:
    """Tell whether this Blender version has SDF grids in Geometry Nodes."""
    return hasattr(bpy.types, "GeometryNodeMeshToSDFGrid")


def _sdf_mix(
    tree: bpy.types.NodeTree, pair: tuple[bpy.types.Object, bpy.types.Object], voxel: float
) -> bpy.types.NodeSocket:
    """Build a node tree and return the socket of the factor."""
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    mix = tree.nodes.new("ShaderNodeMix")
    for socket, obj in zip(("A", "B"), pair, strict=True):
        info, grid = tree.nodes.new("GeometryNodeObjectInfo"), tree.nodes.new("GeometryNodeMeshToSDFGrid")
        info.inputs["Object"].default_value = obj
        grid.inputs["Voxel Size"].default_value = voxel
        grid.inputs["Band Width"].default_value = _BAND
        tree.links.new(info.outputs["Geometry"], grid.inputs["Mesh"])
        tree.links.new(grid.outputs["SDF Grid"], mix.inputs[socket])
    surface, output = tree.nodes.new("GeometryNodeGridToMesh"), tree.nodes.new("NodeGroupOutput")
    surface.inputs["Threshold"].default_value = 0.0
    tree.links.new(mix.outputs["Result"], surface.inputs["Grid"])
    tree.links.new(surface.outputs["Mesh"], output.inputs["Geometry"])
    return mix.inputs["Factor"]


def transported(ends: Ends) -> list[TriangleMesh]:
    """Morph by transport alone, otherwise with default settings."""
    return _morphed(ends, "transport")


def held_together(ends: Ends) -> list[TriangleMesh]:
    """Morph with default settings."""
    return _morphed(ends, "automatic")


def _morphed(ends: Ends, motion: str) -> list[TriangleMesh]:
    settings = MorphSettings(resolution=ends.cells, motion=motion)
    steps = morph(MorphInputs.of(ends.shapes, ends.names), path_blends(2, STEPS), settings, computation=Computation(1))
    frames = {frame.blend: frame for frame in payloads(steps, MorphFrame)}.values()
    return [ends.shapes[frame.blend.source] if frame.mesh is None else frame.mesh for frame in frames]


METHODS: dict[str, Callable[[Ends], list[TriangleMesh]]] = {
    "fade": faded,
    "shrinkwrap": shrinkwrapped,
    "sdf": sdf_mixed,
    "transport": transported,
    "automatic": held_together,
}
"""Functions that make the frames at `TIMES`, by name."""


@contextmanager
def _objects(ends: Ends) -> Iterator[tuple[bpy.types.Object, bpy.types.Object]]:
    """Add the two shapes to the scene temporarily."""
    objects = []
    for name, shape in zip(ends.names, ends.shapes, strict=True):
        mesh = bpy.data.meshes.new(name)
        write_mesh(mesh, shape)
        objects.append(bpy.data.objects.new(name, mesh))
        bpy.context.scene.collection.objects.link(objects[-1])
    try:
        yield tuple(objects)
    finally:
        for mesh in [obj.data for obj in objects]:
            bpy.data.meshes.remove(mesh)


def _at(obj: bpy.types.Object, block: object, setting: str, t: float) -> TriangleMesh:
    setattr(block, setting, t)
    return triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())
