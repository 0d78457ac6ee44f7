# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The material of morph frames, and the colors it mixes."""

from __future__ import annotations

import bpy

MATERIAL_NAME = "Convwass Morph"

ROUGHNESS = 0.45


def morph_material() -> bpy.types.Material:
    """Return the material that all morph frames share; made if the file has none.

    Its base color is the color of the object that wears it (Object Properties > Viewport Display > Color).
    """
    material = bpy.data.materials.get(MATERIAL_NAME)
    if material is None:
        material = bpy.data.materials.new(MATERIAL_NAME)
        _wire(material)
    return material


def input_color(obj: bpy.types.Object) -> tuple[float, float, float, float]:
    """Return the color that stands for an object: RGBA, scene linear.

    That is the base color of its first material, or the material's viewport color where a texture gives the base color;
    for an object without a material, and for a morph frame, the object's own color.
    """
    material = next((slot.material for slot in obj.material_slots if slot.material), None)
    if material is None:
        return tuple(obj.color)
    base = _base_color(material)
    if base is None:
        return tuple(material.diffuse_color)
    if not base.is_linked:
        return tuple(base.default_value)
    return tuple(obj.color if base.links[0].from_node.type == "OBJECT_INFO" else material.diffuse_color)


def plain_copy(material: bpy.types.Material, color: tuple[float, float, float, float]) -> bpy.types.Material:
    """Return a copy of a morph material whose base color is `color` itself, for files that know no object colors."""
    copy = material.copy()
    base = _base_color(copy)
    for link in list(base.links):
        copy.node_tree.links.remove(link)
    base.default_value = color
    copy.diffuse_color = color
    return copy


def wears_object_color(material: bpy.types.Material | None) -> bool:
    """Tell whether a material takes its base color from the object."""
    base = _base_color(material) if material else None
    return base is not None and base.is_linked and base.links[0].from_node.type == "OBJECT_INFO"


def _base_color(material: bpy.types.Material) -> bpy.types.NodeSocket | None:
    """Return the base color of the first Principled BSDF."""
    nodes = material.node_tree.nodes if material.node_tree else ()
    principled = next((node for node in nodes if node.type == "BSDF_PRINCIPLED"), None)
    return principled.inputs["Base Color"] if principled else None


def _wire(material: bpy.types.Material) -> None:
    """Let the object's color be the base color."""
    if material.node_tree is None:  # Blender 4.5; later ones come with nodes and warn of this property
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
    source = tree.nodes.new("ShaderNodeObjectInfo")
    principled.inputs["Roughness"].default_value = ROUGHNESS
    principled.location, source.location = (-300.0, 0.0), (-500.0, 0.0)
    tree.links.new(source.outputs["Color"], principled.inputs["Base Color"])
    tree.links.new(principled.outputs["BSDF"], output.inputs["Surface"])
