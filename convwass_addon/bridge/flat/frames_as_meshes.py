# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Replace the curves and texts of a flat morph by meshes, for outputs that require meshes."""

from __future__ import annotations

from dataclasses import replace

import bpy

from ...errors import InputError
from ..morphs.bake import assign_default_material
from ..morphs.stand_ins import stand_ins
from ..morphs.stored import frame_objects, store, stored_morph
from ..objects import evaluated_mesh, take_parent
from ..unused_data import remove_if_unused
from .flat_paint import paint_mesh, region_colors


def turn_into_meshes(collection: bpy.types.Collection) -> None:
    """Replace the frames of a morph that are not meshes by their meshes.

    Names, transforms, materials, constraints and all animation are kept, and what refers to a frame refers to its mesh.
    Does nothing if a player or pad shows the morph.

    Parameters
    ----------
    collection : bpy.types.Collection
        A flat or solid morph.

    Raises
    ------
    InputError
        As for `require_no_drawings` and :func:`.stored.stored_morph`; nothing is changed then.
    """
    curves = [obj for obj in frame_objects(collection) if obj.type != "MESH"]
    if not curves or stand_ins(collection):
        return
    require_no_drawings(collection)
    morph = stored_morph(collection)
    meshes = _meshes_of(curves)
    others = [_standing_for(obj, mesh) for obj, mesh in zip(curves, meshes, strict=True)]
    names, data = [obj.name for obj in curves], {obj.data for obj in curves}
    for obj, other in zip(curves, others, strict=True):
        # This also puts it into the collections.
        obj.user_remap(other)
    bpy.data.batch_remove(curves)
    remove_if_unused(data)
    for obj, name in zip(others, names, strict=True):
        obj.name = name
    store(collection, replace(morph, settings={**morph.settings, "flat_output": "MESH"}))


def require_no_drawings(collection: bpy.types.Collection) -> None:
    """Check that a morph has no drawings, which cannot be converted to meshes.

    Raises
    ------
    InputError
        A frame is a drawing.
    """
    if any(obj.type not in ("MESH", "FONT", "CURVE") for obj in frame_objects(collection)):
        raise InputError("{name} consists of drawings; bake it again with meshes as flat frames.", name=collection.name)


def _meshes_of(frames: list[bpy.types.Object]) -> list[bpy.types.Mesh]:
    """Return the filled meshes of curve and text objects, even if they are hidden by keys."""
    copies = []
    for obj in frames:
        if obj.data.dimensions == "2D" and obj.data.fill_mode == "NONE":
            obj.data.fill_mode = "BOTH"
        copy = obj.copy()
        copy.animation_data_clear()
        copy.hide_viewport = False
        bpy.context.scene.collection.objects.link(copy)
        copies.append(copy)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    meshes = []
    for obj, copy in zip(frames, copies, strict=True):
        meshes.append(mesh_of_frame(obj, copy.evaluated_get(depsgraph), depsgraph))
        meshes[-1].name = obj.name
    bpy.data.batch_remove(copies)
    return meshes


def mesh_of_frame(obj: bpy.types.Object, evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bpy.types.Mesh:
    """Return a new mesh of what a frame object shows, which may be a curve or a text, with its colors."""
    mesh = evaluated_mesh(evaluated, depsgraph)
    if obj.type != "MESH":
        colors = region_colors(obj)
        if colors:
            paint_mesh(mesh, colors)
        assign_default_material(mesh)
    return mesh


def _standing_for(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> bpy.types.Object:
    """Make a mesh object with the parent, transform, animation, constraints and properties of another object."""
    other = bpy.data.objects.new(obj.name, mesh)
    take_parent(obj, other)
    other.rotation_mode, other.matrix_basis, other.color = obj.rotation_mode, obj.matrix_basis, obj.color
    for key, value in obj.items():
        other[key] = value
    for constraint in obj.constraints:
        other.constraints.copy(constraint)
    other.hide_render, other.hide_viewport = obj.hide_render, obj.hide_viewport
    if obj.animation_data is not None:
        _take_animation(obj, other)
    return other


def _take_animation(obj: bpy.types.Object, other: bpy.types.Object) -> None:
    """Give an object the keys, NLA tracks and drivers of one that is removed."""
    # The operator, the only way to copy NLA tracks completely, refuses hidden objects and skips those of other scenes.
    obj.hide_viewport = False
    linked = bpy.context.scene.collection.objects
    linked.link(other)
    with bpy.context.temp_override(active_object=obj, object=obj, selected_editable_objects=[other]):
        bpy.ops.object.make_links_data(type="ANIMATION")
    linked.unlink(other)
    # It copies the animation of the data, too, which fits only curves.
    other.data.animation_data_clear()
