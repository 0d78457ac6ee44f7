# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Create a node group that looks up reflected light in a table by half and difference angle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import bpy

from ...applications.reflectance.lobe_lookup import HEIGHT
from ..nodes.node_math import math_node, mixed, new_node, vector_math_node

GROUP = "Interpolated Lobe"
"""Name of the node group."""

BLEND, DIRECTION, LIGHT, STRENGTH, DIFFUSE = "Blend", "Light Direction", "Light Color", "Light Strength", "Diffuse"
"""Its inputs; without the blend if the image contains one table."""

ACROSS, UP = "Across", "Up"
"""Inputs of the node group of a pad, instead of the blend."""

_RIGHT_ANGLE = math.pi / 2


def lobe_group(image: bpy.types.Image) -> bpy.types.NodeTree:
    """Create a node group for an image of stacked tables.

    It emits the light that a surface reflects from one distant light without shadows: f(half angle, difference angle)
    times the cosine and irradiance of the light, plus a diffuse part. Angles are computed from lengths of differences
    of unit vectors, 2 asin(|N - H| / 2), because the cosine loses all precision at the peak.

    Parameters
    ----------
    image : bpy.types.Image
        An image from :func:`.lobe_images.lobe_image`.
    """
    steps = image.size[1] // HEIGHT
    tree = _new_group([BLEND] if steps > 1 else [])
    at = _Angles(tree)
    if steps == 1:
        _shade(tree, at, stacked(tree, image, at.across, at.up, 0.0))
        return tree
    place = slider_place(tree, at.inputs[BLEND], steps)
    after = math_node(tree, "ADD", place.first, 1.0)
    tables = [stacked(tree, image, at.across, at.up, number) for number in (place.first, after)]
    _shade(tree, at, mixed(tree, "Vector", place.rest, *tables))
    return tree


def lobe_pad_group(image: bpy.types.Image, side: int) -> bpy.types.NodeTree:
    """Create the same for an image of side x side tables, with two sliders: :data:`ACROSS` and :data:`UP`."""
    tree = _new_group([ACROSS, UP])
    at = _Angles(tree)
    column, row = (slider_place(tree, at.inputs[name], side) for name in (ACROSS, UP))
    number = math_node(tree, "MULTIPLY_ADD", row.first, float(side), column.first)
    rows = []
    for more in (0, side):
        ends = [math_node(tree, "ADD", number, float(more + right)) for right in (0, 1)]
        tables = [stacked(tree, image, at.across, at.up, end) for end in ends]
        rows.append(mixed(tree, "Vector", column.rest, *tables))
    _shade(tree, at, mixed(tree, "Vector", row.rest, *rows))
    return tree


class _Angles:
    """Coordinates of light and view at a surface point, in the units of the tables."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self.inputs = tree.nodes.new("NodeGroupInput").outputs
        geometry = tree.nodes.new("ShaderNodeNewGeometry").outputs
        self.normal, view = geometry["Normal"], geometry["Incoming"]
        self.light = vector_math_node(tree, "NORMALIZE", self.inputs[DIRECTION])
        half = vector_math_node(tree, "NORMALIZE", vector_math_node(tree, "ADD", view, self.light))
        self.across = math_node(tree, "SQRT", _angle(tree, self.normal, half))
        self.up = _clamped(tree, _angle(tree, self.light, half))


def _shade(tree: bpy.types.NodeTree, at: _Angles, lobe: bpy.types.NodeSocket) -> None:
    """Shade the surface, and connect the output of the group."""
    matte = vector_math_node(tree, "SCALE", at.inputs[DIFFUSE], 1.0 / math.pi)
    cosine = math_node(tree, "MAXIMUM", vector_math_node(tree, "DOT_PRODUCT", at.normal, at.light), 0.0)
    brightness = math_node(tree, "MULTIPLY", cosine, at.inputs[STRENGTH])
    seen = vector_math_node(tree, "MULTIPLY", vector_math_node(tree, "ADD", lobe, matte), at.inputs[LIGHT])
    shown = vector_math_node(tree, "SCALE", seen, brightness)
    glow = new_node(tree, "ShaderNodeEmission", {"Color": shown}).outputs["Emission"]
    new_node(tree, "NodeGroupOutput", {"Shader": glow, "Color": shown})
    _lay_out(tree)


def _new_group(sliders: list[str]) -> bpy.types.NodeTree:
    tree = bpy.data.node_groups.new(GROUP, "ShaderNodeTree")
    new = tree.interface.new_socket
    for name in sliders:
        slider = new(name, in_out="INPUT", socket_type="NodeSocketFloat")
        slider.min_value, slider.max_value, slider.default_value = 0.0, 1.0, 0.5
        slider.subtype = "FACTOR"
    direction = new(DIRECTION, in_out="INPUT", socket_type="NodeSocketVector")
    direction.default_value = (0.0, 0.0, 1.0)
    new(LIGHT, in_out="INPUT", socket_type="NodeSocketColor").default_value = (1.0, 1.0, 1.0, 1.0)
    strength = new(STRENGTH, in_out="INPUT", socket_type="NodeSocketFloat")
    strength.default_value, strength.min_value = 1.0, 0.0
    new(DIFFUSE, in_out="INPUT", socket_type="NodeSocketColor").default_value = (0.0, 0.0, 0.0, 1.0)
    new("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    new("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    return tree


@dataclass(frozen=True)
class SliderPlace:
    """Position of a slider between values: the index of the value before it, and the fraction towards the next."""

    first: bpy.types.NodeSocket
    rest: bpy.types.NodeSocket


def slider_place(tree: bpy.types.NodeTree, slider: bpy.types.NodeSocket, count: int) -> SliderPlace:
    """Find the position of a slider from 0 to 1 between a number of values, at least two."""
    clamped = math_node(tree, "MINIMUM", math_node(tree, "MAXIMUM", slider, 0.0), 1.0)
    place = math_node(tree, "MULTIPLY", clamped, float(count - 1))
    first = math_node(tree, "MINIMUM", math_node(tree, "FLOOR", place), float(count - 2))
    return SliderPlace(first, math_node(tree, "SUBTRACT", place, first))


def stacked(
    tree: bpy.types.NodeTree,
    image: bpy.types.Image,
    across: bpy.types.NodeSocket,
    up: bpy.types.NodeSocket,
    number: bpy.types.NodeSocket | float,
) -> bpy.types.NodeSocket:
    """Look up a coordinate from 0 to 1 in one table of a stack."""
    row = math_node(tree, "DIVIDE", math_node(tree, "ADD", up, number), float(image.size[1] // HEIGHT))
    place = new_node(tree, "ShaderNodeCombineXYZ", {"X": across, "Y": row}).outputs["Vector"]
    settings = {"image": image, "interpolation": "Linear", "extension": "EXTEND"}
    return new_node(tree, "ShaderNodeTexImage", {"Vector": place}, **settings).outputs["Color"]


def _clamped(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Clamp to the texels of one table, so that the next table in the stack does not bleed in."""
    margin = 0.5 / HEIGHT
    return math_node(tree, "MINIMUM", math_node(tree, "MAXIMUM", value, margin), 1.0 - margin)


def _angle(tree: bpy.types.NodeTree, first: bpy.types.NodeSocket, second: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Angle between unit vectors; 1 is a right angle."""
    length = vector_math_node(tree, "LENGTH", vector_math_node(tree, "SUBTRACT", first, second))
    half = math_node(tree, "ARCSINE", math_node(tree, "MULTIPLY", length, 0.5))
    return math_node(tree, "MULTIPLY", half, 2.0 / _RIGHT_ANGLE)


def _lay_out(tree: bpy.types.NodeTree) -> None:
    """Arrange the nodes from left to right in the order of creation, which is the order of evaluation."""
    for place, node in enumerate(tree.nodes):
        node.location = (180.0 * (place // 4), -200.0 * (place % 4))
