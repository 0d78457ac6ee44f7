# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mix the whole materials of the inputs; one replaces the other everywhere, from below, or in patches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ...nodes.node_math import math_node, mixed, new_node
from .frame_attributes import GENERATED, LOOKS
from .look_groups import DISPLACEMENT, SURFACE

COLORS, FADE, FRONT, PATCHES = "COLORS", "FADE", "FRONT", "PATCHES"
"""Values of the setting `looks`."""

# Widths of the transition, relative to the height of the shape and to the contrast of the noise.
_FRONT_WIDTH, _PATCH_WIDTH = 0.06, 0.08
# Number of patches along a side of the shape, and the range of nearly all values of the noise.
_PATCHES, _NOISE = 3.0, (0.28, 0.72)


@dataclass(frozen=True)
class MixedLook:
    """The look of one input on some faces.

    Attributes
    ----------
    surface : bpy.types.NodeSocket
        Its shader.
    displacement : bpy.types.NodeSocket or None
        Its displacement, if it has any.
    share : bpy.types.NodeSocket
        Its weight.
    """

    surface: bpy.types.NodeSocket
    displacement: bpy.types.NodeSocket | None
    share: bpy.types.NodeSocket


def group_look(tree: bpy.types.NodeTree, group: bpy.types.NodeTree, share: bpy.types.NodeSocket) -> MixedLook:
    """Add a group that :class:`.look_groups.LookGroups` has made to a material."""
    node = new_node(tree, "ShaderNodeGroup", node_tree=group)
    output = next(own for own in group.nodes if own.type == "GROUP_OUTPUT")
    displacement = node.outputs[DISPLACEMENT] if output.inputs[DISPLACEMENT].is_linked else None
    return MixedLook(node.outputs[SURFACE], displacement, share)


def show_looks(material: bpy.types.Material, looks: Sequence[MixedLook], how: str) -> None:
    """Mix whole materials on meshes that have the attributes they read; on others the material looks as before.

    Parameters
    ----------
    material : bpy.types.Material
        With a shader linked to its output.
    looks : sequence of MixedLook
        One per input, in this material.
    how : str
        `FADE` mixes them by their weights all over the surface; with `FRONT`, each enters from below and ends above;
        with `PATCHES`, it grows from patches that stay in place on its input. At weight 0, an input is not seen at all;
        at weight 1, nothing else is.
    """
    tree = material.node_tree
    output = tree.get_output_node("ALL")
    simple = output.inputs["Surface"].links[0].from_socket
    shader, displacement, taken = looks[0].surface, looks[0].displacement, looks[0].share
    for index, look in enumerate(looks):
        look.surface.node.location = (100.0, -250.0 * (index + 1))
    for index, look in enumerate(looks[1:], start=1):
        taken = math_node(tree, "ADD", taken, look.share)
        share = math_node(tree, "DIVIDE", look.share, taken)
        taken.node.location = share.node.location = (-100.0, -250.0 * (index + 1))
        factor = _factor(tree, share, index, how)
        shader = _mixed_shaders(tree, factor, shader, look.surface, index)
        if displacement is not None or look.displacement is not None:
            displacement = mixed(tree, "Vector", factor, displacement, look.displacement)
    present = new_node(tree, "ShaderNodeAttribute", attribute_name=LOOKS, location=(100.0, 400.0)).outputs["Fac"]
    shown = _mixed_shaders(tree, present, simple, shader, len(looks))
    tree.links.new(shown, output.inputs["Surface"])
    if displacement is not None:
        tree.links.new(mixed(tree, "Vector", present, None, displacement), output.inputs["Displacement"])
    output.location = (900.0, 0.0)


def _factor(tree: bpy.types.NodeTree, share: bpy.types.NodeSocket, index: int, how: str) -> bpy.types.NodeSocket:
    """Return how much an input's material covers those before it, at every point."""
    if how == FRONT:
        return _threshold(tree, share, _height(tree), _FRONT_WIDTH)
    if how == PATCHES:
        return _threshold(tree, share, _noise(tree, GENERATED.format(index + 1)), _PATCH_WIDTH)
    return share


def _threshold(
    tree: bpy.types.NodeTree, share: bpy.types.NodeSocket, level: bpy.types.NodeSocket, width: float
) -> bpy.types.NodeSocket:
    """Return 1 where a level between 0 and 1 is below a share, with a soft edge: ((1 + width) share - level) / width.

    This is 0 everywhere for a share of 0, and 1 everywhere for a share of 1.
    """
    grown = math_node(tree, "MULTIPLY", share, 1.0 + width)
    above = math_node(tree, "SUBTRACT", grown, level)
    factor = math_node(tree, "DIVIDE", above, width)
    for own in (grown, above, factor):
        own.node.location = (-100.0, -250.0)
    factor.node.use_clamp = True
    return factor


def _height(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """Return the height of every point within the bounds of the frame, from 0 to 1."""
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    return new_node(tree, "ShaderNodeSeparateXYZ", {0: place}).outputs["Z"]


def _noise(tree: bpy.types.NodeTree, place: str) -> bpy.types.NodeSocket:
    """Return noise between 0 and 1 that stays in place on an input."""
    where = new_node(tree, "ShaderNodeAttribute", attribute_name=place).outputs["Vector"]
    inputs = {"Scale": _PATCHES, "Detail": 2.0, "Vector": where}
    noise = new_node(tree, "ShaderNodeTexNoise", inputs, label="Patches").outputs[0]
    inputs = {"From Min": _NOISE[0], "From Max": _NOISE[1], "Value": noise}
    return new_node(tree, "ShaderNodeMapRange", inputs).outputs[0]


def _mixed_shaders(
    tree: bpy.types.NodeTree,
    factor: bpy.types.NodeSocket,
    before: bpy.types.NodeSocket,
    after: bpy.types.NodeSocket,
    place: int,
) -> bpy.types.NodeSocket:
    location = (300.0 + 180.0 * place, 0.0)
    return new_node(tree, "ShaderNodeMixShader", {0: factor, 1: before, 2: after}, location=location).outputs[0]
