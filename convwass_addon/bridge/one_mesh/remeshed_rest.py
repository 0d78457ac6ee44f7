# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A new mesh of the first shape that gets shape keys in its place."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ...applications.one_mesh.remeshed_basis import adaptive_mesh, even_mesh
from ...geometry.closest_points import ClosestPointFinder
from ...geometry.mesh import TriangleMesh
from ...geometry.polygons import Polygons
from ...progress import UNINTERRUPTED
from ...sentence import Sentence
from ..objects import frozen_copy, write_mesh
from .rest_mesh import RestMesh

_METHODS = {"EVEN": even_mesh, "ADAPTIVE": adaptive_mesh, "QUADS": even_mesh}


@dataclass(frozen=True)
class RemeshedShape:
    """A new mesh of a shape.

    Attributes
    ----------
    shape : TriangleMesh
        World space.
    rest : RestMesh
        With the same vertices.
    """

    shape: TriangleMesh
    rest: RestMesh


def remeshed_shape(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, kind: str, resolution: int) -> RemeshedShape:
    """Make a new mesh of an object as it is seen in the scene; materials are kept.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.
    depsgraph : bpy.types.Depsgraph
        The dependency graph of the scene.
    kind : "EVEN", "ADAPTIVE" or "QUADS"
        The faces of the new mesh.
    resolution : int
        Cells along the longest side.

    Raises
    ------
    InputError
        As :func:`..objects.frozen_copy`, or the object encloses too little at this resolution.
    """
    source = frozen_copy(obj, depsgraph)
    try:
        shape = _METHODS[kind](_triangles(source), obj.name, resolution, UNINTERRUPTED)
        polygons = Polygons.of_quads(shape) if kind == "QUADS" else Polygons.of_triangles(shape.faces)
        mesh = bpy.data.meshes.new(obj.name)
        write_mesh(mesh, shape, polygons)
        _carry_materials(source, mesh)
    finally:
        bpy.data.meshes.remove(source)
    lost = Sentence(
        "The new mesh of {name} has its materials, but no UV maps, weights or armature.", {"name": obj.name}
    )
    return RemeshedShape(shape, RestMesh(mesh, shape.vertices, None, (), [lost]))


def _triangles(mesh: bpy.types.Mesh) -> TriangleMesh:
    mesh.calc_loop_triangles()
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return TriangleMesh.from_arrays(points.reshape(-1, 3), corners.reshape(-1, 3))


def _carry_materials(source: bpy.types.Mesh, mesh: bpy.types.Mesh) -> None:
    """Give every face the material of the closest one."""
    for material in source.materials:
        mesh.materials.append(material)
    if len(source.materials) < 2:
        return
    of_triangles = np.empty(len(source.loop_triangles), np.int32)
    source.loop_triangles.foreach_get("material_index", of_triangles)
    centers = np.empty(3 * len(mesh.polygons), np.float32)
    mesh.polygons.foreach_get("center", centers)
    closest = ClosestPointFinder(_triangles(source).corners).find(centers.reshape(-1, 3).astype(np.float64))
    mesh.polygons.foreach_set("material_index", of_triangles[closest.triangles])
