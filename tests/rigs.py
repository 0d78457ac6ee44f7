# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures, bodies for them, and a fit known without solving."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Vector

from convwass_addon.applications.skeletons.skeleton_fit import FittedSkeleton
from convwass_addon.progress import UNINTERRUPTED, Progress
from convwass_addon.sentence import Sentence


def own():
    return bpy.context.scene.convwass_armature


def tube(length=4.0, radius=0.4, **placed):
    """Add a closed tube from the origin along X."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=12, radius=radius, depth=length, **placed)
    obj = bpy.context.object
    obj.name = obj.data.name = "Tube"
    points = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", points)
    points = points.reshape(-1, 3)
    points = np.stack([points[:, 2] + length / 2, points[:, 0], points[:, 1]], axis=1)
    obj.data.vertices.foreach_set("co", points.ravel())
    obj.data.update()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide(number_cuts=3)
    bpy.ops.mesh.quads_convert_to_tris()
    bpy.ops.object.mode_set(mode="OBJECT")
    return obj


def armature(bones, name="Rig"):
    """Add an armature of bones: (name, head, tail, parent or None, whether it is connected)."""
    data = bpy.data.armatures.new(name)
    obj = bpy.data.objects.new(name, data)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    for bone_name, head, tail, parent, is_connected in bones:
        bone = data.edit_bones.new(bone_name)
        bone.head, bone.tail = head, tail
        bone.parent = data.edit_bones[parent] if parent else None
        bone.use_connect = is_connected
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    return obj


def chain(count=3, length=1.0, name="Rig"):
    """Add an armature of connected bones A, B, C, ... along X."""
    names = [chr(ord("A") + place) for place in range(count)]
    ends = [((place * length, 0, 0), ((place + 1) * length, 0, 0)) for place in range(count)]
    parents = [None, *names]
    return armature(
        [(own, *ends[place], parents[place], place > 0) for place, own in enumerate(names)],
        name,
    )


def lines(points, edges, name="Lines"):
    """Add a mesh of edges."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, edges, [])
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return obj


def choose(body, rig):
    own().body, own().rig = body, rig


def world_ends(obj):
    """Return the heads and tails of all bones at rest, world space."""
    return {
        f"{bone.name}.{side}": np.array(obj.matrix_world @ Vector(getattr(bone, f"{side}_local")))
        for bone in obj.data.bones
        for side in ("head", "tail")
    }


def select_joints(obj, *ends):
    """Select only these ends of bones, in Edit Mode."""
    for bone in obj.data.edit_bones:
        bone.select = False
        for side in ("head", "tail"):
            setattr(bone, f"select_{side}", f"{bone.name}.{side}" in ends)


def harmonic_steps(mesh, graph, settings, control=UNINTERRUPTED):
    """Place free joints at the means of their neighbors, weighted by the inverse bone lengths."""
    yield Progress(0.0, Sentence("Starting"))
    control.check()
    yield Progress(1.0, Sentence("Writing"))
    return harmonic(graph)


def harmonic(graph, notices=()):
    count = len(graph.positions)
    laplacian = np.zeros((count, count))
    for (a, b), length in zip(graph.edges, graph.lengths, strict=True):
        laplacian[[a, a, b, b], [b, a, a, b]] += np.array([-1, 1, -1, 1]) / length
    positions, free = graph.positions.copy(), ~graph.pinned
    known = -laplacian[np.ix_(free, graph.pinned)] @ positions[graph.pinned]
    positions[free] = np.linalg.solve(laplacian[np.ix_(free, free)], known)
    inside = np.ones(count, bool)
    return FittedSkeleton(positions, inside, np.ones(count), ~inside, {"converged": True}, tuple(notices))


def bend_by_two_bones(bar, reach, location=(0.0, 0.0, 0.0)):
    """Add an armature with two bones along X, from -reach to 0 to reach, to a mesh, with smooth weights."""
    bpy.ops.object.armature_add(location=location)
    rig = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bones = rig.data.edit_bones
    bones[0].name, bones[0].head, bones[0].tail = "Lower", (-reach, 0, 0), (0, 0, 0)
    upper = bones.new("Upper")
    upper.head, upper.tail, upper.parent = (0, 0, 0), (reach, 0, 0), bones["Lower"]
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, sign in (("Lower", -1.0), ("Upper", 1.0)):
        group = bar.vertex_groups.new(name=name)
        for vertex in bar.data.vertices:
            group.add([vertex.index], float(np.clip(0.5 + sign * vertex.co.x, 0.0, 1.0)), "REPLACE")
    bar.modifiers.new("Rig", "ARMATURE").object = rig
    return rig
