# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes that play a density: two stored frames are mixed into one attribute."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..heat_map import fill_ramp
from ..nodes.node_math import feed, math_node, named_attribute, new_node, pick, stored_attribute, sum_over, switch
from ..nodes.node_trees import GroupInput, add_inputs
from ..sequence import frame_group, own_geometry

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
    value, *_ = add_inputs(
        tree,
        (
            GroupInput(VALUE, "Float", 0.0, "Progress of the density: 0 is the first frame, 1 the last"),
            GroupInput(SCALE, "Float", 1.0, "Factor of the attribute; at 1 its maximum is 1"),
            GroupInput(COLORS, "Bool", False, "Write the density as a heat map to a color attribute"),
        ),
    )
    value.subtype, value.min_value, value.max_value = "FACTOR", 0.0, 1.0
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
    share = math_node(tree, "SUBTRACT", place, before)
    ends = {"Factor": share, "A": _frame(tree, name, before), "B": _frame(tree, name, after)}
    value = new_node(tree, "ShaderNodeMix", ends).outputs["Result"]
    scaled = math_node(tree, "MULTIPLY", value, inputs[SCALE])
    geometry = stored_attribute(tree, own_geometry(tree), name, scaled)
    colored = stored_attribute(tree, geometry, color_name(name), _colors(tree, value), "FLOAT_COLOR")
    shown = switch(tree, "GEOMETRY", inputs[COLORS], geometry, colored)
    # Removed because later modifiers would process all frames: subdivision would interpolate each of them.
    cleaned = tree.nodes.new("GeometryNodeRemoveAttribute")
    if "Pattern Mode" in cleaned.inputs:
        cleaned.inputs["Pattern Mode"].default_value = "Wildcard"
    else:  # Blender 4.5
        cleaned.pattern_mode = "WILDCARD"
    feed(tree, [cleaned.inputs["Name"], cleaned.inputs["Geometry"]], [f"{_frame_prefix(name)}*", shown])
    new_node(tree, "NodeGroupOutput", {"Geometry": cleaned.outputs["Geometry"]})


def _frame_prefix(name: str) -> str:
    return f".{name} frame "


def _place(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket, times: Sequence[float]) -> bpy.types.NodeSocket:
    """Return the fractional frame of a value: 2.25 is a quarter of the way from the third to the fourth frame.

    A mesh line with one point per interval evaluates the finished share of each interval; the shares are summed.
    """
    line = new_node(tree, "GeometryNodeMeshLine", {"Count": len(times) - 1}).outputs["Mesh"]
    index = tree.nodes.new("GeometryNodeInputIndex").outputs["Index"]
    begin, end = (pick(tree, "FLOAT", index, list(map(float, some))) for some in (times[:-1], times[1:]))
    inputs = {"Value": value, "From Min": begin, "From Max": end}
    done = new_node(tree, "ShaderNodeMapRange", inputs).outputs["Result"]
    return sum_over(tree, line, done)


def _frame(tree: bpy.types.NodeTree, name: str, place: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return the values of frame `place`."""
    digits = new_node(tree, "FunctionNodeValueToString", {"Value": place})
    prefix = new_node(tree, "FunctionNodeInputString", string=_frame_prefix(name))
    joined = tree.nodes.new("GeometryNodeStringJoin")
    # The socket that is linked last comes first.
    tree.links.new(digits.outputs["String"], joined.inputs["Strings"])
    tree.links.new(prefix.outputs["String"], joined.inputs["Strings"])
    return named_attribute(tree, joined.outputs["String"])


def _colors(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    ramp = new_node(tree, "ShaderNodeValToRGB", {"Fac": value})
    fill_ramp(ramp.color_ramp)
    return ramp.outputs["Color"]
