# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A node group that looks up the light that a surface reflects in a table by half and difference angle."""

from __future__ import annotations

import math

import bpy

from ..node_math import math_node
from .lobe_images import HEIGHT

GROUP = "Interpolated Lobe"
"""Name of the node group."""

BLEND, DIRECTION, LIGHT, STRENGTH, DIFFUSE = "Blend", "Light Direction", "Light Color", "Light Strength", "Diffuse"
"""Its inputs; the blend is not there where the image holds one table."""

_RIGHT_ANGLE = math.pi / 2


def lobe_group(image: bpy.types.Image) -> bpy.types.NodeTree:
    """Make a node group for an image of stacked tables.

    It shows what one distant light, without shadows, makes of the table: f(half angle, difference angle) times the
    cosine of the light and its irradiance, and of a matte part, as light that the surface gives off. The angles come
    from lengths of differences of unit vectors, 2 asin(|N - H| / 2), since the cosine is all rounding at the peak.

    Parameters
    ----------
    image : bpy.types.Image
        As :func:`.lobe_images.lobe_image` makes it.
    """
    tree = bpy.data.node_groups.new(GROUP, "ShaderNodeTree")
    steps = image.size[1] // HEIGHT
    _add_sockets(tree, steps)
    inputs = tree.nodes.new("NodeGroupInput").outputs
    geometry = tree.nodes.new("ShaderNodeNewGeometry").outputs
    normal, view = geometry["Normal"], geometry["Incoming"]
    light = _vector(tree, "NORMALIZE", inputs[DIRECTION])
    half = _vector(tree, "NORMALIZE", _vector(tree, "ADD", view, light))
    across = math_node(tree, "SQRT", _angle(tree, normal, half))
    up = _clamped(tree, _angle(tree, light, half))
    lobe = _looked_up(tree, image, across, up, inputs[BLEND] if steps > 1 else None)
    matte = _scaled(tree, inputs[DIFFUSE], 1.0 / math.pi)
    cosine = math_node(tree, "MAXIMUM", _dot(tree, normal, light), 0.0)
    brightness = math_node(tree, "MULTIPLY", cosine, inputs[STRENGTH])
    seen = _vector(tree, "MULTIPLY", _vector(tree, "ADD", lobe, matte), inputs[LIGHT])
    shown = _scaled(tree, seen, brightness)
    glow = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shown, glow.inputs["Color"])
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(glow.outputs["Emission"], output.inputs["Shader"])
    tree.links.new(shown, output.inputs["Color"])
    _lay_out(tree)
    return tree


def _add_sockets(tree: bpy.types.NodeTree, steps: int) -> None:
    new = tree.interface.new_socket
    if steps > 1:
        blend = new(BLEND, in_out="INPUT", socket_type="NodeSocketFloat")
        blend.min_value, blend.max_value, blend.default_value = 0.0, 1.0, 0.5
        blend.subtype = "FACTOR"
    direction = new(DIRECTION, in_out="INPUT", socket_type="NodeSocketVector")
    direction.default_value = (0.0, 0.0, 1.0)
    new(LIGHT, in_out="INPUT", socket_type="NodeSocketColor").default_value = (1.0, 1.0, 1.0, 1.0)
    strength = new(STRENGTH, in_out="INPUT", socket_type="NodeSocketFloat")
    strength.default_value, strength.min_value = 1.0, 0.0
    new(DIFFUSE, in_out="INPUT", socket_type="NodeSocketColor").default_value = (0.0, 0.0, 0.0, 1.0)
    new("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    new("Color", in_out="OUTPUT", socket_type="NodeSocketColor")


def _looked_up(
    tree: bpy.types.NodeTree,
    image: bpy.types.Image,
    across: bpy.types.NodeSocket,
    up: bpy.types.NodeSocket,
    blend: bpy.types.NodeSocket | None,
) -> bpy.types.NodeSocket:
    if blend is None:
        return _texel(tree, image, across, up)
    steps = image.size[1] // HEIGHT
    clamped = math_node(tree, "MINIMUM", math_node(tree, "MAXIMUM", blend, 0.0), 1.0)
    place = math_node(tree, "MULTIPLY", clamped, float(steps - 1))
    before = math_node(tree, "MINIMUM", math_node(tree, "FLOOR", place), float(steps - 2))
    rows = math_node(tree, "ADD", before, up)
    first = _texel(tree, image, across, math_node(tree, "MULTIPLY", rows, 1.0 / steps))
    second = _texel(tree, image, across, math_node(tree, "MULTIPLY_ADD", rows, 1.0 / steps, 1.0 / steps))
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type = "VECTOR"
    factor, a, b = (next(own for own in mix.inputs if own.identifier == name) for name in _MIX)
    tree.links.new(math_node(tree, "SUBTRACT", place, before), factor)
    tree.links.new(first, a)
    tree.links.new(second, b)
    return next(own for own in mix.outputs if own.identifier == "Result_Vector")


_MIX = ("Factor_Float", "A_Vector", "B_Vector")


def _texel(
    tree: bpy.types.NodeTree, image: bpy.types.Image, across: bpy.types.NodeSocket, up: bpy.types.NodeSocket
) -> bpy.types.NodeSocket:
    place = tree.nodes.new("ShaderNodeCombineXYZ")
    tree.links.new(across, place.inputs["X"])
    tree.links.new(up, place.inputs["Y"])
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation, texture.extension = image, "Linear", "EXTEND"
    tree.links.new(place.outputs["Vector"], texture.inputs["Vector"])
    return texture.outputs["Color"]


def _clamped(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Stay within the texels of one table, so that the next one in the stack does not show through."""
    margin = 0.5 / HEIGHT
    return math_node(tree, "MINIMUM", math_node(tree, "MAXIMUM", value, margin), 1.0 - margin)


def _angle(tree: bpy.types.NodeTree, first: bpy.types.NodeSocket, second: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Angle between unit vectors; 1 is a right one."""
    node = _vector_node(tree, "LENGTH", _vector(tree, "SUBTRACT", first, second))
    half = math_node(tree, "ARCSINE", math_node(tree, "MULTIPLY", node.outputs["Value"], 0.5))
    return math_node(tree, "MULTIPLY", half, 2.0 / _RIGHT_ANGLE)


def _dot(tree: bpy.types.NodeTree, first: bpy.types.NodeSocket, second: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    return _vector_node(tree, "DOT_PRODUCT", first, second).outputs["Value"]


def _vector(tree: bpy.types.NodeTree, operation: str, *sockets: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    return _vector_node(tree, operation, *sockets).outputs["Vector"]


def _scaled(
    tree: bpy.types.NodeTree, vector: bpy.types.NodeSocket, factor: bpy.types.NodeSocket | float
) -> bpy.types.NodeSocket:
    node = _vector_node(tree, "SCALE", vector)
    if isinstance(factor, float):
        node.inputs["Scale"].default_value = factor
    else:
        tree.links.new(factor, node.inputs["Scale"])
    return node.outputs["Vector"]


def _vector_node(tree: bpy.types.NodeTree, operation: str, *sockets: bpy.types.NodeSocket) -> bpy.types.Node:
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    for socket, own in zip(sockets, node.inputs, strict=False):
        tree.links.new(socket, own)
    return node


def _lay_out(tree: bpy.types.NodeTree) -> None:
    """Put the nodes side by side in the order in which they were made, which is the order of the work."""
    for place, node in enumerate(tree.nodes):
        node.location = (180.0 * (place // 4), -200.0 * (place % 4))
