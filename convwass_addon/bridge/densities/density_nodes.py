# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes that play a density: two stored frames are mixed into one attribute."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..heat_map import fill_ramp
from ..node_math import math_node
from ..sequence import frame_group, own_geometry, pick

VALUE = "Density"
"""The animatable input of the modifier: 0 is the first frame, 1 the last."""

SCALE = "Scale"
"""The modifier's factor for the attribute; at 1 its maximum is 1."""

COLORS = "Heat Colors"
"""The modifier's switch for a color attribute with a heat map."""

NAME = "Density"
"""The default name of the attribute."""

# fmt: off
TAKEN_BY_RENDERERS = frozenset((
    "N", "uv", "generated", "generated_transform", "uv_tangent", "uv_tangent_sign", "tangent", "tangent_sign",
    "particle", "undisplaced", "undisplaced_N", "curve_intercept", "curve_length", "curve_random",
    "point_random", "ptex_face_id", "ptex_uv", "density", "color", "flame", "heat", "temperature", "velocity",
    "pointiness", "random_per_island", "shadow_transparency", "motion_P", "motion_N",
))
# fmt: on
"""Names that Cycles reserves: materials cannot read attributes with these names."""

DENSITY_KEY = "convwass_density"
"""Custom property of a node group that plays a density: the name of the density."""


def frame_name(name: str, place: int) -> str:
    """Return the name of the attribute of a frame; the leading dot hides it from lists."""
    return f"{_frame_prefix(name)}{place}"


def is_frame(attribute: str, name: str) -> bool:
    """Return whether an attribute holds a frame of a density."""
    return attribute.startswith(_frame_prefix(name)) and attribute[len(_frame_prefix(name)) :].isdecimal()


def color_name(name: str) -> str:
    """Return the name of the color attribute of a density."""
    return f"{name} color"


def density_tree(name: str, times: Sequence[float]) -> bpy.types.NodeTree:
    """Create the node group that plays the density `name`, with frames at ascending `times` from 0 to 1."""
    tree = frame_group(f"Play {name}")
    tree[DENSITY_KEY] = name
    for socket, kind, value, description in (
        (VALUE, "NodeSocketFloat", 0.0, "Progress of the density: 0 is the first frame, 1 the last"),
        (SCALE, "NodeSocketFloat", 1.0, "Factor of the attribute; at 1 its maximum is 1"),
        (COLORS, "NodeSocketBool", False, "Write the density as a heat map to a color attribute"),
    ):
        item = tree.interface.new_socket(socket, in_out="INPUT", socket_type=kind)
        item.description, item.default_value = description, value
        if socket == VALUE:
            item.subtype, item.min_value, item.max_value = "FACTOR", 0.0, 1.0
    fill(tree, name, times)
    return tree


def fill(tree: bpy.types.NodeTree, name: str, times: Sequence[float]) -> None:
    """Replace the nodes; the inputs, and therefore their keys, are kept.

    The number of nodes does not depend on the number of frames: the attribute's name is built from a number.
    """
    tree.nodes.clear()
    inputs = tree.nodes.new("NodeGroupInput").outputs
    place = _place(tree, inputs[VALUE], times)
    before = math_node(tree, "FLOOR", place)
    after = math_node(tree, "MINIMUM", math_node(tree, "ADD", before, 1.0), len(times) - 1.0)
    mixed = tree.nodes.new("ShaderNodeMix")
    tree.links.new(math_node(tree, "SUBTRACT", place, before), mixed.inputs["Factor"])
    tree.links.new(_frame(tree, name, before), mixed.inputs["A"])
    tree.links.new(_frame(tree, name, after), mixed.inputs["B"])
    value = mixed.outputs["Result"]
    scaled = math_node(tree, "MULTIPLY", value, inputs[SCALE])
    geometry = _stored(tree, own_geometry(tree), name, "FLOAT", scaled)
    colored = _stored(tree, geometry, color_name(name), "FLOAT_COLOR", _colors(tree, value))
    choice = tree.nodes.new("GeometryNodeSwitch")
    choice.input_type = "GEOMETRY"
    tree.links.new(inputs[COLORS], choice.inputs["Switch"])
    tree.links.new(geometry, choice.inputs["False"])
    tree.links.new(colored, choice.inputs["True"])
    # Removed because later modifiers would process all frames: subdivision would interpolate each of them.
    cleaned = tree.nodes.new("GeometryNodeRemoveAttribute")
    if "Pattern Mode" in cleaned.inputs:
        cleaned.inputs["Pattern Mode"].default_value = "Wildcard"
    else:  # Blender 4.5
        cleaned.pattern_mode = "WILDCARD"
    cleaned.inputs["Name"].default_value = f"{_frame_prefix(name)}*"
    tree.links.new(choice.outputs["Output"], cleaned.inputs["Geometry"])
    tree.links.new(cleaned.outputs["Geometry"], tree.nodes.new("NodeGroupOutput").inputs["Geometry"])


def _frame_prefix(name: str) -> str:
    return f".{name} frame "


def _place(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket, times: Sequence[float]) -> bpy.types.NodeSocket:
    """Return the fractional frame of a value: 2.25 is a quarter of the way from the third to the fourth frame.

    A mesh line with one point per interval evaluates the finished share of each interval; the shares are summed.
    """
    line = tree.nodes.new("GeometryNodeMeshLine")
    line.inputs["Count"].default_value = len(times) - 1
    index = tree.nodes.new("GeometryNodeInputIndex").outputs["Index"]
    done = tree.nodes.new("ShaderNodeMapRange")
    tree.links.new(value, done.inputs["Value"])
    tree.links.new(pick(tree, "FLOAT", index, [float(time) for time in times[:-1]]), done.inputs["From Min"])
    tree.links.new(pick(tree, "FLOAT", index, [float(time) for time in times[1:]]), done.inputs["From Max"])
    total = tree.nodes.new("GeometryNodeAttributeStatistic")
    tree.links.new(line.outputs["Mesh"], total.inputs["Geometry"])
    tree.links.new(done.outputs["Result"], total.inputs["Attribute"])
    return total.outputs["Sum"]


def _frame(tree: bpy.types.NodeTree, name: str, place: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return the values of frame `place`."""
    digits = tree.nodes.new("FunctionNodeValueToString")
    tree.links.new(place, digits.inputs["Value"])
    prefix = tree.nodes.new("FunctionNodeInputString")
    prefix.string = _frame_prefix(name)
    joined = tree.nodes.new("GeometryNodeStringJoin")
    # The socket that is linked last comes first.
    tree.links.new(digits.outputs["String"], joined.inputs["Strings"])
    tree.links.new(prefix.outputs["String"], joined.inputs["Strings"])
    attribute = tree.nodes.new("GeometryNodeInputNamedAttribute")
    attribute.data_type = "FLOAT"
    tree.links.new(joined.outputs["String"], attribute.inputs["Name"])
    return attribute.outputs["Attribute"]


def _stored(
    tree: bpy.types.NodeTree,
    geometry: bpy.types.NodeSocket,
    name: str,
    kind: str,
    value: bpy.types.NodeSocket,
) -> bpy.types.NodeSocket:
    node = tree.nodes.new("GeometryNodeStoreNamedAttribute")
    node.data_type, node.domain = kind, "POINT"
    node.inputs["Name"].default_value = name
    tree.links.new(geometry, node.inputs["Geometry"])
    tree.links.new(value, node.inputs["Value"])
    return node.outputs["Geometry"]


def _colors(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    fill_ramp(ramp.color_ramp)
    tree.links.new(value, ramp.inputs["Fac"])
    return ramp.outputs["Color"]
