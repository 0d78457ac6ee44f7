# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the skies of worlds, and create a world that shows a sequence of skies."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.whole_paths import whole_path
from ..files.image_files import image_path
from ..files.numbered_files import file_number, split_number, with_number
from ..keyframes import clear_animation, curves_of, interpolate, own_action, remove_curve
from ..last_result import last_result
from ..morphs.disk.disk_output import for_blender
from ..morphs.stored import FIRST_FRAMES
from ..nodes.node_trees import own_tree
from ..nodes.shown_nodes import shown_tree, source_node
from ..object_names import without_number
from ..studio.rendered_scene import choose_cycles, run_render
from ..unused_data import remove_if_unused
from .sky_pixels import read_sky, read_sky_file, resized

RESULT_OF = "convwass_skies"
"""Custom property of a world that shows a sequence, its source, and of the node of the images."""

# The disc of a sun covers two to four pixels; fewer samples would miss its edge.
_SAMPLES = 32
# The center of a panorama looks along +X, as in environment images.
_POSE = (math.radians(90.0), 0.0, math.radians(-90.0))


def world_sky(world: bpy.types.World, height: int) -> NDArray[np.float64]:
    """Return the sky of a world, (height, 2 * height, 3), as :func:`.sky_pixels.read_sky` does.

    If the world shows an unmodified environment image, its pixels are returned; otherwise it is rendered with Cycles,
    as it is in the current frame.

    Raises
    ------
    InputError
        The image is not a sky.
    ConvwassError
        The world could not be rendered, or Cycles is disabled.
    """
    image = _plain_image(world)
    return resized(read_sky(image) if image is not None else _rendered(world, height), height)


def _plain_image(world: bpy.types.World) -> bpy.types.Image | None:
    """Return the environment image of a world if it is shown unmodified."""
    tree = shown_tree(world)
    output = tree.get_output_node("CYCLES") if tree is not None else None
    background = _source(output, "Surface", "BACKGROUND")
    texture = _source(background, "Color", "TEX_ENVIRONMENT")
    if texture is None or background.inputs["Strength"].is_linked or texture.inputs["Vector"].is_linked:
        return None
    mapping = texture.texture_mapping
    is_turned = any(mapping.rotation) or any(mapping.translation) or tuple(mapping.scale) != (1.0, 1.0, 1.0)
    image = texture.image
    if is_turned or background.inputs["Strength"].default_value != 1.0 or image is None:
        return None
    return image if image.source != "SEQUENCE" and texture.projection == "EQUIRECTANGULAR" else None


def _source(node: bpy.types.Node | None, name: str, kind: str) -> bpy.types.Node | None:
    found = source_node(node.inputs[name]) if node is not None else None
    return found if found is not None and found.type == kind else None


def _rendered(world: bpy.types.World, height: int) -> NDArray[np.float32]:
    with _panorama(world, height) as scene, _unsampled(world), TemporaryDirectory() as folder:
        file = Path(folder) / "sky.exr"
        scene.render.filepath = str(file)
        run_render(scene, write_still=True)
        return read_sky_file(file)


@contextmanager
def _panorama(world: bpy.types.World, height: int) -> Iterator[bpy.types.Scene]:
    """Provide an empty scene with a panoramic camera."""
    scene = bpy.data.scenes.new("Sky")
    data = bpy.data.cameras.new("Sky")
    camera = bpy.data.objects.new("Sky", data)
    try:
        data.type = "PANO"
        # In Blender 5, this setting moved from Cycles to the camera.
        owner = data if hasattr(data, "panorama_type") else data.cycles
        owner.panorama_type = "EQUIRECTANGULAR"
        camera.rotation_euler = _POSE
        scene.collection.objects.link(camera)
        scene.camera, scene.world = camera, world
        _show_same_time(scene, bpy.context.scene)
        render = scene.render
        choose_cycles(scene)
        render.resolution_percentage = 100
        render.resolution_x, render.resolution_y = 2 * height, height
        render.use_compositing = render.use_sequencer = False
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        cycles = scene.cycles
        cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = _SAMPLES, False, False
        # Pixels must not blur into each other.
        cycles.pixel_filter_type = "BOX"
        yield scene
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.objects.remove(camera)
        bpy.data.cameras.remove(data)


@contextmanager
def _unsampled(world: bpy.types.World) -> Iterator[None]:
    """Let Cycles not find out where the light of a world comes from, which takes a second: it lights nothing."""
    own = world.cycles
    before = own.sampling_method if own.is_property_set("sampling_method") else None
    own.sampling_method = "NONE"
    try:
        yield
    finally:
        if before is None:
            own.property_unset("sampling_method")
        else:
            own.sampling_method = before


def _show_same_time(scene: bpy.types.Scene, shown: bpy.types.Scene) -> None:
    """Let a new scene be at the same time as another one, the current scene, whose frame Blender renders."""
    scene.render.frame_map_old, scene.render.frame_map_new = shown.render.frame_map_old, shown.render.frame_map_new
    scene.frame_set(shown.frame_current, subframe=shown.frame_subframe)


def shown_files(world: bpy.types.World) -> set[Path]:
    """Return the files of the environment images of a world, those of all frames of a sequence."""
    tree = shown_tree(world)
    nodes = [node for node in tree.nodes if node.type == "TEX_ENVIRONMENT"] if tree is not None else []
    return {file for node in nodes for file in _files(node)}


def _files(texture: bpy.types.Node) -> list[Path]:
    image, user = texture.image, texture.image_user
    if image is None or not image.filepath or image.packed_file is not None:
        return []
    path = whole_path(image_path(image))
    if image.source != "SEQUENCE" or split_number(path) is None:
        return [path]
    keys = [key for curve in curves_of(texture.id_data, _number_path(texture)) for key in curve.keyframe_points]
    offsets = [round(key.co[1]) for key in keys] or [user.frame_offset]
    return [with_number(path, own) for own in range(min(offsets) + 1, max(offsets) + user.frame_duration + 1)]


def sequence_world(
    name: str, files: list[Path], first_frame: int, scene: bpy.types.Scene | None = None
) -> bpy.types.World:
    """Create a world that shows one file per frame, or update the one of that name, whose other nodes are kept.

    A world that only other scenes show stays as it is.

    Parameters
    ----------
    name : str
        Name of the world.
    files : list of Path
        Numbered by frame; the first and last files are also shown before and after.
    first_frame : int
        Number of the first frame.
    scene : bpy.types.Scene, optional
        The scene for which it is; by default the current one.
    """
    world = _earlier_world(name, scene or bpy.context.scene) or bpy.data.worlds.new(name)
    world[RESULT_OF] = name
    nodes = own_tree(world).nodes
    texture = next((node for node in nodes if RESULT_OF in node), None) or _new_texture(world.node_tree)
    image = texture.image
    # If the image were removed for a new one, Blender would crash at undo.
    if image is None or image.users > 1 or not image.is_editable:
        image = texture.image = bpy.data.images.load(str(files[0]))
    image.name = name
    image.source, image.filepath = "SEQUENCE", for_blender(files[0])
    # The files of another blend have the same names.
    image.reload()
    _key_numbers(texture, first_frame, len(files))
    return world


def _earlier_world(name: str, scene: bpy.types.Scene) -> bpy.types.World | None:
    """Return the world to update: the one that a scene shows, unless its user has renamed it, or an earlier result."""
    shown, results = scene.world, [item for item in bpy.data.worlds if item.get(RESULT_OF) == name]
    if shown in results and without_number(shown.name) == name:
        return last_result([shown], name)
    elsewhere = {other.world for other in bpy.data.scenes if other != scene}
    return last_result((item for item in results if item not in elsewhere), name)


def _new_texture(tree: bpy.types.NodeTree) -> bpy.types.Node:
    """Replace all nodes by those of a world that shows an environment image; return the node of the image."""
    clear_animation(tree)
    old = {node.image for node in tree.nodes if node.type == "TEX_ENVIRONMENT" and node.image is not None}
    tree.nodes.clear()
    remove_if_unused(old)
    output = tree.nodes.new("ShaderNodeOutputWorld")
    background = tree.nodes.new("ShaderNodeBackground")
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture[RESULT_OF] = True
    background.location, texture.location = (-200.0, 0.0), (-500.0, 0.0)
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    tree.links.new(background.outputs["Background"], output.inputs["Surface"])
    return texture


def _key_numbers(texture: bpy.types.Node, first_frame: int, count: int) -> None:
    """Animate the file of a texture; the first and last files are also shown before and after.

    Without keys, a sequence shows the file before the first one until it starts, which does not exist.
    """
    user, tree, path = texture.image_user, texture.id_data, _number_path(texture)
    user.frame_start, user.frame_duration, user.use_auto_refresh = FIRST_FRAMES[0], 1, True
    own_action(tree)
    remove_curve(tree, path)
    for frame in (first_frame, first_frame + count - 1):
        user.frame_offset = file_number(frame, first_frame) - 1
        tree.keyframe_insert(path, frame=frame)
    interpolate(curves_of(tree, path))


def _number_path(texture: bpy.types.Node) -> str:
    """Return the path of the property that selects the file of a sequence."""
    return f"{texture.path_from_id()}.image_user.frame_offset"
