# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the meshes of a map in the scene, with the triangles of the map."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.soft_maps.map_sides import MapSide
from ...geometry.algebra.affine import transformed_points
from ...geometry.meshes.mesh import TriangleMesh
from ..element_values import vectors_of
from ..surfaces import SurfaceReading, surface_mesh
from ..vertex_groups import group_names, read_groups


def resting_mesh(obj: bpy.types.Object, triangles: NDArray[np.int64]) -> TriangleMesh:
    """Return the mesh of an object without modifiers and shape keys, in world space.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.
    triangles : (m, 3) int64
        Triangles of the map.
    """
    keys = obj.data.shape_keys
    local = vectors_of(keys.reference_key.data if keys else obj.data.vertices)
    return TriangleMesh(transformed_points(local, obj.matrix_world), triangles)


def standing_mesh(obj: bpy.types.Object, triangles: NDArray[np.int64]) -> TriangleMesh:
    """Return the mesh of an object with modifiers and shape keys, in world space.

    Parameters
    ----------
    obj : bpy.types.Object
        Must have the vertices and faces for which the map was computed.
    triangles : (m, 3) int64
        Triangles of the map; in another pose, Blender may triangulate differently.

    Raises
    ------
    InputError
        As `surface_mesh`.
    """
    return TriangleMesh(surface_mesh(obj, bpy.context.evaluated_depsgraph_get()).vertices, triangles)


def map_side(obj: bpy.types.Object, reading: SurfaceReading, groups: Sequence[str]) -> MapSide:
    """Return what the solver of a map needs of an object: its surface, and the weights of some of its groups."""
    weights = dict(zip(groups, read_groups(obj, groups), strict=True)) if groups else {}
    return MapSide(reading.mesh, obj.name, weights)


def equal_groups(source: bpy.types.Object, target: bpy.types.Object) -> list[str]:
    """Return the names of the vertex groups that both objects have."""
    return [name for name in group_names(source) if name in target.vertex_groups]
