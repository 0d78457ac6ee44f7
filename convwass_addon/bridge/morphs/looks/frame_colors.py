# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors of frame objects, as an attribute on the object that shows their meshes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy

from ...nodes.node_math import Value, new_node, stored_attribute
from ...nodes.node_trees import node_trees
from .materials import shows_object_color

COLOR = "morph_color"
"""Point attribute: the color of the source frame object, scene linear RGBA."""

ORIGINAL_KEY = "convwass_original"
"""Custom property of a material that shows this attribute: the material that it replaces."""


def colored(
    tree: bpy.types.NodeTree,
    geometry: bpy.types.NodeSocket,
    color: Value,
    frames: Sequence[bpy.types.Object],
) -> bpy.types.NodeSocket:
    """Make materials that read the object's color read that of the frame object instead.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        The node group to extend.
    geometry : bpy.types.NodeSocket
        Geometry with the materials of the frame objects.
    color : bpy.types.NodeSocket or tuple of float
        The color to store: that of the visible frame object, or a mixture.
    frames : sequence of bpy.types.Object
        All frame objects.

    Returns
    -------
    bpy.types.NodeSocket
        The geometry with the attribute `COLOR` and materials that show it; unchanged if no material reads the object's
        color.
    """
    used = [slot.material for obj in frames for slot in obj.material_slots]
    materials = [material for material in dict.fromkeys(used) if shows_object_color(material)]
    if not materials:
        return geometry
    result = stored_attribute(tree, geometry, COLOR, color, "FLOAT_COLOR")
    for material in materials:
        inputs = {"Old": material, "New": _colored_material(material), "Geometry": result}
        result = new_node(tree, "GeometryNodeReplaceMaterial", inputs).outputs["Geometry"]
    return result


def _colored_materials(trees: Iterable[bpy.types.NodeTree]) -> list[bpy.types.Material]:
    """Return the materials that `colored` has created for node groups."""
    nodes = (node for tree in trees for node in tree.nodes if node.bl_idname == "GeometryNodeReplaceMaterial")
    return [node.inputs["New"].default_value for node in nodes if node.inputs["New"].default_value]


def made_for(tree: bpy.types.NodeTree) -> list[bpy.types.ID]:
    """Return a node group that shows frame objects, the groups in it, and the materials made for them."""
    trees = node_trees(tree)
    return [*trees, *_colored_materials(trees)]


def seen_materials(tree: bpy.types.NodeTree, frames: Sequence[bpy.types.Object]) -> list[bpy.types.Material]:
    """Return all materials of the frame objects as shown by a node group, without duplicates."""
    nodes = (node for node in tree.nodes if node.bl_idname == "GeometryNodeReplaceMaterial")
    copies = {node.inputs["Old"].default_value: node.inputs["New"].default_value for node in nodes}
    used = (slot.material for obj in frames for slot in obj.material_slots if slot.material)
    return list(dict.fromkeys(copies.get(material, material) for material in used))


def _colored_material(material: bpy.types.Material) -> bpy.types.Material:
    """Return a copy of a material that shows the attribute instead of the object's color.

    The copy is shared, as the original material is.
    """
    in_use = (other for other in bpy.data.materials if other.get(ORIGINAL_KEY) == material and other.users)
    return next(in_use, None) or _colored_copy(material)


def _colored_copy(material: bpy.types.Material) -> bpy.types.Material:
    copy = material.copy()
    copy.name = f"{material.name} Player"
    copy[ORIGINAL_KEY] = material
    tree = copy.node_tree
    attribute = new_node(tree, "ShaderNodeAttribute", attribute_type="GEOMETRY", attribute_name=COLOR)
    for node in [node for node in tree.nodes if node.type == "OBJECT_INFO"]:
        attribute.location = node.location
        for name in ("Color", "Alpha"):
            for link in list(node.outputs[name].links):
                tree.links.new(attribute.outputs[name], link.to_socket)
    return copy
