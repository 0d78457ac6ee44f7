# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The UV map that textures are baked to."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.meshes.normals import doubled_areas, triangle_areas
from ...geometry.meshes.uv_pixels import UvPixels, uv_pixels
from ..element_values import element_values, triangle_corners, vectors_of
from ..files.scratch_scene import scratch_scene
from ..rendered_maps import render_uv_map
from ..uv_maps import add_uv_map

BAKED_UVS = "Baked"
"""Name of new UV maps."""

# Resolution at which overlaps are counted, and the share of the area that borders of islands may add.
_SIZE, _OVERLAP = 512, 0.05
# Gap between islands, as a fraction of the image.
_GAP = 0.005
# UVs may lie this far out of the image.
_SLACK = 1e-3


def baked_uv_map(mesh: bpy.types.Mesh, name: str, how: str, made: str) -> str:
    """Return the name of a UV map in which every face has its own place; unwraps the mesh if it has none.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        Without shape keys and users.
    name : str
        What messages call it.
    how : "AUTO", "OWN" or "NEW"
        With "AUTO", the UV map of renders is used if it lies in the image and does not overlap itself.
    made : str
        Name of a UV map that an earlier call has made, which another new one replaces; empty for none.

    Raises
    ------
    InputError
        There is no UV map, and `how` is "OWN"; or there are eight, and a new one is needed.
    """
    own = render_uv_map(mesh)
    if own is None and how == "OWN":
        raise InputError("{name} has no UV map; unwrap it, or choose a new UV map.", name=name)
    if own is not None and (how == "OWN" or (how == "AUTO" and _is_usable(mesh, own.name))):
        return own.name
    return _unwrapped(mesh, name, made)


def share_outside(mesh: bpy.types.Mesh, uv_map: str) -> float:
    """Return the share of the surface of a mesh that a UV map places outside of the image, as on other UDIM tiles."""
    middles = triangle_uvs(mesh, uv_map).mean(axis=1)
    areas = triangle_areas(vectors_of(mesh.vertices)[triangle_corners(mesh, "vertices")])
    outside = ((middles < 0.0) | (middles > 1.0)).any(axis=1)
    return float(areas[outside].sum() / max(areas.sum(), 1e-30))


def texture_pixels(mesh: bpy.types.Mesh, uv_map: str, size: int) -> UvPixels:
    """Rasterize a UV map without margin; see :func:`.uv_pixels.uv_pixels`."""
    return uv_pixels(triangle_uvs(mesh, uv_map), triangle_corners(mesh, "vertices"), size, 0)


def triangle_uvs(mesh: bpy.types.Mesh, uv_map: str) -> NDArray[np.float32]:
    """Return the UV coordinates at the corners of the triangles, (m, 3, 2)."""
    return loop_uvs(mesh, uv_map)[triangle_corners(mesh, "loops")]


def loop_uvs(mesh: bpy.types.Mesh, uv_map: str) -> NDArray[np.float32]:
    """Return the UV coordinates of the face corners, (l, 2)."""
    return element_values(mesh.uv_layers[uv_map].uv, "vector", 2)


def _is_usable(mesh: bpy.types.Mesh, uv_map: str) -> bool:
    """Return whether a UV map lies in the image and hardly overlaps itself."""
    uvs = triangle_uvs(mesh, uv_map).astype(np.float64)
    if uvs.min() < -_SLACK or uvs.max() > 1.0 + _SLACK:
        return False
    area = 0.5 * np.abs(doubled_areas(uvs)).sum()
    covered = len(texture_pixels(mesh, uv_map, _SIZE).places) / _SIZE**2
    return 0.0 < area <= (1.0 + _OVERLAP) * covered + 1.0 / _SIZE


def _unwrapped(mesh: bpy.types.Mesh, owner: str, before: str) -> str:
    """Add or replace a UV map with Smart UV Project; the UV map of renders remains."""
    shown = render_uv_map(mesh)
    name = "" if shown is None else shown.name
    made = mesh.uv_layers.get(before) or add_uv_map(mesh, BAKED_UVS, owner)
    made_name = made.name
    mesh.uv_layers.active = made
    for own in ("vertices", "edges", "polygons"):
        elements = getattr(mesh, own)
        elements.foreach_set("hide", np.zeros(len(elements), dtype=bool))
        elements.foreach_set("select", np.ones(len(elements), dtype=bool))
    with scratch_scene() as scene:
        obj = bpy.data.objects.new("Unwrapped", mesh)
        scene.collection.objects.link(obj)
        layer = scene.view_layers[0]
        layer.objects.active = obj
        obj.select_set(True, view_layer=layer)
        try:
            with bpy.context.temp_override(scene=scene, view_layer=layer, active_object=obj, object=obj):
                bpy.ops.object.mode_set(mode="EDIT")
                with bpy.context.temp_override(edit_object=obj, objects_in_mode_unique_data=[obj]):
                    bpy.ops.uv.smart_project(island_margin=_GAP)
                bpy.ops.object.mode_set(mode="OBJECT")
        finally:
            bpy.data.objects.remove(obj)
    if name:
        mesh.uv_layers[name].active_render = True
    return made_name
