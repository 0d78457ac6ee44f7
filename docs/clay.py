# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of clay for pictures."""

from __future__ import annotations

import bpy

from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.objects import write_mesh
from convwass_addon.geometry.meshes.mesh import TriangleMesh


def clay(color: tuple[float, float, float, float]) -> bpy.types.Material:
    """Return a new material of one color, RGBA in scene linear."""
    material = bpy.data.materials.new("Clay")
    shader = next(node for node in own_tree(material).nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = color
    shader.inputs["Roughness"].default_value = 0.5
    return material


def frame_object(mesh: TriangleMesh, material: bpy.types.Material) -> bpy.types.Object:
    """Return a new object with smooth shading, in no scene."""
    data = bpy.data.meshes.new("Frame")
    write_mesh(data, mesh)
    data.shade_smooth()
    data.materials.append(material)
    return bpy.data.objects.new("Frame", data)
