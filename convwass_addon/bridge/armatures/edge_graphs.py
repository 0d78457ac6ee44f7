# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert meshes of edges to graphs of joints, and write moved joints back to the vertices."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.skeletons.skeleton_graph import JointGraph
from ...errors import InputError
from ...geometry.algebra.affine import transformed_points
from ..element_values import element_values, vectors_of, write_floats
from ..mesh_checks import other_vertices, readable_mesh
from .pins import pinned_vertices
from .rig_graphs import RigGraph, world_matrix


def edge_graph(obj: bpy.types.Object) -> RigGraph:
    """Return the joint graph of a mesh of edges, without modifiers.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh without faces; vertices without edges are not joints.

    Raises
    ------
    InputError
        The object is not a mesh, has faces, or has no edges.
    """
    mesh = readable_mesh(obj)
    if len(mesh.polygons):
        raise InputError(
            "{object} has faces; a skeleton must be an armature, or a mesh of edges without faces.", object=obj.name
        )
    if not len(mesh.edges):
        raise InputError("{object} has no edges; a skeleton must be an armature, or a mesh of edges.", object=obj.name)
    edges = element_values(mesh.edges, "vertices", 2, np.int32)
    joints, compact = np.unique(edges, return_inverse=True)
    matrix = world_matrix(obj)
    points = transformed_points(vectors_of(mesh.vertices)[joints], matrix)
    names = tuple(str(vertex) for vertex in joints)
    selected = element_values(mesh.vertices, "select", kind=bool)
    return RigGraph(
        graph=JointGraph.from_arrays(points, compact.reshape(-1, 2), pinned_vertices(mesh)[joints], names),
        ends=tuple((name,) for name in names),
        selected=selected[joints] & mesh.is_editmode,
        matrix=matrix,
        parts=(str(len(mesh.vertices)),),
    )


def move_edge_joints(obj: bpy.types.Object, rig: RigGraph, positions: NDArray[np.float64]) -> None:
    """Move the joints of a mesh of edges.

    Parameters
    ----------
    obj : bpy.types.Object
        The mesh, in Edit Mode or not.
    rig : RigGraph
        The joints as they were read.
    positions : (v, 3)
        New positions in world space.

    Raises
    ------
    InputError
        The number of vertices has changed since the joints were read.
    """
    mesh = readable_mesh(obj)
    if rig.parts != (str(len(mesh.vertices)),):
        raise other_vertices(obj)
    points = vectors_of(mesh.vertices)
    points[[int(name) for name in rig.graph.names]] = transformed_points(positions, np.linalg.inv(rig.matrix))
    if not mesh.is_editmode:
        write_floats(mesh.vertices, "co", points)
        mesh.update()
        return
    edited = bmesh.from_edit_mesh(mesh)
    for vertex, point in zip(edited.verts, points, strict=True):
        vertex.co = point
    bmesh.update_edit_mesh(mesh)
