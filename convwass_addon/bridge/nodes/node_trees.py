# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of data-blocks, and groups in them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import bpy


@dataclass(frozen=True)
class GroupInput:
    """An input of a node group that users see, such as in a modifier.

    Attributes
    ----------
    name : str
        Its name.
    kind : str
        Type of the socket, such as "Float".
    start : object
        The initial value; None for that of the type.
    description : str
        The tooltip.
    """

    name: str
    kind: str
    start: object
    description: str


def own_tree(block: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree:
    """Return the node tree of a data-block; created if missing."""
    if block.node_tree is None:  # Blender 4.5; later versions always use nodes and warn about this property
        block.use_nodes = True
    return block.node_tree


def geometry_group(name: str, inputs: Mapping[str, str], outputs: Mapping[str, str]) -> bpy.types.NodeTree:
    """Create a group of geometry nodes, with the names and types of its sockets, such as "Geometry" or "Float"."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    for in_out, sockets in (("INPUT", inputs), ("OUTPUT", outputs)):
        for label, kind in sockets.items():
            tree.interface.new_socket(label, in_out=in_out, socket_type=f"NodeSocket{kind}")
    return tree


def add_inputs(tree: bpy.types.NodeTree, inputs: Iterable[GroupInput]) -> list[bpy.types.NodeTreeInterfaceSocket]:
    """Add inputs to a node group, and return their sockets."""
    sockets = []
    for own in inputs:
        socket = tree.interface.new_socket(own.name, in_out="INPUT", socket_type=f"NodeSocket{own.kind}")
        socket.description = own.description
        if own.start is not None:
            socket.default_value = own.start
        sockets.append(socket)
    return sockets


def node_trees(tree: bpy.types.NodeTree) -> list[bpy.types.NodeTree]:
    """Return a tree and all groups in it."""
    found = [tree]
    for own in found:
        nested = [node.node_tree for node in own.nodes if node.type == "GROUP" and node.node_tree is not None]
        found += [one for one in dict.fromkeys(nested) if one not in found]
    return found
