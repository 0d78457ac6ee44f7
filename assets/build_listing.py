# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the pictures for the extension platform: ``PYTHONPATH=. python assets/build_listing.py``, some minutes.

A leaping horse becomes a dove: all frames are in listing/featured.png, one of them in listing/icon.png.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector
from numpy.typing import NDArray

import convwass_addon
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_trees import own_tree

_ASSETS = Path(__file__).resolve().parent
_FRAMES, _RESOLUTION = 5, 160
# A horse with wings.
_ICON_FRAME = 1
# Linear colors of the frames; interpolations between them are not gray.
_COLORS = ((0.86, 0.21, 0.05), (0.80, 0.10, 0.14), (0.45, 0.08, 0.42), (0.12, 0.14, 0.75), (0.02, 0.32, 0.86))
_NIGHT = (0.012, 0.014, 0.035)


@dataclass(frozen=True)
class Lamp:
    """A soft light: position and target, (3,) each, power in watts, edge length, and color."""

    place: tuple[float, float, float]
    target: tuple[float, float, float]
    power: float
    edge: float
    color: tuple[float, float, float]


def main() -> None:
    """Bake the morph, and render the picture and the icon."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    shapes = _baked()
    _render(_featured_scene(shapes), (1920, 1080), 32, "featured")
    _render(_icon_scene(shapes[_ICON_FRAME]), (256, 256), 160, "icon")


def _baked() -> list[bpy.types.Mesh]:
    """Return the frames from the horse to the dove, including both."""
    inputs = [import_objects(_ASSETS / "shapes" / f"{name}.ply", None)[0] for name in ("horse", "bird")]
    bpy.context.view_layer.objects.active = inputs[0]
    for obj in inputs:
        obj.select_set(True)
    bpy.ops.convwass.bake_morph(
        inputs="horse\nbird",
        frames=_FRAMES,
        resolution=_RESOLUTION,
        motion="TRANSPORT",
        output="OBJECTS",
        hide_inputs=True,
    )
    morph = next(collection for collection in bpy.data.collections if "convwass_morph" in collection)
    meshes = [obj.data for obj in frame_objects(morph)]
    for mesh in meshes:
        mesh.shade_smooth()
    return meshes


def _featured_scene(meshes: list[bpy.types.Mesh]) -> bpy.types.Scene:
    """Arrange all frames, rising from the floor."""
    scene = _dark_scene("Featured")
    count = len(meshes)
    for place, mesh in enumerate(meshes):
        share = place / (count - 1)
        obj = _figure(scene, mesh, _color(share))
        across = 1.95 * (place - 0.5 * (count - 1))
        low = min((obj.matrix_world @ vertex.co).z for vertex in mesh.vertices)
        # From the second frame on, increasingly high and near.
        obj.matrix_world = Matrix.Translation((across, -3.6 * share, 2.9 * share**1.3 - low)) @ obj.matrix_world
    _backdrop(scene)
    for lamp in (
        Lamp((-8.0, -9.0, 11.0), (-1.0, 0.0, 1.5), 2300.0, 4.0, (1.0, 0.94, 0.88)),
        Lamp((9.0, 3.5, 7.0), (1.0, 0.0, 2.0), 1100.0, 3.0, (0.62, 0.76, 1.0)),
        Lamp((-9.0, 3.5, 4.0), (-3.0, 0.0, 1.0), 500.0, 3.0, (1.0, 0.62, 0.42)),
        Lamp((6.0, -12.0, 2.0), (3.0, 0.0, 3.0), 420.0, 8.0, (0.75, 0.85, 1.0)),
    ):
        _hang(scene, lamp)
    _look(scene, (0.0, -24.0, 3.0), (0.65, 0.0, 2.35), 32.0)
    return scene


def _icon_scene(mesh: bpy.types.Mesh) -> bpy.types.Scene:
    """Arrange a single shape without a floor, in the colors of both ends."""
    scene = _dark_scene("Icon")
    scene.render.film_transparent = True
    scene.render.image_settings.color_mode = "RGBA"
    obj = _figure(scene, mesh, _color(0.5))
    _shade_across(mesh)
    points = np.array([obj.matrix_world @ vertex.co for vertex in mesh.vertices])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    obj.matrix_world = Matrix.Translation(-middle) @ obj.matrix_world
    for lamp in (
        Lamp((-3.0, -5.0, 5.0), (0.0, 0.0, 0.0), 700.0, 3.0, (1.0, 0.95, 0.9)),
        Lamp((4.0, 3.0, 3.0), (0.0, 0.0, 0.0), 500.0, 2.0, (0.7, 0.85, 1.0)),
        Lamp((3.0, -5.0, -1.0), (0.0, 0.0, 0.0), 160.0, 4.0, (0.8, 0.85, 1.0)),
    ):
        _hang(scene, lamp)
    _look(scene, (0.0, -12.0, 1.2), (0.0, 0.0, 0.0), 10.6)
    return scene


def _dark_scene(name: str) -> bpy.types.Scene:
    """Create an empty dark scene for Cycles."""
    scene = bpy.data.scenes.new(name)
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.render.image_settings.color_mode = "RGB"
    # The file must not contain the place and time of its creation.
    for name in (prop.identifier for prop in scene.render.bl_rna.properties):
        if name.startswith("use_stamp_"):
            setattr(scene.render, name, False)
    scene.cycles.use_denoising = True
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Punchy"
    scene.world = bpy.data.worlds.new(name)
    own_tree(scene.world).nodes["Background"].inputs["Color"].default_value = (*_NIGHT, 1.0)
    return scene


def _figure(scene: bpy.types.Scene, mesh: bpy.types.Mesh, color: NDArray[np.float64]) -> bpy.types.Object:
    """Add a mesh to a scene, rotated slightly towards the viewer, in a linear color, (3,)."""
    obj = bpy.data.objects.new(mesh.name, mesh)
    scene.collection.objects.link(obj)
    if len(mesh.vertices) < 10_000:
        obj.modifiers.new("Round", "SUBSURF").render_levels = 3
    points = np.array([vertex.co for vertex in mesh.vertices])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    obj.matrix_world = Matrix.Rotation(math.radians(-24.0), 4, "Z") @ Matrix.Translation(-Vector(middle))
    material = bpy.data.materials.new(mesh.name)
    shader = own_tree(material).nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = 0.38
    shader.inputs["Coat Weight"].default_value = 0.35
    shader.inputs["Coat Roughness"].default_value = 0.15
    mesh.materials.clear()
    mesh.materials.append(material)
    return obj


def _color(share: float) -> NDArray[np.float64]:
    """Return the color at a fraction of the path, linear, (3,)."""
    places = np.linspace(0.0, 1.0, len(_COLORS))
    return np.array([np.interp(share, places, channel) for channel in zip(*_COLORS, strict=True)])


def _shade_across(mesh: bpy.types.Mesh) -> None:
    """Color a mesh from its lowest to its highest corner with the colors of the path."""
    points = np.array([vertex.co for vertex in mesh.vertices])
    along = points @ (-0.75, 0.0, 1.0)
    share = (along - along.min()) / np.ptp(along)
    colors = np.ones((len(points), 4), dtype=np.float32)
    colors[:, :3] = [_color(one) for one in np.clip(1.35 * share - 0.2, 0.0, 1.0)]
    mesh.color_attributes.new("Way", "FLOAT_COLOR", "POINT").data.foreach_set("color", colors.ravel())
    tree = mesh.materials[0].node_tree
    source = tree.nodes.new("ShaderNodeVertexColor")
    source.layer_name = "Way"
    tree.links.new(source.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])


def _backdrop(scene: bpy.types.Scene) -> None:
    """Add a matte floor that curves into a wall."""
    turns = np.linspace(0.0, 0.5 * math.pi, 33)
    profile = [(-40.0, 0.0), *((4.0 + 7.0 * math.sin(t), 7.0 - 7.0 * math.cos(t)) for t in turns), (11.0, 60.0)]
    vertices = [(x, y, z) for y, z in profile for x in (-90.0, 90.0)]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(profile) - 1)]
    mesh = bpy.data.meshes.new("Backdrop")
    mesh.from_pydata(vertices, [], faces)
    mesh.shade_smooth()
    material = bpy.data.materials.new("Backdrop")
    shader = own_tree(material).nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.07, 0.085, 0.21, 1.0)
    shader.inputs["Roughness"].default_value = 1.0
    shader.inputs["Specular IOR Level"].default_value = 0.0
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Backdrop", mesh))


def _hang(scene: bpy.types.Scene, lamp: Lamp) -> None:
    light = bpy.data.lights.new("Lamp", "AREA")
    light.energy, light.size, light.color = lamp.power, lamp.edge, lamp.color
    obj = bpy.data.objects.new("Lamp", light)
    _aim(obj, Vector(lamp.place), Vector(lamp.target))
    scene.collection.objects.link(obj)


def _look(scene: bpy.types.Scene, place: tuple[float, ...], target: tuple[float, ...], degrees: float) -> None:
    camera = bpy.data.cameras.new("Camera")
    camera.angle = math.radians(degrees)
    scene.camera = bpy.data.objects.new("Camera", camera)
    _aim(scene.camera, Vector(place), Vector(target))
    scene.collection.objects.link(scene.camera)


def _aim(obj: bpy.types.Object, place: Vector, target: Vector) -> None:
    """Place a camera or a lamp, aimed at a point."""
    obj.matrix_world = Matrix.Translation(place) @ (place - target).to_track_quat("Z", "Y").to_matrix().to_4x4()


def _render(scene: bpy.types.Scene, size: tuple[int, int], samples: int, name: str) -> None:
    """Render listing/NAME.png with this many samples per pixel, and denoise it."""
    render = scene.render
    render.resolution_x, render.resolution_y = size
    scene.cycles.samples = samples
    render.image_settings.file_format = "PNG"
    render.image_settings.compression = 100
    render.filepath = str(_ASSETS / "listing" / f"{name}.png")
    bpy.ops.render.render(write_still=True, scene=scene.name)


if __name__ == "__main__":
    main()
