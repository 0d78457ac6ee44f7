# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes with textures and procedural materials, and pictures of them, for measuring what frames show of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import Blend
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_trees import own_tree

# Islands of the cube: their width and distances in the texture.
_ISLAND, _ACROSS, _UP = 0.3, 0.33, 0.5


def empty_scene() -> bpy.types.Scene:
    """Return the scene of a new file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene


def textured_sphere(material: bpy.types.Material) -> bpy.types.Object:
    """Add a UV sphere of radius 1.1, whose map repeats at one seam."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1.1)
    sphere = bpy.context.object
    sphere.data.shade_smooth()
    sphere.data.materials.append(material)
    return sphere


def textured_cube(material: bpy.types.Material) -> bpy.types.Object:
    """Add a cube of edge length 1.8 with six separate islands."""
    bpy.ops.mesh.primitive_cube_add(size=1.8)
    cube = bpy.context.object
    layer = cube.data.uv_layers.active
    for polygon in cube.data.polygons:
        axis = max(range(3), key=lambda i: abs(polygon.normal[i]))
        side = 2 * axis + (polygon.normal[axis] > 0)
        corner = np.array([_ACROSS * (side % 3), _UP * (side // 3)])
        for loop in polygon.loop_indices:
            place = np.delete(np.array(cube.data.vertices[cube.data.loops[loop].vertex_index].co), axis)
            layer.uv[loop].vector = corner + _ISLAND * (place / 1.8 + 0.5)
    cube.data.materials.append(material)
    return cube


def checkered_material(name: str) -> bpy.types.Material:
    """Return a glowing material with a checkerboard of single pixels."""
    size = 2048
    rows, columns = np.indices((size, size))
    pixels = np.ones((size, size, 4), np.float32)
    pixels[..., :3] = ((rows + columns) % 2)[..., None]
    image = bpy.data.images.new(name, size, size)
    image.pixels.foreach_set(pixels.ravel())
    material = bpy.data.materials.new(name)
    tree = own_tree(material)
    tree.nodes.clear()
    texture, glow = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeEmission")
    texture.image, texture.interpolation = image, "Closest"
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(texture.outputs["Color"], glow.inputs["Color"])
    tree.links.new(glow.outputs[0], output.inputs["Surface"])
    return material


def add_object_coordinates(material: bpy.types.Material) -> None:
    """Let the strength of a glowing material depend on object coordinates, so that frames carry them."""
    tree = own_tree(material)
    place, noise = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexNoise")
    glow = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], glow.inputs["Strength"])


def three_materials() -> list[bpy.types.Material]:
    """Return a normal-mapped image, noise in object coordinates with bumps, and metal bricks without coordinates."""
    materials = [bpy.data.materials.new(name) for name in ("Mapped", "Noisy", "Bricks")]
    mapped, noisy, bricks = (own_tree(material) for material in materials)
    rows, columns = np.indices((256, 256)) / 256.0
    colors = np.stack([0.5 + 0.5 * np.sin(40 * rows), columns, 0.4 + 0 * rows, 1 + 0 * rows], axis=2)
    waves = 0.5 + 0.3 * np.stack([np.sin(120 * columns), np.cos(90 * rows), np.full_like(rows, 1.6)], axis=2)
    normals = np.concatenate([waves, np.ones((256, 256, 1))], axis=2)
    texture = _image_node(mapped, "Colors", colors, "sRGB")
    mapped.links.new(texture.outputs["Color"], mapped.nodes["Principled BSDF"].inputs["Base Color"])
    texture = _image_node(mapped, "Normals", normals, "Non-Color")
    bump = mapped.nodes.new("ShaderNodeNormalMap")
    mapped.links.new(texture.outputs["Color"], bump.inputs["Color"])
    mapped.links.new(bump.outputs["Normal"], mapped.nodes["Principled BSDF"].inputs["Normal"])
    _add_noise(noisy)
    texture = bricks.nodes.new("ShaderNodeTexBrick")
    shader = bricks.nodes["Principled BSDF"]
    shader.inputs["Metallic"].default_value, shader.inputs["Roughness"].default_value = 1.0, 0.3
    bricks.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    return materials


def _add_noise(tree: bpy.types.NodeTree) -> None:
    place, noise = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexNoise")
    ramp, bump = tree.nodes.new("ShaderNodeValToRGB"), tree.nodes.new("ShaderNodeBump")
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.9, 0.3, 0.1, 1), (0.05, 0.1, 0.3, 1)
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.45, 0.55
    noise.inputs["Scale"].default_value = 6.0
    shader = tree.nodes["Principled BSDF"]
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], ramp.inputs["Fac"])
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(ramp.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])


def _image_node(tree: bpy.types.NodeTree, name: str, pixels: NDArray[np.float64], space: str) -> bpy.types.Node:
    image = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0])
    # A change of the color space clears images that are not packed.
    image.colorspace_settings.name = space
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    image.pack()
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    return node


def baked(
    inputs: Sequence[bpy.types.Object],
    blends: Sequence[Blend],
    cells: int,
    looks: str = "FADE",
    motion: str = "automatic",
) -> list[bpy.types.Object]:
    """Bake a morph with one thread, and return its frames, visible at all times."""
    job = MorphJob(inputs, blends, MorphSettings(cells, motion=motion), {"looks": looks}, 1)
    for step in job.steps(computation=Computation(workers=1)):
        job.write(step)
    frames = frame_objects(job.finish(hide_inputs=False))
    for frame in frames:
        frame.animation_data_clear()
    return frames


def pictured(
    obj: bpy.types.Object, direction: Sequence[float], width: float, pixels: int, samples: int
) -> NDArray[np.float64]:
    """Render an object alone from a direction with Cycles on the CPU, (h, w, 4) with its alpha, as displayed.

    Parameters
    ----------
    obj : bpy.types.Object
        At the origin.
    direction : (x, y, z)
        From the origin to the camera.
    width : float
        Width of the picture in the scene.
    pixels, samples : int
        Width of the picture in pixels, and light paths per pixel.
    """
    scene = bpy.context.scene
    for other in scene.objects:
        other.hide_render = other != obj and other.type == "MESH"
    obj.hide_viewport = False
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", width
    toward = Vector(direction).normalized()
    camera.location, camera.rotation_euler = 20.0 * toward, toward.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", samples
    scene.cycles.use_denoising, scene.render.film_transparent = False, True
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.resolution_x = scene.render.resolution_y = pixels
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format, scene.render.image_settings.color_mode = "PNG", "RGBA"
    with TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "picture.png")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        values = np.array(image.pixels).reshape(pixels, pixels, 4)
        bpy.data.images.remove(image)
    bpy.data.objects.remove(camera)
    return values


def add_light(strength: float = 1.0) -> None:
    """Add a white world and a sun."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    own_tree(scene.world).nodes["Background"].inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 2.0 * strength, (0.6, 0.3, 0.4)
    scene.collection.objects.link(sun)
