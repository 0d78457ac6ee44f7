# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw docs/pictures/skeletons.jpg, skeletons in bodies as in Fig. 9: ``python3 run.py python docs/skeletons.py``.

Green joints were pinned, blue ones placed by the fit. From the left: horse, bird, octopus and double torus; then the
octopus bound to its bones by Blender's automatic weights, and posed.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray
from photographs import PROJECT, sample_shape, save_jpeg

import convwass_addon
from convwass_addon.applications.skeletons.skeleton_fit import fit_steps
from convwass_addon.applications.skeletons.skeleton_graph import JointGraph
from convwass_addon.applications.skeletons.skeleton_settings import SkeletonSettings
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.progress import drained

_BODIES = ("horse", "bird", "octopus", "double_torus")
_STEP = 2.15
_SIZE = (2800, 700)
_COLORS = {"free": (0.05, 0.2, 0.9), "pinned": (0.05, 0.6, 0.15), "bone": (0.9, 0.7, 0.25)}
# Rotation of every bone of an arm, in degrees.
_CURL = (28.0, 10.0)


def main() -> None:
    """Fit, bind, pose and render."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    glass, skin = _material("glass", (0.5, 0.56, 0.68), 0.22), _material("skin", (0.85, 0.45, 0.3), 1.0)
    colors = {name: _material(name, color, 1.0) for name, color in _COLORS.items()}
    view = Vector((math.cos(math.radians(-64.0)), math.sin(math.radians(-64.0)), 0.22)).normalized()
    right = Vector((0.0, 0.0, 1.0)).cross(view).normalized()
    known = json.loads((PROJECT / "benchmarks" / "skeletons.json").read_text())
    for column, name in enumerate(_BODIES):
        body = _read(name)
        body.data.materials.append(glass)
        graph = _graph(known[name])
        joints = _fitted(body, graph)
        shift = column * _STEP * right
        body.location = shift
        _draw(joints + np.array(shift), graph, colors)
    posed = _posed(_read("octopus"), known["octopus"])
    posed.location = len(_BODIES) * _STEP * right
    posed.data.materials.append(skin)
    middle = Vector((0.0, 0.0, 0.97)) + len(_BODIES) / 2 * _STEP * right
    _render(middle, view, _STEP * (len(_BODIES) + 1))


def _material(name: str, color: Sequence[float], alpha: float) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Alpha"].default_value = alpha
    shader.inputs["Roughness"].default_value = 0.45
    return material


def _read(name: str) -> bpy.types.Object:
    obj = sample_shape(name)
    obj.data.shade_smooth()
    return obj


def _graph(known: dict) -> JointGraph:
    names = list(known["joints"])
    bones = [[names.index(end) for end in bone] for bone in known["bones"]]
    return JointGraph.from_arrays(
        list(known["joints"].values()), bones, [name in known["pinned"] for name in names], tuple(names)
    )


def _fitted(body: bpy.types.Object, graph: JointGraph) -> NDArray[np.float64]:
    mesh = triangle_mesh(body, bpy.context.evaluated_depsgraph_get())
    return drained(fit_steps(mesh, graph, SkeletonSettings())).positions


def _draw(joints: NDArray[np.float64], graph: JointGraph, colors: dict[str, bpy.types.Material]) -> None:
    for place, is_pinned in zip(joints, graph.pinned, strict=True):
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.036, location=place, segments=24, ring_count=12)
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(colors["pinned" if is_pinned else "free"])
    for first, second in graph.edges:
        way = Vector(joints[second] - joints[first])
        middle = (joints[first] + joints[second]) / 2
        bpy.ops.mesh.primitive_cylinder_add(radius=0.012, depth=way.length, location=middle, vertices=16)
        bpy.context.object.rotation_euler = way.to_track_quat("Z", "Y").to_euler()
        bpy.context.object.data.materials.append(colors["bone"])


def _posed(body: bpy.types.Object, known: dict) -> bpy.types.Object:
    """Fit an armature into a body by the operators, bind it by automatic weights, and curl its arms."""
    graph = _graph(known)
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bones = {}
    for first, second in graph.edges:
        bone = rig.data.edit_bones.new(graph.names[second])
        bone.head, bone.tail = graph.positions[first], graph.positions[second]
        bones[int(second)] = bone
    for (first, second), bone in zip(graph.edges, rig.data.edit_bones, strict=True):
        if int(first) in bones:
            bone.parent, bone.use_connect = bones[int(first)], True
        bone.select = bone.select_head = False
        bone.select_tail = bool(graph.pinned[second])
    settings = bpy.context.scene.convwass_armature
    settings.body, settings.rig = body, rig
    bpy.ops.convwass.pin_joints()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.convwass.fit_armature(auto_weights=True)
    for bone in rig.pose.bones:
        bone.rotation_mode = "XYZ"
        if bone.parent is not None:
            bone.rotation_euler = [math.radians(_CURL[0]), 0.0, math.radians(_CURL[1])]
    bpy.context.view_layer.update()
    seen = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
    copy = bpy.data.objects.new("Posed", bpy.data.meshes.new_from_object(seen))
    bpy.context.collection.objects.link(copy)
    for obj in (body, rig):
        obj.hide_render = True
    return copy


def _render(middle: Vector, view: Vector, width: float) -> None:
    scene = bpy.context.scene
    world = bpy.data.worlds.new("White")
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.9
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    scene.world = world
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 2.0, (0.6, 0.3, 0.4)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", width
    camera.location = middle + 30.0 * view
    camera.rotation_euler = (-view).to_track_quat("-Z", "Y").to_euler()
    for obj in (sun, camera):
        scene.collection.objects.link(obj)
    scene.camera = camera
    scene.render.engine, scene.cycles.samples, scene.cycles.transparent_max_bounces = "CYCLES", 32, 40
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = _SIZE
    with TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "skeletons.png")
        bpy.ops.render.render(write_still=True)
        save_jpeg(Path(scene.render.filepath), "skeletons")


if __name__ == "__main__":
    main()
