# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A material that shows baked images, and mixes those of several shapes by the sliders of the mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy

from ..nodes.node_math import Value, math_node, mixed, new_node, total
from ..nodes.node_trees import own_tree
from .texture_channels import EMISSION, NORMAL, Channel

# Places of nodes.
_COLUMN, _ROW = 300.0, 300.0


@dataclass(frozen=True)
class ChannelImages:
    """What a material shows of one channel.

    Attributes
    ----------
    images : tuple of bpy.types.Image
        One per look; empty if the channel is the same everywhere.
    value : (r, g, b)
        Its value if there are no images.
    strength : float
        Factor of the images.
    """

    images: tuple[bpy.types.Image, ...]
    value: tuple[float, float, float]
    strength: float = 1.0


def baked_material(
    name: str, channels: Mapping[Channel, ChannelImages], sliders: Sequence[str | None], uv_map: str
) -> bpy.types.Material:
    """Create a material from images.

    Parameters
    ----------
    name : str
        Its name.
    channels : mapping of Channel to ChannelImages
        What it shows.
    sliders : sequence of (str or None)
        For each look, the custom property of the object that leads to it; None for the undeformed mesh.
    uv_map : str
        The UV map of the images.
    """
    material = bpy.data.materials.new(name)
    tree = own_tree(material)
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    factors = _factors(tree, sliders) if len(sliders) > 1 else []
    place = new_node(tree, "ShaderNodeUVMap", uv_map=uv_map, location=(-_COLUMN * (len(sliders) + 4), 0.0))
    for row, (channel, own) in enumerate(channels.items()):
        shown = _mixed(tree, own.images, factors, place.outputs[0], row) if own.images else own.value
        _show(tree, shader, channel, shown, own.strength, uv_map)
    return material


def _factors(tree: bpy.types.NodeTree, sliders: Sequence[str | None]) -> list[bpy.types.NodeSocket]:
    """Return for each look after the first how much it covers those before it.

    A look has the value of its slider as weight, and the undeformed mesh what is missing to one.
    """
    weights = [_slider(tree, own, row) for row, own in enumerate(own for own in sliders if own is not None)]
    rest = math_node(tree, "SUBTRACT", 1.0, total(tree, weights))
    rest.node.use_clamp = True
    taken, factors = rest, []
    for weight in weights:
        taken = math_node(tree, "ADD", taken, weight)
        factors.append(math_node(tree, "DIVIDE", weight, taken))
    return factors


def _slider(tree: bpy.types.NodeTree, name: str, row: int) -> bpy.types.NodeSocket:
    settings = {"attribute_name": name, "label": name, "location": (-_COLUMN * 5, _ROW * (row + 1))}
    return new_node(tree, "ShaderNodeAttribute", attribute_type="OBJECT", **settings).outputs["Fac"]


def _mixed(
    tree: bpy.types.NodeTree,
    images: Sequence[bpy.types.Image],
    factors: Sequence[bpy.types.NodeSocket],
    place: bpy.types.NodeSocket,
    row: int,
) -> bpy.types.NodeSocket:
    """Return the color of images mixed one after the other."""
    shown = None
    for column, image in enumerate(images):
        location = (-_COLUMN * (len(images) + 3 - column), -_ROW * row)
        node = new_node(tree, "ShaderNodeTexImage", {"Vector": place}, image=image, location=location)
        color = node.outputs["Color"]
        shown = color if shown is None else mixed(tree, "Color", factors[column - 1], shown, color)
        if column:
            shown.node.location = (-_COLUMN * 2, -_ROW * row)
    return shown


def _show(
    tree: bpy.types.NodeTree,
    shader: bpy.types.Node,
    channel: Channel,
    shown: Value,
    strength: float,
    uv_map: str,
) -> None:
    """Link a channel to the shader, or set its value."""
    if channel == NORMAL:
        if isinstance(shown, bpy.types.NodeSocket):
            location = (-_COLUMN, shown.node.location.y)
            node = new_node(tree, "ShaderNodeNormalMap", {"Color": shown}, uv_map=uv_map, location=location)
            tree.links.new(node.outputs[0], shader.inputs["Normal"])
        return
    socket = shader.inputs["Emission Color" if channel == EMISSION else channel.name]
    if channel == EMISSION:
        shader.inputs["Emission Strength"].default_value = strength
    if isinstance(shown, bpy.types.NodeSocket):
        tree.links.new(shown, socket)
    elif isinstance(socket.default_value, float):
        socket.default_value = shown[0]
    else:
        socket.default_value = (*shown, 1.0)
