# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Create materials driven by an Empty on a pad: values of all blends are stored in images that nodes sample."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ..node_math import math_node
from .lobe_images import fill_image, lobe_image
from .lobe_materials import PrincipledFit, emptied, follow, principled_values
from .lobe_nodes import ACROSS, DIFFUSE, GROUP, UP, lobe_pad_group
from .material_pad import MaterialPad

PLACE = "Place on the Pad"
"""Name of the node whose X and Y the pad drives, from 0 to 1."""


def pad_lobe_material(
    name: str,
    tables: Sequence[NDArray[np.float32]],
    diffuse: Sequence[tuple[float, float, float]],
    sun: bpy.types.Object | None,
    pad: MaterialPad,
) -> bpy.types.Material:
    """Create a material that shows tables on a pad, or update the last result of that name.

    Parameters
    ----------
    name : str
        Name of the material.
    tables : sequence of (64, 256, 3) float32
        Tables of all positions of the pad, row by row from the bottom.
    diffuse : sequence of (3,) float
        Diffuse colors of all positions.
    sun : bpy.types.Object or None
        A sun that lights the material.
    pad : MaterialPad
        Drives the material.
    """
    material, tree = emptied(name, "PAD LOBES")
    place = _driven_place(tree, pad)
    node = tree.nodes.new("ShaderNodeGroup")
    node.name = node.label = GROUP
    node.node_tree = lobe_pad_group(lobe_image(name, tables), pad.side)
    node.width = 200.0
    for slider, socket in zip((ACROSS, UP), place, strict=True):
        tree.links.new(socket, node.inputs[slider])
    tree.links.new(_read(tree, pad.side, f"{name} Matte", diffuse, place), node.inputs[DIFFUSE])
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs["Shader"], output.inputs["Surface"])
    if sun is not None:
        follow(node, sun)
    _lay_out(tree)
    return material


def pad_fitted_material(name: str, fits: Sequence[PrincipledFit], pad: MaterialPad) -> bpy.types.Material:
    """Create a material with a Principled BSDF whose values depend on the pad; see `pad_lobe_material`."""
    material, tree = emptied(name, "PAD FITTED")
    place = _driven_place(tree, pad)
    node = tree.nodes.new("ShaderNodeBsdfPrincipled")
    values = [principled_values(fit) for fit in fits]
    colors = [own["Base Color"][:3] for own in values]
    tree.links.new(_read(tree, pad.side, f"{name} Color", colors, place), node.inputs["Base Color"])
    names = ("Roughness", "Anisotropic", "Metallic")
    numbers = [tuple(own[name] for name in names) for own in values]
    parts = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(_read(tree, pad.side, f"{name} Values", numbers, place), parts.inputs[0])
    for name_of, socket in zip(names, parts.outputs, strict=True):
        tree.links.new(socket, node.inputs[name_of])
    turns = [own["Anisotropic Rotation"] for own in values]
    if any(turns):
        # Interpolation would rotate the anisotropy through oblique angles.
        turned = _read(tree, pad.side, f"{name} Grain", [(turn, turn, turn) for turn in turns], place, "Closest")
        tree.links.new(turned, node.inputs["Anisotropic Rotation"])
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    _lay_out(tree)
    return material


def _driven_place(tree: bpy.types.NodeTree, pad: MaterialPad) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket]:
    """Create a node that the Empty drives, and return its coordinates across and up."""
    node = tree.nodes.new("ShaderNodeCombineXYZ")
    node.name = node.label = PLACE
    pad.drive(node.inputs["X"], node.inputs["Y"])
    parts = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(node.outputs["Vector"], parts.inputs["Vector"])
    return parts.outputs["X"], parts.outputs["Y"]


def _read(
    tree: bpy.types.NodeTree,
    side: int,
    name: str,
    values: Sequence[Sequence[float]],
    place: tuple[bpy.types.NodeSocket, bpy.types.NodeSocket],
    interpolation: str = "Linear",
) -> bpy.types.NodeSocket:
    """Write the values of all positions to an image, and sample it at one; positions are pixel centers."""
    image = bpy.data.images.new(name, side, side, alpha=False, float_buffer=True, is_data=True)
    fill_image(image, np.asarray(values, dtype=np.float32).reshape(side, side, 3))
    at = tree.nodes.new("ShaderNodeCombineXYZ")
    for socket, target in zip(place, ("X", "Y"), strict=True):
        tree.links.new(math_node(tree, "MULTIPLY_ADD", socket, (side - 1) / side, 0.5 / side), at.inputs[target])
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation, texture.extension = image, interpolation, "EXTEND"
    tree.links.new(at.outputs["Vector"], texture.inputs["Vector"])
    return texture.outputs["Color"]


def _lay_out(tree: bpy.types.NodeTree) -> None:
    """Arrange the nodes from left to right in the order of evaluation."""
    for number, node in enumerate(tree.nodes):
        node.location = (220.0 * (number // 3 - len(tree.nodes) // 3), -260.0 * (number % 3))
