# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a baking of textures leaves on a mesh, and how the next one takes its place."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.whole_paths import share_a_place
from ..element_values import element_values, write_attribute, write_floats
from ..files.image_files import image_path
from ..handles import Handle
from ..object_names import without_number

BAKED = "convwass_baked"
"""Custom property of materials that show baked images: the UV map that was made for them, or an empty text."""

# Face attribute with the material slots from before the first baking.
_SLOTS = "convwass_slots"


def mesh_before_baking(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Copy the mesh of an object as it was before an earlier baking, undeformed and without shape keys."""
    mesh = obj.data.copy()
    holder = bpy.data.objects.new("Holder", mesh)
    positions = element_values(mesh.shape_keys.key_blocks[0].data, "co", 3)
    keys = Handle.of("shape_keys", mesh.shape_keys)
    holder.shape_key_clear()
    bpy.data.objects.remove(holder)
    left = keys.find()
    if left is not None:  # Blender 4.5
        bpy.data.batch_remove([left])
    write_floats(mesh.vertices, "co", positions)
    if _SLOTS in mesh.attributes:
        slots = element_values(mesh.attributes[_SLOTS].data, "value", kind=np.int32)
        mesh.polygons.foreach_set("material_index", slots)
    return mesh


def made_uv_map(mesh: bpy.types.Mesh) -> str:
    """Return the name of the UV map that an earlier baking has made, or an empty one."""
    names = (material[BAKED] for material in mesh.materials if material is not None and BAKED in material)
    # Earlier versions stored True.
    return next((name for name in names if isinstance(name, str) and name in mesh.uv_layers), "")


def earlier_material(mesh: bpy.types.Mesh) -> bpy.types.Material | None:
    """Return the material that an earlier baking has made, or None."""
    return next((material for material in mesh.materials if material is not None and BAKED in material), None)


def earlier_images(
    images: Sequence[bpy.types.Image], material: bpy.types.Material | None
) -> dict[bpy.types.Image, bpy.types.Image]:
    """Return which images of a material that only one mesh shows are replaced by new ones.

    Names tell, apart from their numbers; images that were renamed are kept.
    """
    if material is None or material.users > 1 or material.node_tree is None:
        return {}
    shown = (node.image for node in material.node_tree.nodes if node.type == "TEX_IMAGE" and node.image is not None)
    old = {without_number(image.name): image for image in shown}
    return {image: old[name] for image in images if (name := without_number(image.name)) in old}


def replace_data(old: bpy.types.ID, new: bpy.types.ID) -> None:
    """Let data take the name of other data and its place wherever that is used.

    The other data is not removed, since Blender might crash at undo.
    """
    old.user_remap(new)
    new.rename(old.name, mode="ALWAYS")


def reload_files(files: Sequence[Path], images: Sequence[bpy.types.Image]) -> None:
    """Let other images of some files, such as those in materials of the user, show what they contain now."""
    others = set(bpy.data.images).difference(images)
    for image in [own for own in others if own.source == "FILE" and own.packed_file is None and not own.is_dirty]:
        if share_a_place([image_path(image)], files):
            image.reload()


def assign_baked_material(
    mesh: bpy.types.Mesh, material: bpy.types.Material, uv_map: str, uvs: NDArray[np.float32]
) -> None:
    """Give all faces of a mesh a baked material, with its UV map; the material of an earlier baking is replaced."""
    if uv_map not in mesh.uv_layers:
        mesh.uv_layers.new(name=uv_map, do_init=False)
    write_floats(mesh.uv_layers[uv_map].uv, "vector", uvs)
    mesh.uv_layers.active = mesh.uv_layers[uv_map]
    if _SLOTS not in mesh.attributes:
        write_attribute(mesh, _SLOTS, "INT", element_values(mesh.polygons, "material_index", kind=np.int32), "FACE")
    earlier = earlier_material(mesh)
    if earlier is None:
        mesh.materials.append(material)
        place = len(mesh.materials) - 1
    else:
        place = mesh.materials.find(earlier.name)
        mesh.materials[place] = material
    mesh.polygons.foreach_set("material_index", np.full(len(mesh.polygons), place, np.int32))
    mesh.update()
