# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in a studio: a floor, and a sky around it."""

from __future__ import annotations

import bpy

from .node_trees import own_tree

_FLOOR_COLOR = (0.85, 0.85, 0.86, 1.0)
# The same everywhere: unshadowed floor is then free of noise, however few light paths are followed.
_SKY_BRIGHTNESS = 0.46


def even_sky() -> bpy.types.World:
    """Make surroundings that shine evenly."""
    world = bpy.data.worlds.new("Studio Sky")
    tree = _emptied_tree(world)
    background = tree.nodes.new("ShaderNodeBackground")
    background.inputs["Color"].default_value = (*3 * (_SKY_BRIGHTNESS,), 1.0)
    output = tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(background.outputs["Background"], output.inputs["Surface"])
    return world


def floor_mesh(reach: float) -> bpy.types.Mesh:
    """Make a square that reaches so far from its middle."""
    mesh = bpy.data.meshes.new("Studio Floor")
    corners = [(-reach, -reach, 0.0), (reach, -reach, 0.0), (reach, reach, 0.0), (-reach, reach, 0.0)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    return mesh


def floor_material() -> bpy.types.Material:
    """Make a matte, nearly white floor."""
    material = bpy.data.materials.new("Studio Floor")
    tree = _emptied_tree(material)
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = _FLOOR_COLOR
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])
    return material


def _emptied_tree(block: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree:
    """Return the node tree of a new data-block, without nodes."""
    tree = own_tree(block)
    tree.nodes.clear()
    return tree
