# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One object that is another mesh at each frame, made by geometry nodes."""

from __future__ import annotations

from collections.abc import Sequence

import bpy


def mesh_sequence(name: str, shown: Sequence[tuple[bpy.types.Object, ...]], first_frame: int) -> bpy.types.Object:
    """Make an object that shows the meshes of others, frame by frame.

    Exporters write it as a single mesh of changing topology, on every Blender; they treat objects that hide and show in
    turn each in their own way.

    Parameters
    ----------
    name : str
        Name of the object, its mesh and its node group.
    shown : sequence of tuple of bpy.types.Object
        What is seen at `first_frame`, at the frame after it, and so on.
    first_frame : int
        A scene frame.

    Returns
    -------
    bpy.types.Object
        Not linked to a scene; to be removed with `remove_sequence`.
    """
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    tree.is_modifier = True
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    choice = _index_switch(tree, len(shown), first_frame)
    joints = {objects: _joint(tree, objects) for objects in set(shown)}
    for place, objects in enumerate(shown):
        tree.links.new(joints[objects].outputs["Geometry"], choice.inputs[1 + place])
    own = _under_own_name(tree, choice.outputs["Output"])
    tree.links.new(own, tree.nodes.new("NodeGroupOutput").inputs["Geometry"])
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(1)
    obj = bpy.data.objects.new(name, mesh)
    obj.modifiers.new("Frames", "NODES").node_group = tree
    return obj


def remove_sequence(obj: bpy.types.Object) -> None:
    """Remove what `mesh_sequence` made."""
    bpy.data.batch_remove([obj, obj.data, obj.modifiers["Frames"].node_group])


def _index_switch(tree: bpy.types.NodeTree, count: int, first_frame: int) -> bpy.types.Node:
    """Return a node that passes on its input number 1 + (scene frame - first frame)."""
    time = tree.nodes.new("GeometryNodeInputSceneTime")
    offset = tree.nodes.new("ShaderNodeMath")
    offset.operation = "SUBTRACT"
    offset.inputs[1].default_value = first_frame
    tree.links.new(time.outputs["Frame"], offset.inputs[0])
    choice = tree.nodes.new("GeometryNodeIndexSwitch")
    choice.data_type = "GEOMETRY"
    choice.index_switch_items.clear()
    for _ in range(count):
        choice.index_switch_items.new()
    tree.links.new(offset.outputs[0], choice.inputs["Index"])
    return choice


def _joint(tree: bpy.types.NodeTree, objects: tuple[bpy.types.Object, ...]) -> bpy.types.Node:
    """Return a node with the geometry of all the objects, where they stand in the world."""
    joint = tree.nodes.new("GeometryNodeJoinGeometry")
    for obj in objects:
        info = tree.nodes.new("GeometryNodeObjectInfo")
        info.transform_space = "RELATIVE"
        info.inputs["Object"].default_value = obj
        tree.links.new(info.outputs["Geometry"], joint.inputs["Geometry"])
    return joint


def _under_own_name(tree: bpy.types.NodeTree, geometry: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return the geometry as a mesh that keeps the name of the modified object's own.

    Blender 5 takes over the name of the other object's mesh, and exporters then write a new mesh at each frame. A join
    takes the name of its first part: the single vertex of the own mesh, deleted again afterwards.
    """
    join = tree.nodes.new("GeometryNodeJoinGeometry")
    tree.links.new(geometry, join.inputs["Geometry"])
    # What is linked last comes first.
    tree.links.new(tree.nodes.new("NodeGroupInput").outputs["Geometry"], join.inputs["Geometry"])
    is_first = tree.nodes.new("FunctionNodeCompare")
    is_first.data_type, is_first.operation = "INT", "EQUAL"
    tree.links.new(tree.nodes.new("GeometryNodeInputIndex").outputs["Index"], is_first.inputs["A"])
    delete = tree.nodes.new("GeometryNodeDeleteGeometry")
    tree.links.new(join.outputs["Geometry"], delete.inputs["Geometry"])
    tree.links.new(is_first.outputs["Result"], delete.inputs["Selection"])
    return delete.outputs["Geometry"]
