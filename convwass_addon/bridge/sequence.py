# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that show one of several meshes, selected by Geometry Nodes: the row nearest to a point in a table."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from .element_values import write_floats
from .morphs.looks.frame_attributes import VELOCITY
from .nodes.node_math import feed, joined, new_node, stored_attribute, switch
from .nodes.node_trees import geometry_group

MODIFIER = "Frames"
"""Name of the modifier that selects the mesh."""


def frame_group(name: str) -> bpy.types.NodeTree:
    """Create a node group for a modifier, with one geometry input and one geometry output."""
    tree = geometry_group(name, {"Geometry": "Geometry"}, {"Geometry": "Geometry"})
    tree.is_modifier = True
    return tree


def table_object(
    name: str,
    points: Sequence[Sequence[float]] | np.ndarray,
    tree: bpy.types.NodeTree,
    materials: Sequence[bpy.types.Material] = (),
) -> bpy.types.Object:
    """Create an object whose own mesh is the lookup table of its nodes, with one vertex per row.

    Parameters
    ----------
    name : str
        Name of the object and its mesh.
    points : (n, 3) array_like
        Local space.
    tree : bpy.types.NodeTree
        Ends in `output`, with n rows.
    materials : sequence of bpy.types.Material
        Materials of the shown meshes, so that the slots of the object list them.

    Returns
    -------
    bpy.types.Object
        Not linked to a scene.
    """
    mesh = bpy.data.meshes.new(name)
    write_table(mesh, points, materials)
    obj = bpy.data.objects.new(name, mesh)
    obj.modifiers.new(MODIFIER, "NODES").node_group = tree
    return obj


def write_table(
    mesh: bpy.types.Mesh, points: Sequence[Sequence[float]] | np.ndarray, materials: Sequence[bpy.types.Material] = ()
) -> None:
    """Replace a mesh by loose vertices at `points`, (n, 3), and set its materials."""
    mesh.clear_geometry()
    mesh.vertices.add(len(points))
    write_floats(mesh.vertices, "co", points)
    mesh.update()
    mesh.materials.clear()
    for material in materials:
        mesh.materials.append(material)


def own_geometry(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
    """Return the geometry of the modified object, which is its table."""
    return tree.nodes.new("NodeGroupInput").outputs["Geometry"]


def along_x(tree: bpy.types.NodeTree, value: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return the point on the X axis at a number."""
    return new_node(tree, "ShaderNodeCombineXYZ", {"X": value}).outputs["Vector"]


def nearest(tree: bpy.types.NodeTree, table: bpy.types.NodeSocket, place: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return the row of a table that is nearest to a point."""
    inputs = {"Geometry": table, "Sample Position": place}
    return new_node(tree, "GeometryNodeSampleNearest", inputs, domain="POINT").outputs["Index"]


def object_info(
    tree: bpy.types.NodeTree, obj: bpy.types.Object | bpy.types.NodeSocket, *, space: str = "ORIGINAL"
) -> bpy.types.Node:
    """Return an Object Info node.

    Hidden objects are read, too.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        Node group of the new node.
    obj : bpy.types.Object or bpy.types.NodeSocket
        The other object, or a socket that provides it.
    space : "ORIGINAL" or "RELATIVE"
        Geometry in its local space and location in the world, or both relative to the modified object.
    """
    return new_node(tree, "GeometryNodeObjectInfo", {"Object": obj}, transform_space=space)


def transformed(
    tree: bpy.types.NodeTree, geometry: bpy.types.NodeSocket, matrix: bpy.types.NodeSocket
) -> bpy.types.NodeSocket:
    """Return a geometry transformed by a matrix, with its velocity; faces still point outwards if that mirrors them."""
    node = tree.nodes.new("GeometryNodeTransform")
    if "Mode" in node.inputs:
        node.inputs["Mode"].default_value = "Matrix"
    else:  # Blender 4.5
        node.mode = "MATRIX"
    feed(tree, [node.inputs["Geometry"], node.inputs["Transform"]], [geometry, matrix])
    moving = _with_transformed_velocity(tree, node.outputs["Geometry"], matrix)
    return _facing_outwards(tree, moving, matrix)


def _with_transformed_velocity(
    tree: bpy.types.NodeTree, geometry: bpy.types.NodeSocket, matrix: bpy.types.NodeSocket
) -> bpy.types.NodeSocket:
    """Return a geometry with its velocity transformed, if it has one; Blender only transforms the points."""
    velocity = new_node(tree, "GeometryNodeInputNamedAttribute", {"Name": VELOCITY}, data_type="FLOAT_VECTOR").outputs
    inputs = {"Geometry": geometry, "Value": velocity["Exists"]}
    exists = new_node(tree, "GeometryNodeSampleIndex", inputs, data_type="BOOLEAN").outputs["Value"]
    inputs = {"Direction": velocity["Attribute"], "Transform": matrix}
    turned = new_node(tree, "FunctionNodeTransformDirection", inputs).outputs["Direction"]
    moving = stored_attribute(tree, geometry, VELOCITY, turned, "FLOAT_VECTOR")
    return switch(tree, "GEOMETRY", exists, geometry, moving)


def mirrors(tree: bpy.types.NodeTree, matrix: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return whether a matrix mirrors what it transforms."""
    determinant = new_node(tree, "FunctionNodeMatrixDeterminant", {"Matrix": matrix}).outputs["Determinant"]
    inputs = {"A": determinant, "B": 0.0}
    return new_node(tree, "FunctionNodeCompare", inputs, operation="LESS_THAN").outputs["Result"]


def _facing_outwards(
    tree: bpy.types.NodeTree, geometry: bpy.types.NodeSocket, matrix: bpy.types.NodeSocket
) -> bpy.types.NodeSocket:
    """Return a mesh, which a matrix has transformed, with its faces flipped if that has mirrored it."""
    inputs = {"Mesh": geometry, "Selection": mirrors(tree, matrix)}
    return new_node(tree, "GeometryNodeFlipFaces", inputs).outputs["Mesh"]


def output(tree: bpy.types.NodeTree, geometry: bpy.types.NodeSocket, rows: int) -> None:
    """Connect a geometry to the output of a group, as a mesh that keeps the name of the modified object's mesh.

    Blender 5 uses the name of the other object's mesh, and exporters then write a new mesh for each frame. A join uses
    the name of its first part: the table, which is deleted again afterwards.
    """
    both = joined(tree, [own_geometry(tree), geometry])
    inputs = {"A": tree.nodes.new("GeometryNodeInputIndex").outputs["Index"], "B": rows}
    is_table = new_node(tree, "FunctionNodeCompare", inputs, data_type="INT", operation="LESS_THAN").outputs["Result"]
    inputs = {"Geometry": both, "Selection": is_table}
    shown = new_node(tree, "GeometryNodeDeleteGeometry", inputs).outputs["Geometry"]
    new_node(tree, "NodeGroupOutput", {"Geometry": shown})
