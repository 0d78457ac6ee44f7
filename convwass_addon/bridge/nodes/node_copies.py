# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Copy nodes from one node tree to another.

The node tree of a material cannot become a node group: Blender copies embedded trees only with their materials.
"""

from __future__ import annotations

import bpy

# Properties that Blender sets, or that `copied_nodes` sets itself.
_LEFT_OUT = ("rna_type", "name", "parent", "select", "location_absolute", "inputs", "outputs", "internal_links")


def copied_nodes(source: bpy.types.NodeTree, target: bpy.types.NodeTree) -> dict[str, bpy.types.Node]:
    """Copy all nodes of a tree with their links, drivers and animation, by the names of the originals.

    Parameters
    ----------
    source : bpy.types.NodeTree
        Unchanged.
    target : bpy.types.NodeTree
        An empty tree of the same type.
    """
    copies = {}
    for node in source.nodes:
        copy = target.nodes.new(node.bl_idname)
        copy.name = node.name
        _copy_properties(node, copy)
        copies[node.name] = copy
    for node in source.nodes:
        if node.parent is not None:
            copies[node.name].parent = copies[node.parent.name]
        _copy_values(node.inputs, copies[node.name].inputs)
        _copy_values(node.outputs, copies[node.name].outputs)
    for link in source.links:
        start = _socket(copies[link.from_node.name].outputs, link.from_socket)
        end = _socket(copies[link.to_node.name].inputs, link.to_socket)
        if start is not None and end is not None:
            target.links.new(start, end).is_muted = link.is_muted
    _copy_animation(source, target)
    return copies


def can_copy(tree: bpy.types.NodeTree) -> bool:
    """Return whether `copied_nodes` copies a tree completely: it has no zones, which come in pairs, and no scripts."""
    return not any(hasattr(node, "pair_with_output") or node.type == "SCRIPT" for node in tree.nodes)


def _copy_properties(source: bpy.types.bpy_struct, target: bpy.types.bpy_struct) -> None:
    """Copy the writable properties of a struct, and those of the structs that belong to it."""
    for prop in source.bl_rna.properties:
        name = prop.identifier
        if name in _LEFT_OUT:
            continue
        if not prop.is_readonly:
            value = getattr(source, name)
            try:
                setattr(target, name, value)
            except (AttributeError, TypeError, ValueError):  # does not apply with the other values of this node
                continue
        elif prop.type == "POINTER":
            own, other = getattr(source, name), getattr(target, name)
            if isinstance(own, bpy.types.ColorRamp):
                _copy_ramp(own, other)
            elif isinstance(own, bpy.types.CurveMapping):
                _copy_curves(own, other)
            elif own is not None and other is not None and not isinstance(own, bpy.types.ID):
                _copy_properties(own, other)


def _copy_ramp(source: bpy.types.ColorRamp, target: bpy.types.ColorRamp) -> None:
    for name in ("color_mode", "interpolation", "hue_interpolation"):
        setattr(target, name, getattr(source, name))
    while len(target.elements) > 1:
        target.elements.remove(target.elements[-1])
    for index, element in enumerate(source.elements):
        copy = target.elements[0] if index == 0 else target.elements.new(element.position)
        copy.position, copy.color = element.position, element.color


def _copy_curves(source: bpy.types.CurveMapping, target: bpy.types.CurveMapping) -> None:
    for name in ("use_clip", "extend", "tone", "black_level", "white_level"):
        setattr(target, name, getattr(source, name))
    for name in ("clip_min_x", "clip_min_y", "clip_max_x", "clip_max_y"):
        setattr(target, name, getattr(source, name))
    for own, copy in zip(source.curves, target.curves, strict=True):
        while len(copy.points) < len(own.points):
            copy.points.new(1.0, 1.0)
        while len(copy.points) > len(own.points):
            copy.points.remove(copy.points[-1])
        for point, other in zip(own.points, copy.points, strict=True):
            other.location, other.handle_type = point.location, point.handle_type
    target.update()


def _copy_values(
    source: bpy.types.bpy_prop_collection[bpy.types.NodeSocket],
    target: bpy.types.bpy_prop_collection[bpy.types.NodeSocket],
) -> None:
    for socket in source:
        copy = _socket(target, socket)
        if copy is not None and hasattr(socket, "default_value"):
            copy.default_value = socket.default_value


def _socket(
    sockets: bpy.types.bpy_prop_collection[bpy.types.NodeSocket], like: bpy.types.NodeSocket
) -> bpy.types.NodeSocket | None:
    """Return the socket with the identifier of another one."""
    return next((socket for socket in sockets if socket.identifier == like.identifier), None)


def _copy_animation(source: bpy.types.NodeTree, target: bpy.types.NodeTree) -> None:
    data = source.animation_data
    if data is None:
        return
    own = target.animation_data_create()
    for curve in data.drivers:
        own.drivers.from_existing(src_driver=curve)
    if data.action is not None:
        own.action = data.action
        if own.action_slot is None:
            own.action_slot = data.action_slot
