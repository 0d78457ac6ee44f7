# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Textured and rigged characters for pictures: bodies of the benchmarks in clothes, with an armature."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.objects import write_mesh
from convwass_addon.bridge.studio.rendered_scene import world_points
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.uv_pixels import uv_pixels

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.bipeds import Biped, Posture, degrees, straight

STANDING = Posture(arms=(straight(degrees(out=35)),) * 2, legs=(straight(degrees(out=5)),) * 2)
"""Arms away from the body."""

Clothes = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Returns sRGB colors, (n, 3), at points of a body of height 1, (n, 3)."""

_TEXELS, _MARGIN = 1024, 8


@dataclass(frozen=True)
class Character:
    """A body and its armature."""

    body: bpy.types.Object
    rig: bpy.types.Object


def character(name: str, figure: Biped, clothes: Clothes) -> Character:
    """Add a textured and rigged body to the scene."""
    body = body_object(name, figure.sculpture.mesh())
    paint(body, clothes)
    return Character(body, rigged(body, figure))


def body_object(name: str, mesh: TriangleMesh) -> bpy.types.Object:
    """Add a body to the scene, without texture and armature."""
    data = bpy.data.meshes.new(name)
    write_mesh(data, mesh)
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def paint(body: bpy.types.Object, clothes: Clothes) -> None:
    """Unwrap a body, and paint clothes on a texture."""
    bpy.context.view_layer.objects.active = body
    # All selected meshes would be unwrapped together.
    for obj in bpy.data.objects:
        obj.select_set(obj == body)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(island_margin=0.01)
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh = body.data
    points = world_points(body).astype(np.float64)
    faces = np.array([polygon.vertices for polygon in mesh.polygons])
    uv = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers[0].uv.foreach_get("vector", uv)
    seen = uv_pixels(uv.reshape(-1, 3, 2), faces, _TEXELS, _MARGIN)
    places = np.stack([seen.picture(column) for column in points.T], axis=-1).reshape(-1, 3)
    image = bpy.data.images.new("Clothes", _TEXELS, _TEXELS)
    colors = np.ones((len(places), 4), np.float32)
    colors[:, :3] = clothes(places / points[:, 2].max())
    image.pixels.foreach_set(colors.ravel())
    image.pack()
    mesh.materials.append(_textured(image))


def striped(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the colors of a striped sweater, trousers, shoes and hair; see `Clothes`."""
    x, y, z = places.T
    colors = np.empty((len(places), 3))
    colors[:] = (0.86, 0.62, 0.48)
    sweater = (z > 0.48) & (z < 0.82) & ~((np.abs(x) > 0.42) & (z < 0.62))
    stripes = np.where(np.sin(2.0 * np.pi * z / 0.055)[:, None] > 0.0, (0.75, 0.16, 0.12), (0.93, 0.88, 0.76))
    colors[sweater] = stripes[sweater]
    trousers = (z > 0.09) & (z <= 0.48) & (np.abs(x) < 0.2)
    checks = np.where(np.sin(2 * np.pi * x / 0.03) * np.sin(2 * np.pi * z / 0.03) > 0.0, 1.0, 0.8)
    colors[trousers] = (checks[:, None] * np.array([0.2, 0.3, 0.5]))[trousers]
    colors[(np.abs(z - 0.49) < 0.012) & (np.abs(x) < 0.2)] = (0.25, 0.15, 0.08)
    colors[z <= 0.09] = (0.3, 0.17, 0.08)
    hair = (z > 0.955) | ((z > 0.87) & (y > 0.01) & (np.abs(x) < 0.1))
    colors[hair] = (0.22, 0.12, 0.06)
    for side in (-1.0, 1.0):
        away = np.hypot(x - side * 0.033, z - 0.914)
        eye = (y < -0.06) & (away < 0.016)
        colors[eye] = (0.95, 0.95, 0.92)
        colors[eye & (away < 0.009)] = (0.1, 0.2, 0.25)
    return colors


def _textured(image: bpy.types.Image) -> bpy.types.Material:
    material = bpy.data.materials.new("Clothes")
    nodes = own_tree(material).nodes
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = 0.7
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    material.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    return material


def rigged(body: bpy.types.Object, figure: Biped) -> bpy.types.Object:
    """Give a body an armature through its joints, with Blender's automatic weights."""
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    hips = np.mean([leg[0] for leg in figure.legs], axis=0)
    chest = np.mean([arm[0] for arm in figure.arms], axis=0)
    top = np.array([hips[0], hips[1], world_points(body)[:, 2].max() - 0.05])
    _bones(data, ("pelvis", "spine", "head"), (hips, 0.8 * hips + 0.2 * chest, chest, top), None)
    for side, arm, leg in zip("RL", figure.arms, figure.legs, strict=True):
        _bones(data, (f"upper_arm.{side}", f"forearm.{side}", f"hand.{side}"), arm, "spine")
        _bones(data, (f"thigh.{side}", f"shin.{side}", f"foot.{side}"), leg, "pelvis")
    bpy.ops.object.mode_set(mode="OBJECT")
    for obj in bpy.data.objects:
        obj.select_set(obj in (body, rig))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    return rig


def _bones(data: bpy.types.Armature, names: tuple[str, ...], joints: NDArray[np.float64], parent: str | None) -> None:
    for number, name in enumerate(names):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = joints[number], joints[number + 1]
        bone.parent = data.edit_bones[parent] if parent else None
        parent = name


def turn(bone: bpy.types.PoseBone, axis: str, angle: float) -> None:
    """Rotate a posed bone about an axis of the scene through its head, by degrees."""
    head = Matrix.Translation(bone.head)
    bone.matrix = head @ Matrix.Rotation(math.radians(angle), 4, axis) @ head.inverted() @ bone.matrix
    bpy.context.view_layer.update()


def dotted(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the colors of a dotted shirt, dungarees and boots; see `Clothes`."""
    x, y, z = places.T
    colors = np.empty((len(places), 3))
    colors[:] = (0.47, 0.6, 0.36)
    shirt = (z > 0.42) & (z < 0.82) & ~((np.abs(x) > 0.5) & (z < 0.6))
    across, up = np.sin(2.0 * np.pi * x / 0.07), np.sin(2.0 * np.pi * z / 0.07)
    colors[shirt] = np.where((across * up > 0.45)[:, None], (0.98, 0.9, 0.6), (0.18, 0.42, 0.45))[shirt]
    dungarees = (np.abs(x) < 0.27) & (((z > 0.09) & (z <= 0.5)) | ((y < 0.0) & (z < 0.64) & (np.abs(x) < 0.13)))
    colors[dungarees] = (0.82, 0.52, 0.14)
    colors[z <= 0.09] = (0.16, 0.15, 0.17)
    for side in (-1.0, 1.0):
        away = np.hypot(x - side * 0.04, z - 0.91)
        eye = (y < -0.06) & (away < 0.018)
        colors[eye] = (0.97, 0.93, 0.7)
        colors[eye & (away < 0.01)] = (0.35, 0.08, 0.05)
    return colors
