# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of morph frames, and colors of materials."""

from __future__ import annotations

import bpy

from ...nodes.node_math import new_node
from ...nodes.node_trees import own_tree
from ...nodes.shown_nodes import linked_output, shown_output, shown_tree

MATERIAL_NAME = "Convwass Morph"

_CARRIES_KEY = "convwass_carries"
"""Custom property of a material that belongs to the frames of one morph."""

ROUGHNESS = 0.45

# Inputs of shaders for their color.
_COLOR_INPUTS = ("Base Color", "Color")


def morph_material() -> bpy.types.Material:
    """Return the default material of morph frames; created if missing.

    Its base color is the color of the object (Object Properties > Viewport Display > Color).
    """
    return _found_or_wired(MATERIAL_NAME, "ShaderNodeObjectInfo")


def see_through_material(name: str) -> bpy.types.Material:
    """Return the material whose base color and alpha are the color of the object; created if missing."""
    return _found_or_wired(name, "ShaderNodeObjectInfo", is_see_through=True)


def input_color(obj: bpy.types.Object) -> tuple[float, float, float, float]:
    """Return the representative color of an object as scene linear RGBA.

    This is the color of its first material; without a material, the object's color.
    """
    material = next((slot.material for slot in obj.material_slots if slot.material), None)
    return tuple(obj.color) if material is None else material_color(material, obj)


def material_color(material: bpy.types.Material, obj: bpy.types.Object) -> tuple[float, float, float, float]:
    """Return the representative color of a material of an object as scene linear RGBA.

    This is the color of the shader that it shows, which may come from an *RGB* node; for morph frames, the object's
    color. It is the material's viewport color if other nodes give the color, or if the shader has none.
    """
    color = _shown_color(material)
    if color is None or has_color_of_nodes(material):
        return tuple(material.diffuse_color)
    source = linked_output(color)
    if source is None:
        return tuple(color.default_value)
    return tuple(source.default_value if source.node.type == "RGB" else obj.color)


def has_color_of_nodes(material: bpy.types.Material) -> bool:
    """Return whether the color of a material comes from textures or other nodes without a single color."""
    color = _shown_color(material)
    source = linked_output(color) if color is not None else None
    if source is None:
        return False
    return source.node.mute or not (is_object_color(source) or source.node.type == "RGB")


def is_object_color(source: bpy.types.NodeSocket) -> bool:
    """Return whether an output is the color of the object, not another one of *Object Info*."""
    return source.node.type == "OBJECT_INFO" and source.name == "Color"


def material_opacity(material: bpy.types.Material, obj: bpy.types.Object) -> float:
    """Return the representative opacity of a material of an object.

    This is the *Alpha* of the Principled BSDF that it shows, or that of the object's color if it is linked; without any
    shader, that of the viewport color. Other shaders and links count as opaque.
    """
    shader = _shown_shader(material)
    if shader is None:
        return float(material.diffuse_color[3])
    if shader.type != "BSDF_PRINCIPLED":
        return 1.0
    source = linked_output(shader.inputs["Alpha"])
    if source is None:
        return float(shader.inputs["Alpha"].default_value)
    is_of_object = source.node.type == "OBJECT_INFO" and source.name == "Alpha"
    return float(obj.color[3]) if is_of_object else 1.0


def _shown_color(material: bpy.types.Material) -> bpy.types.NodeSocket | None:
    """Return the color input of the shader that a material shows, else that of a Principled BSDF, or None."""
    shader = _shown_shader(material)
    if shader is not None and shader.type != "GROUP":
        found = [shader.inputs[name] for name in _COLOR_INPUTS if name in shader.inputs]
        if found:
            return found[0]
    return base_color(material) if shown_tree(material) is not None else None


def _shown_shader(material: bpy.types.Material) -> bpy.types.Node | None:
    """Return the node that is linked to the surface of the shown output, or None."""
    tree = shown_tree(material)
    output = shown_output(tree) if tree is not None else None
    surface = linked_output(output.inputs["Surface"]) if output is not None else None
    return surface.node if surface is not None else None


def plain_copy(material: bpy.types.Material, color: tuple[float, float, float, float]) -> bpy.types.Material:
    """Return a copy of a morph material with a constant color and opacity, for file formats without object colors.

    A linked color attribute is kept, for programs that support it. Whole materials of the inputs are left out.
    """
    copy = material.copy()
    base = base_color(copy)
    output = copy.node_tree.get_output_node("ALL")
    if is_carrying(copy) and output is not None:
        copy.node_tree.links.new(base.node.outputs[0], output.inputs["Surface"])
        for node in [node for node in copy.node_tree.nodes if node.type == "GROUP"]:
            copy.node_tree.nodes.remove(node)
    for link in list(base.links):
        if link.from_node.type == "OBJECT_INFO":
            copy.node_tree.links.remove(link)
    alpha = base.node.inputs["Alpha"]
    for link in [link for link in alpha.links if link.from_node.type == "OBJECT_INFO"]:
        copy.node_tree.links.remove(link)
        alpha.default_value = color[3]
    base.default_value = color
    copy.diffuse_color = color
    return copy


def shows_object_color(material: bpy.types.Material | None) -> bool:
    """Return whether a material reads its base color from the object."""
    return _color_source(material) == "OBJECT_INFO"


def shows_color_attribute(material: bpy.types.Material | None) -> bool:
    """Return whether a material reads its base color from a color attribute, as the material of frames does."""
    return _color_source(material) == "VERTEX_COLOR"


def _color_source(material: bpy.types.Material | None) -> str | None:
    """Return the type of the node whose color is linked to the base color, or None."""
    base = base_color(material) if material else None
    source = base.links[0].from_socket if base is not None and base.is_linked else None
    return source.node.type if source is not None and source.name == "Color" else None


def base_color(material: bpy.types.Material) -> bpy.types.NodeSocket | None:
    """Return the base color socket of the shader that `principled_of` returns, or None."""
    principled = principled_of(material)
    return principled.inputs["Base Color"] if principled else None


def mark_as_frames(block: bpy.types.Material | bpy.types.NodeTree) -> None:
    """Mark a material or a node group as belonging to the frames of one morph, so that it is removed with them."""
    block[_CARRIES_KEY] = True


def release(material: bpy.types.Material) -> None:
    """Let a material of frames no longer belong to them."""
    del material[_CARRIES_KEY]


def is_carrying(block: bpy.types.Material | bpy.types.NodeTree | None) -> bool:
    """Return whether a material or a node group belongs to the frames of one morph."""
    return block is not None and _CARRIES_KEY in block


def drop_unused_groups() -> None:
    """Remove node groups of frames that no material uses, and those in them."""
    while unused := [tree for tree in bpy.data.node_groups if tree.users == 0 and is_carrying(tree)]:
        bpy.data.batch_remove(unused)


def attribute_material(name: str, color: str, *, is_see_through: bool = False) -> bpy.types.Material:
    """Return the material whose base color, and alpha on demand, is a color attribute; created if missing."""
    return _found_or_wired(name, "ShaderNodeVertexColor", is_see_through, layer_name=color)


def object_property_material(name: str, key: str, *, is_see_through: bool) -> bpy.types.Material:
    """Return the material whose base color, and alpha on demand, is a property of the object; created if missing."""
    return _found_or_wired(name, "ShaderNodeAttribute", is_see_through, attribute_type="OBJECT", attribute_name=key)


def principled_of(material: bpy.types.Material) -> bpy.types.Node | None:
    """Return the Principled BSDF that a material shows, the first one if it shows something else, or None."""
    if material.node_tree is None:
        return None
    output = shown_output(material.node_tree)
    shown = [link.from_node for link in output.inputs["Surface"].links] if output is not None else []
    nodes = [*shown, *material.node_tree.nodes]
    return next((node for node in nodes if node.type == "BSDF_PRINCIPLED"), None)


def wire(material: bpy.types.Material, kind: str, **settings: object) -> None:
    """Replace the nodes of a material by a Principled BSDF with the color of a node of a kind and with settings."""
    tree = own_tree(material)
    tree.nodes.clear()
    source = new_node(tree, kind, location=(-500.0, 0.0), **settings)
    inputs = {"Roughness": ROUGHNESS, "Base Color": source.outputs["Color"]}
    principled = new_node(tree, "ShaderNodeBsdfPrincipled", inputs, location=(-300.0, 0.0))
    new_node(tree, "ShaderNodeOutputMaterial", {"Surface": principled.outputs["BSDF"]})


def _found_or_wired(name: str, kind: str, is_see_through: bool = False, **settings: object) -> bpy.types.Material:
    """Return the material of a name; created as `wire` does if missing, and with the alpha of the color on demand."""
    material = bpy.data.materials.get(name)
    if material is None:
        material = bpy.data.materials.new(name)
        wire(material, kind, **settings)
        if is_see_through:
            base = base_color(material)
            alpha = base.links[0].from_node.outputs["Alpha"]
            material.node_tree.links.new(alpha, base.node.inputs["Alpha"])
    return material
