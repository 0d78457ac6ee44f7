# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The materials that objects have in place of those of their meshes, for nodes, which read only the latter."""

from __future__ import annotations

import bpy

from .nodes.node_math import joined, named_attribute, new_node, stored_attribute, without_attribute

_SLOT = "convwass_slot"


def with_own_materials(
    tree: bpy.types.NodeTree, geometry: bpy.types.NodeSocket, obj: bpy.types.Object
) -> bpy.types.NodeSocket:
    """Return the geometry of an object with its materials; instances in it keep theirs.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Node group of the new nodes.
    geometry : bpy.types.NodeSocket
        As Object Info provides it.
    obj : bpy.types.Object
        The object.
    """
    own = {place: slot.material for place, slot in enumerate(obj.material_slots) if slot.link == "OBJECT"}
    if not own:
        return geometry
    kinds = new_node(tree, "GeometryNodeSeparateComponents", {"Geometry": geometry}).outputs
    index = tree.nodes.new("GeometryNodeInputMaterialIndex").outputs["Material Index"]
    # The index of faces changes with their material.
    mesh = stored_attribute(tree, kinds["Mesh"], _SLOT, index, "INT", "FACE")
    for place, material in own.items():
        inputs = {"A": named_attribute(tree, _SLOT, "INT"), "B": place}
        chosen = new_node(tree, "FunctionNodeCompare", inputs, data_type="INT", operation="EQUAL").outputs["Result"]
        inputs = {"Geometry": mesh, "Selection": chosen, "Material": material}
        mesh = new_node(tree, "GeometryNodeSetMaterial", inputs).outputs["Geometry"]
    mesh = without_attribute(tree, mesh, _SLOT)
    return joined(tree, [mesh, *(kind for kind in kinds if kind.name != "Mesh")])
