# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the nodes of a material or a world that are visible in renders, without muted and unused ones."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from .node_trees import node_trees


def shown_tree(block: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree | None:
    """Return the node tree used for rendering; None if there is none, or if Blender 4.5 ignores it."""
    if bpy.app.version < (5, 0, 0) and not block.use_nodes:
        return None
    return block.node_tree


def nodes_of(materials: Iterable[bpy.types.Material | None]) -> list[bpy.types.Node]:
    """Return the nodes of the trees that materials are rendered with, including those in groups."""
    trees = [shown_tree(material) for material in materials if material is not None]
    return [node for tree in trees if tree is not None for own in node_trees(tree) for node in own.nodes]


def shown_output(tree: bpy.types.NodeTree) -> bpy.types.Node | None:
    """Return the output of a material that the render engine of the scene shows; None if there is none.

    A material may have one output for Cycles and another one for Eevee.
    """
    return tree.get_output_node("CYCLES" if bpy.context.scene.render.engine == "CYCLES" else "EEVEE")


def linked_output(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """Return the output that is linked to an input, also by reroutes; None if there is none, or if a link is muted."""
    link = next(iter(socket.links), None)
    while link is not None and not link.is_muted:
        if link.from_node.type != "REROUTE":
            return link.from_socket
        link = next(iter(link.from_node.inputs[0].links), None)
    return None


def source_node(socket: bpy.types.NodeSocket) -> bpy.types.Node | None:
    """Return the node of the output that is linked to an input; None if there is none, or if the node is muted."""
    output = linked_output(socket)
    return None if output is None or output.node.mute else output.node
