# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that show a density: a heat map, and growth that covers the surface where the density is high."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ..heat_map import fill_ramp
from ..nodes.node_math import math_node, new_node
from ..nodes.node_trees import own_tree
from .density_nodes import NAME

ROUGHNESS = 0.55


@dataclass(frozen=True)
class _Growth:
    """Parameters of a growth.

    Attributes
    ----------
    dark, light : (r, g, b)
        Range of colors, scene linear.
    roughness, sheen : float
        Parameters of a Principled BSDF.
    grain : float
        Number of grains per unit of length in object space.
    height : float
        Strength of the bump mapping of grains.
    ragged : float
        Irregularity of the edge; at 0 it follows the density.
    """

    dark: tuple[float, float, float]
    light: tuple[float, float, float]
    roughness: float
    sheen: float
    grain: float
    height: float
    ragged: float


GROWTHS = {
    "MOSS": _Growth((0.018, 0.05, 0.008), (0.13, 0.24, 0.03), 0.95, 0.15, 45.0, 0.9, 0.9),
    "FROST": _Growth((0.55, 0.7, 0.85), (0.95, 0.98, 1.0), 0.35, 0.1, 70.0, 0.5, 0.8),
}
"""The kinds of growth."""


def heat_material(name: str = NAME) -> bpy.types.Material:
    """Return the heat map material of a density; created if missing.

    Parameters
    ----------
    name : str
        Name of the attribute, with values from 0 to 1.
    """
    title = f"{name} Heat Map"
    material = bpy.data.materials.get(title)
    if material is not None:
        return material
    material, principled = _new(title)
    tree = material.node_tree
    principled.inputs["Roughness"].default_value = ROUGHNESS
    ramp = new_node(tree, "ShaderNodeValToRGB", {"Fac": _attribute(tree, name)}, location=(-350.0, 0.0))
    fill_ramp(ramp.color_ramp)
    tree.links.new(ramp.outputs["Color"], principled.inputs["Base Color"])
    return material


def growth_material(
    name: str = NAME,
    kind: str = "MOSS",
    color: tuple[float, float, float, float] = (0.35, 0.3, 0.27, 1.0),
    *,
    threshold: float = 0.25,
) -> bpy.types.Material:
    """Create a material that grows where a density is high, with a ragged edge.

    Parameters
    ----------
    name : str
        Name of the attribute, with values from 0 to 1.
    kind : str
        A key of `GROWTHS`.
    color : (r, g, b, a)
        Base color of the surface below the growth, scene linear.
    threshold : float
        Density at which half of the surface is covered.
    """
    growth = GROWTHS[kind]
    material, bare = _new(f"{name} {kind.title()}")
    tree = material.node_tree
    bare.inputs["Base Color"].default_value = color
    bare.inputs["Roughness"].default_value = ROUGHNESS
    grains = _noise(tree, growth.grain, 6.0)
    cover = _cover(tree, _attribute(tree, name), _noise(tree, growth.grain / 8.0, 5.0), growth.ragged, threshold)
    grown = _grown(tree, growth, grains, cover)
    mixed = new_node(tree, "ShaderNodeMixShader", {0: cover, 1: bare.outputs["BSDF"], 2: grown.outputs["BSDF"]})
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(mixed.outputs[0], output.inputs["Surface"])
    return material


def _new(title: str) -> tuple[bpy.types.Material, bpy.types.Node]:
    """Create a material with a single shader, and return both."""
    material = bpy.data.materials.new(title)
    tree = own_tree(material)
    tree.nodes.clear()
    output = new_node(tree, "ShaderNodeOutputMaterial", location=(400.0, 0.0))
    principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
    tree.links.new(principled.outputs["BSDF"], output.inputs["Surface"])
    return material, principled


def _attribute(tree: bpy.types.NodeTree, name: str) -> bpy.types.NodeSocket:
    settings = {"attribute_type": "GEOMETRY", "attribute_name": name, "location": (-900.0, 0.0)}
    return new_node(tree, "ShaderNodeAttribute", **settings).outputs["Fac"]


def _noise(tree: bpy.types.NodeTree, scale: float, detail: float) -> bpy.types.NodeSocket:
    """Return noise in object space, from 0 to 1."""
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Object"]
    noise = new_node(tree, "ShaderNodeTexNoise", {"Scale": scale, "Detail": detail, "Vector": place})
    return noise.outputs["Fac"] if "Fac" in noise.outputs else noise.outputs["Factor"]


def _cover(
    tree: bpy.types.NodeTree,
    density: bpy.types.NodeSocket,
    noise: bpy.types.NodeSocket,
    ragged: float,
    threshold: float,
) -> bpy.types.NodeSocket:
    """Return the coverage: a smooth step at the threshold, shifted by noise where the density is not zero."""
    shift = math_node(tree, "MULTIPLY_ADD", noise, 4.0 * ragged, 1.0 - 2.0 * ragged)
    shifted = math_node(tree, "MULTIPLY", density, shift)
    inputs = {"From Min": 0.7 * threshold, "From Max": 1.3 * threshold, "Value": shifted}
    return new_node(tree, "ShaderNodeMapRange", inputs, interpolation_type="SMOOTHSTEP").outputs["Result"]


def _grown(
    tree: bpy.types.NodeTree, growth: _Growth, grains: bpy.types.NodeSocket, cover: bpy.types.NodeSocket
) -> bpy.types.Node:
    """Return the shader of the growth, with bump mapping for its edge and grains."""
    ramp = new_node(tree, "ShaderNodeValToRGB", {"Fac": grains})
    for element, color, place in zip(ramp.color_ramp.elements, (growth.dark, growth.light), (0.35, 0.7), strict=True):
        element.color, element.position = (*color, 1.0), place
    height = math_node(tree, "MULTIPLY_ADD", grains, 1.0, cover)
    bump = new_node(tree, "ShaderNodeBump", {"Strength": growth.height, "Distance": 0.02, "Height": height})
    inputs = {
        "Roughness": growth.roughness,
        "Sheen Weight": growth.sheen,
        "Base Color": ramp.outputs["Color"],
        "Normal": bump.outputs["Normal"],
    }
    return new_node(tree, "ShaderNodeBsdfPrincipled", inputs, location=(0.0, -700.0))
