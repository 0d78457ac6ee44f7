# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Floor and sky of the studio."""

from __future__ import annotations

import bpy

from ..nodes.node_math import new_node
from ..nodes.node_trees import own_tree

_FLOOR_COLOR = (0.85, 0.85, 0.86, 1.0)
# Uniform, so that unshadowed floor is free of noise at any number of samples.
_SKY_BRIGHTNESS = 0.46


def even_sky() -> bpy.types.World:
    """Create a uniform environment light."""
    world = bpy.data.worlds.new("Studio Sky")
    tree = _emptied_tree(world)
    background = new_node(tree, "ShaderNodeBackground", {"Color": (*3 * (_SKY_BRIGHTNESS,), 1.0)})
    new_node(tree, "ShaderNodeOutputWorld", {"Surface": background.outputs["Background"]})
    return world


def floor_mesh(reach: float) -> bpy.types.Mesh:
    """Create a square with this distance from its center to its edges."""
    mesh = bpy.data.meshes.new("Studio Floor")
    corners = [(-reach, -reach, 0.0), (reach, -reach, 0.0), (reach, reach, 0.0), (-reach, reach, 0.0)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    return mesh


def floor_material() -> bpy.types.Material:
    """Create a matte, nearly white floor."""
    material = bpy.data.materials.new("Studio Floor")
    tree = _emptied_tree(material)
    diffuse = new_node(tree, "ShaderNodeBsdfDiffuse", {"Color": _FLOOR_COLOR})
    new_node(tree, "ShaderNodeOutputMaterial", {"Surface": diffuse.outputs["BSDF"]})
    return material


def _emptied_tree(block: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree:
    """Return the node tree of a new data-block, without nodes."""
    tree = own_tree(block)
    tree.nodes.clear()
    return tree
