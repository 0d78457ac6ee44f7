# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes with their inputs, and arithmetic in node trees."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import bpy

Value = bpy.types.NodeSocket | float | tuple[float, ...]
"""A socket to link, or a number or vector that stays as it is."""

_NUMBERS = {"DOT_PRODUCT", "LENGTH", "DISTANCE"}


def new_node(
    tree: bpy.types.NodeTree, kind: str, inputs: Mapping[str | int, object] | None = None, **settings: object
) -> bpy.types.Node:
    """Add a node of a type.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        The tree of the node.
    kind : str
        Its type, such as "GeometryNodeSampleIndex".
    inputs : mapping of str or int, optional
        What its inputs are linked to, if it is a socket, or else set to, by name or place.
    **settings
        Its properties, such as ``data_type="FLOAT"``.
    """
    node = tree.nodes.new(kind)
    for name, value in settings.items():
        setattr(node, name, value)
    for key, value in (inputs or {}).items():
        feed(tree, [node.inputs[key]], [value])
    return node


def math_node(tree: bpy.types.NodeTree, operation: str, *values: bpy.types.NodeSocket | float) -> bpy.types.NodeSocket:
    """Return the result of an operation of Blender's Math node, such as "MULTIPLY_ADD", on sockets and numbers."""
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    feed(tree, node.inputs, values)
    return node.outputs[0]


def matrix_node(tree: bpy.types.NodeTree, matrix: Sequence[Sequence[float]]) -> bpy.types.NodeSocket:
    """Return a constant matrix, (4, 4)."""
    by_columns = [float(row[column]) for column in range(4) for row in matrix]
    return new_node(tree, "FunctionNodeCombineMatrix", dict(enumerate(by_columns))).outputs["Matrix"]


def clamped(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket, low: float, high: Value) -> bpy.types.NodeSocket:
    """Return a number that is neither below nor above two limits."""
    return math_node(tree, "MAXIMUM", math_node(tree, "MINIMUM", value, high), low)


def vector_math_node(tree: bpy.types.NodeTree, operation: str, *values: Value) -> bpy.types.NodeSocket:
    """Return the result of an operation of Blender's Vector Math node, such as "DOT_PRODUCT"; of "SCALE" too."""
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    feed(tree, [socket for socket in node.inputs if socket.enabled], values)
    return node.outputs["Value" if operation in _NUMBERS else "Vector"]


def total(tree: bpy.types.NodeTree, values: Sequence[bpy.types.NodeSocket]) -> bpy.types.NodeSocket:
    """Return the sum of numbers."""
    whole = values[0]
    for value in values[1:]:
        whole = math_node(tree, "ADD", whole, value)
    return whole


def weighted_sum(
    tree: bpy.types.NodeTree, values: Sequence[bpy.types.NodeSocket], weights: Sequence[bpy.types.NodeSocket]
) -> bpy.types.NodeSocket:
    """Return the sum of numbers, each times its weight."""
    whole = math_node(tree, "MULTIPLY", values[0], weights[0])
    for value, weight in zip(values[1:], weights[1:], strict=True):
        whole = math_node(tree, "MULTIPLY_ADD", value, weight, whole)
    return whole


def weighted_vectors(
    tree: bpy.types.NodeTree, values: Sequence[bpy.types.NodeSocket], weights: Sequence[bpy.types.NodeSocket]
) -> bpy.types.NodeSocket:
    """Return the sum of vectors or colors, each times its weight."""
    whole = vector_math_node(tree, "SCALE", values[0], weights[0])
    for value, weight in zip(values[1:], weights[1:], strict=True):
        whole = vector_math_node(tree, "ADD", vector_math_node(tree, "SCALE", value, weight), whole)
    return whole


def mixed(
    tree: bpy.types.NodeTree,
    kind: str,
    share: bpy.types.NodeSocket,
    first: bpy.types.NodeSocket | None,
    second: bpy.types.NodeSocket | None,
) -> bpy.types.NodeSocket:
    """Return the mixture of two values, of which None stands for zero, with this share of the second.

    Their kind is "Color" or "Vector".
    """
    node = new_node(tree, "ShaderNodeMix", data_type={"Color": "RGBA", "Vector": "VECTOR"}[kind])
    by_name = {socket.identifier: socket for socket in node.inputs}
    for name, value in (("Factor_Float", share), (f"A_{kind}", first), (f"B_{kind}", second)):
        if value is not None:
            tree.links.new(value, by_name[name])
    return next(socket for socket in node.outputs if socket.identifier == f"Result_{kind}")


def switch(
    tree: bpy.types.NodeTree,
    kind: str,
    condition: bpy.types.NodeSocket,
    otherwise: bpy.types.NodeSocket,
    chosen: bpy.types.NodeSocket,
) -> bpy.types.NodeSocket:
    """Return one of two values of a kind, such as "GEOMETRY": the second where the condition holds."""
    inputs = {"Switch": condition, "False": otherwise, "True": chosen}
    return new_node(tree, "GeometryNodeSwitch", inputs, input_type=kind).outputs["Output"]


def pick(
    tree: bpy.types.NodeTree, kind: str, index: bpy.types.NodeSocket, items: Sequence[object]
) -> bpy.types.NodeSocket:
    """Return the item at `index`.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Node group of the switch.
    kind : str
        Type of the items, such as "GEOMETRY" or "VECTOR".
    index : bpy.types.NodeSocket
        An integer.
    items : sequence
        Sockets, or constant values.
    """
    node = new_node(tree, "GeometryNodeIndexSwitch", data_type=kind)
    node.index_switch_items.clear()
    for _ in items:
        node.index_switch_items.new()
    feed(tree, node.inputs, [index, *items])
    return node.outputs["Output"]


def joined(tree: bpy.types.NodeTree, geometries: Sequence[bpy.types.NodeSocket]) -> bpy.types.NodeSocket:
    """Return geometries as one, in their order."""
    node = tree.nodes.new("GeometryNodeJoinGeometry")
    # The last link comes first.
    for geometry in reversed(geometries):
        tree.links.new(geometry, node.inputs["Geometry"])
    return node.outputs["Geometry"]


def sum_over(
    tree: bpy.types.NodeTree, geometry: bpy.types.NodeSocket, values: bpy.types.NodeSocket, domain: str = "POINT"
) -> bpy.types.NodeSocket:
    """Return the sum of a number over a domain of a geometry, such as "FACE"."""
    inputs = {"Geometry": geometry, "Attribute": values}
    return new_node(tree, "GeometryNodeAttributeStatistic", inputs, data_type="FLOAT", domain=domain).outputs["Sum"]


def stored_attribute(
    tree: bpy.types.NodeTree,
    geometry: bpy.types.NodeSocket,
    name: str,
    value: bpy.types.NodeSocket,
    kind: str = "FLOAT",
    domain: str = "POINT",
) -> bpy.types.NodeSocket:
    """Return a geometry with an attribute of a kind, such as "FLOAT_COLOR"."""
    inputs = {"Name": name, "Geometry": geometry, "Value": value}
    return new_node(tree, "GeometryNodeStoreNamedAttribute", inputs, data_type=kind, domain=domain).outputs["Geometry"]


def named_attribute(
    tree: bpy.types.NodeTree, name: bpy.types.NodeSocket | str, kind: str = "FLOAT"
) -> bpy.types.NodeSocket:
    """Return the values of an attribute of a kind, such as "FLOAT_VECTOR"."""
    return new_node(tree, "GeometryNodeInputNamedAttribute", {"Name": name}, data_type=kind).outputs["Attribute"]


def without_attribute(tree: bpy.types.NodeTree, geometry: bpy.types.NodeSocket, name: str) -> bpy.types.NodeSocket:
    """Return a geometry without an attribute."""
    return new_node(tree, "GeometryNodeRemoveAttribute", {"Name": name, "Geometry": geometry}).outputs["Geometry"]


def feed(tree: bpy.types.NodeTree, sockets: Sequence[bpy.types.NodeSocket], values: Sequence[Value]) -> None:
    """Link sockets to inputs, or set them to numbers, one after the other."""
    for value, socket in zip(values, sockets, strict=False):
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        else:
            socket.default_value = value
