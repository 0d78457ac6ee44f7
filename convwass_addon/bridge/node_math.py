# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Arithmetic in node trees."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

Value = bpy.types.NodeSocket | float | tuple[float, ...]
"""A socket to link, or a number or vector that stays as it is."""

_NUMBERS = {"DOT_PRODUCT", "LENGTH", "DISTANCE"}


def math_node(tree: bpy.types.NodeTree, operation: str, *values: bpy.types.NodeSocket | float) -> bpy.types.NodeSocket:
    """Return the result of an operation of Blender's Math node, such as "MULTIPLY_ADD", on sockets and numbers."""
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    feed(tree, node.inputs, values)
    return node.outputs[0]


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


def switch(
    tree: bpy.types.NodeTree,
    kind: str,
    condition: bpy.types.NodeSocket,
    otherwise: bpy.types.NodeSocket,
    chosen: bpy.types.NodeSocket,
) -> bpy.types.NodeSocket:
    """Return one of two values of a kind, such as "GEOMETRY": the second where the condition holds."""
    node = tree.nodes.new("GeometryNodeSwitch")
    node.input_type = kind
    for name, source in (("Switch", condition), ("False", otherwise), ("True", chosen)):
        tree.links.new(source, node.inputs[name])
    return node.outputs["Output"]


def feed(tree: bpy.types.NodeTree, sockets: Sequence[bpy.types.NodeSocket], values: Sequence[Value]) -> None:
    """Link sockets to inputs, or set them to numbers, one after the other."""
    for value, socket in zip(values, sockets, strict=False):
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        else:
            socket.default_value = value
