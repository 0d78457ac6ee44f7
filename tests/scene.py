# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects in the scene of a test: link, select and look at them."""

from __future__ import annotations

import bmesh
import bpy

from convwass_addon.bridge.objects import triangle_mesh


def linked(name, data):
    """Link a new object with some data, or None for an Empty."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def select_only(*objects):
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.select_set(True)


def world(obj):
    """Return the vertices of an object as it is shown, in world space."""
    bpy.context.view_layer.update()
    return triangle_mesh(obj, bpy.context.evaluated_depsgraph_get()).vertices


def height_at(obj, frame):
    """Return the height of an object at a frame of the scene."""
    bpy.context.scene.frame_set(frame)
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    heights = [(obj.matrix_world @ vertex.co).z for vertex in mesh.vertices]
    return max(heights) - min(heights)


def edited(obj, change):
    """Change the mesh of an object as in Edit Mode."""
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    bm.verts.ensure_lookup_table()
    change(bm)
    bm.to_mesh(obj.data)
    bm.free()


def reversed_order(bm):
    bm.verts.sort(key=lambda vertex: -vertex.index)


def without(*vertices):
    def change(bm):
        for vertex in [bm.verts[own] for own in vertices]:
            bm.verts.remove(vertex)

    return change
