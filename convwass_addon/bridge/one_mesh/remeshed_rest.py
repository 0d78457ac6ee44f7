# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A new mesh of the first shape that gets shape keys in its place."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ...applications.one_mesh.remeshed_basis import adaptive_mesh, even_mesh, missing_reach
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.polygons import Polygons
from ...progress import UNINTERRUPTED
from ...sentence import Sentence
from ..element_values import element_values, triangle_corners
from ..objects import frozen_copy, write_mesh
from .carried_basis import carry_to_basis
from .rest_mesh import RestMesh, at_rest

# Parts that reach farther than this many cells beyond the new mesh are missing; its corners are rounder by less.
_MISSING = 2.0
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
    """Make a new mesh of an object as it is seen in the scene.

    It has the materials, UV maps, colors and vertex groups of the object. Armatures and the modifiers after them are
    kept; those after them must be hidden (`armature_last`).

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
        As :func:`..objects.frozen_copy` and :func:`.rest_mesh.at_rest`, or the object encloses too little at this
        resolution.
    """
    source = frozen_copy(obj, depsgraph)
    try:
        triangles = _triangles(source)
        shape = _METHODS[kind](triangles, obj.name, resolution, UNINTERRUPTED)
        cell = triangles.longest_side / resolution
        missing = missing_reach(triangles, shape, _MISSING * cell, UNINTERRUPTED) / cell
        polygons = Polygons.of_quads(shape) if kind == "QUADS" else Polygons.of_triangles(shape.faces)
        mesh = bpy.data.meshes.new(obj.name)
        write_mesh(mesh, shape, polygons)
        carry_to_basis(source, mesh, shape, polygons)
    finally:
        bpy.data.meshes.remove(source)
    rest = at_rest(obj, mesh, shape.vertices)
    if obj.data.shape_keys is not None:
        notice = Sentence("The new mesh has the current form of {name}, without its shape keys.", {"name": obj.name})
        rest.notices.append(notice)
    if missing > 0.0:
        values = {"name": obj.name, "cells": missing}
        rest.notices.append(
            Sentence(
                "The new mesh lacks thin parts of {name} that are up to {cells:.0f} cells long; raise the resolution.",
                values,
            )
        )
    return RemeshedShape(shape, rest)


def _triangles(mesh: bpy.types.Mesh) -> TriangleMesh:
    return TriangleMesh.from_arrays(element_values(mesh.vertices, "co", 3), triangle_corners(mesh, "vertices"))
