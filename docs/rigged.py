# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw a rigged character with a texture that morphs on its own mesh, docs/pictures/rigged.jpg.

``python3 run.py python docs/rigged.py``. ``--glb FILE`` also exports it for other programs.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray
from PIL import Image

import convwass_addon
from convwass_addon.bridge.framing import Pose, View
from convwass_addon.bridge.objects import write_mesh
from convwass_addon.bridge.studio import Studio, world_points
from convwass_addon.geometry.mesh import TriangleMesh
from convwass_addon.geometry.uv_pixels import uv_pixels

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.bipeds import MAN, OGRE, Biped, Posture, biped, degrees, straight

PICTURE = Path(__file__).resolve().parent / "pictures" / "rigged.jpg"
SLIDER = (0.0, 0.25, 0.5, 0.75, 1.0)

_STANDING = Posture(arms=(straight(degrees(out=35)),) * 2, legs=(straight(degrees(out=5)),) * 2)
_TEXELS, _MARGIN = 1024, 8
# Distance of the figures, the picture of a row in pixels, light paths per pixel, per cent of JPEG.
_STEP, _ROW, _SAMPLES, _QUALITY = 1.9, (1500, 390), 24, 88
_VIEW = View(math.radians(-72.0), math.radians(8.0))
# Rotations of bones for the second row, from the root on: axis in the scene, and degrees.
_WAVING = (
    ("spine", "Y", 7.0),
    ("upper_arm.R", "Y", -85.0),
    ("forearm.R", "Y", -50.0),
    ("upper_arm.L", "X", -30.0),
    ("forearm.L", "X", -35.0),
    ("thigh.L", "X", -30.0),
    ("shin.L", "X", 35.0),
    ("thigh.R", "X", 15.0),
)


def main() -> None:
    """Make the character, bake its shape keys, and draw it at rest and posed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--glb", type=Path, help="also write the mesh with keys and armature to this file")
    options = parser.parse_args()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    man, ogre = biped(MAN, _STANDING, 5), biped(OGRE, _STANDING, 6)
    body = _object("Man", man.sculpture.mesh())
    _object("Ogre", ogre.sculpture.mesh())
    _paint(body)
    rig = _rigged(body, man)
    bpy.ops.convwass.bake_morph(inputs="Man,Ogre", output="SHAPE_KEYS", frames=24)
    obj = bpy.data.objects["Man Morph"]
    obj.animation_data.action = None
    rows = [_row(obj)]
    for name, axis, angle in _WAVING:
        _turn(rig.pose.bones[name], axis, angle)
    rows.append(_row(obj))
    if options.glb:
        _export(obj, options.glb)
    whole = Image.new("RGB", (rows[0].width, sum(row.height for row in rows)))
    for number, row in enumerate(rows):
        whole.paste(row, (0, number * row.height))
    whole.save(PICTURE, quality=_QUALITY)
    print(f"{PICTURE.name}: {PICTURE.stat().st_size / 1e3:.0f} kB")


def _object(name: str, mesh: TriangleMesh) -> bpy.types.Object:
    data = bpy.data.meshes.new(name)
    write_mesh(data, mesh)
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def _paint(body: bpy.types.Object) -> None:
    """Unwrap a body, and paint clothes on a texture."""
    bpy.context.view_layer.objects.active = body
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
    colors[:, :3] = _clothes(places / points[:, 2].max())
    image.pixels.foreach_set(colors.ravel())
    image.pack()
    mesh.materials.append(_textured(image))


def _clothes(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the colors, sRGB, of a striped sweater, trousers, shoes and gloves on a body of height 1, (n, 3)."""
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
    if material.node_tree is None:  # Blender 4.5
        material.use_nodes = True
    nodes = material.node_tree.nodes
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = 0.7
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    material.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    return material


def _rigged(body: bpy.types.Object, man: Biped) -> bpy.types.Object:
    """Give a body an armature through its joints, with Blender's automatic weights."""
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    hips = np.mean([leg[0] for leg in man.legs], axis=0)
    chest = np.mean([arm[0] for arm in man.arms], axis=0)
    top = np.array([hips[0], hips[1], world_points(body)[:, 2].max() - 0.05])
    _bones(data, ("pelvis", "spine", "head"), (hips, 0.8 * hips + 0.2 * chest, chest, top), None)
    for side, arm, leg in zip("RL", man.arms, man.legs, strict=True):
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


def _turn(bone: bpy.types.PoseBone, axis: str, angle: float) -> None:
    """Rotate a posed bone about an axis of the scene through its head, by degrees."""
    head = Matrix.Translation(bone.head)
    bone.matrix = head @ Matrix.Rotation(math.radians(angle), 4, axis) @ head.inverted() @ bone.matrix
    bpy.context.view_layer.update()


def _row(obj: bpy.types.Object) -> Image.Image:
    """Render the character at some values of its slider, side by side."""
    graph, shown = bpy.context.evaluated_depsgraph_get(), []
    for value in SLIDER:
        obj["Ogre"] = value
        obj.update_tag()
        graph.update()
        mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(graph), depsgraph=graph)
        shown.append(bpy.data.objects.new("Figure", mesh))
    with Studio() as studio, TemporaryDirectory() as folder:
        across = _VIEW.axes[0]
        copies = [studio.show(one, _STEP * number * across) for number, one in enumerate(shown)]
        points = [world_points(one) for one in copies]
        studio.build(points, _VIEW)
        joined = np.concatenate(points)
        middle = (joined.min(axis=0) + joined.max(axis=0)) / 2.0
        studio.look_flat(Pose(middle + 50.0 * _VIEW.axes[2], _VIEW), _STEP * len(shown), 200.0)
        studio.set_quality(_ROW, _SAMPLES)
        studio.render(Path(folder) / "row.png")
        with Image.open(Path(folder) / "row.png") as picture:
            return picture.convert("RGB")


def _export(obj: bpy.types.Object, target: Path) -> None:
    """Animate the slider and write a file for other programs."""
    from convwass_addon.bridge.one_mesh.key_files import export_shape_keys

    for frame, value in ((1, 0.0), (25, 1.0)):
        obj["Ogre"] = value
        obj.keyframe_insert('["Ogre"]', frame=frame)
    export_shape_keys(obj, target)


if __name__ == "__main__":
    main()
