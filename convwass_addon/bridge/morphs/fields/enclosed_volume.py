# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes that give a closed mesh a volume, by moving its vertices along their normals."""

from __future__ import annotations

import bpy

from ...nodes.node_math import clamped, math_node, sum_over, vector_math_node
from .field_sampler import position_node, set_position


def with_volume(
    tree: bpy.types.NodeTree, mesh: bpy.types.NodeSocket, volume: bpy.types.NodeSocket, farthest: float
) -> bpy.types.NodeSocket:
    """Return a closed mesh that is moved along its normals to enclose a volume.

    The divergence theorem gives the volume, a third of the sum of areas times p . n over all faces, whose derivative is
    the area. One Newton step is enough, because meshes of mixed fields are off by only about a percent.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Node group of the new nodes.
    mesh : bpy.types.NodeSocket
        Facing outward.
    volume : bpy.types.NodeSocket
        The volume to enclose.
    farthest : float
        Vertices are moved no farther than this.
    """
    normals = tree.nodes.new("GeometryNodeInputNormal").outputs
    normal = normals.get("True Normal", normals["Normal"])
    area = tree.nodes.new("GeometryNodeInputMeshFaceArea").outputs["Area"]
    height = vector_math_node(tree, "DOT_PRODUCT", position_node(tree), normal)
    enclosed = sum_over(tree, mesh, math_node(tree, "MULTIPLY", height, math_node(tree, "DIVIDE", area, 3.0)), "FACE")
    surface = math_node(tree, "MAXIMUM", sum_over(tree, mesh, area, "FACE"), 1e-12)
    way = math_node(tree, "DIVIDE", math_node(tree, "SUBTRACT", volume, enclosed), surface)
    way = clamped(tree, way, -farthest, farthest)
    return set_position(tree, mesh, offset=vector_math_node(tree, "SCALE", normal, way))
