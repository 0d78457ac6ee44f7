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


def source_node(socket: bpy.types.NodeSocket) -> bpy.types.Node | None:
    """Return the node linked to an input; None if there is none, or if the node or the link is muted."""
    link = next(iter(socket.links), None)
    if link is None or link.is_muted or link.from_node.mute:
        return None
    return link.from_node
