# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects with a map between them that is known without solving anything."""

from __future__ import annotations

import bpy
import numpy as np

from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.soft_maps.soft_map_bytes import StoredSoftMap
from convwass_addon.bridge.soft_maps.soft_map_store import mapped_side, store_soft_map
from convwass_addon.bridge.surfaces import surface_mesh
from tests.surface_maps import closest_map, closest_points


def own():
    return bpy.context.scene.convwass_soft_map


def sphere(name, segments=32, ring_count=16, **placed):
    """Add a sphere around the origin with its poles along Z."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=ring_count, **placed)
    obj = bpy.context.object
    obj.name = name
    return obj


def choose(source, target):
    own().source, own().target = source, target


def store_closest(source, target):
    """Store the closest-point map of coinciding objects, and choose both."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    meshes = [surface_mesh(obj, depsgraph) for obj in (source, target)]
    sides = [mapped_side(obj, mesh.faces) for obj, mesh in zip((source, target), meshes, strict=True)]
    store_soft_map(source, target, StoredSoftMap(closest_map(*meshes), *sides))
    choose(source, target)


def store_mirror(obj):
    """Store the map of an object to its mirror image along X, and choose it."""
    mesh = surface_mesh(obj, bpy.context.evaluated_depsgraph_get())
    reflected = type(mesh)(mesh.vertices * (-1, 1, 1), mesh.faces)
    found = closest_map(mesh, mesh)
    points = closest_points(reflected, mesh)
    side = mapped_side(obj, mesh.faces)
    store_soft_map(obj, obj, StoredSoftMap(type(found)(points, points, found.coarse), side, side))
    choose(obj, obj)


def points(obj):
    return element_values(obj.data.vertices, "co", 3).astype(np.float64)


def select(obj, *vertices):
    """Select these vertices alone, as if Edit Mode had been left with them."""
    chosen = np.zeros(len(obj.data.vertices), bool)
    chosen[list(vertices)] = True
    obj.data.vertices.foreach_set("select", chosen)
    obj.data.edges.foreach_set("select", np.zeros(len(obj.data.edges), bool))
    obj.data.polygons.foreach_set("select", np.zeros(len(obj.data.polygons), bool))
