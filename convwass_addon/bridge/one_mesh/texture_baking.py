# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake one channel of a look to an array of pixels with Cycles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import ConvwassError
from ..color_spaces import DATA, color_space
from ..files.image_files import pixel_values
from ..files.scratch_scene import scratch_scene
from ..nodes.node_trees import own_tree
from ..nodes.shown_nodes import nodes_of
from ..operator_errors import reason
from .texture_channels import NORMAL, Channel, ShownChannel, shown_channel
from .texture_looks import Look


@dataclass(frozen=True)
class TextureSize:
    """How images are baked.

    Attributes
    ----------
    pixels : int
        Along a side.
    samples : int
        Samples per pixel.
    uv_map : str
        Name of the UV map.
    """

    pixels: int
    samples: int
    uv_map: str


def baked_pixels(look: Look, channel: Channel, size: TextureSize, reach: float) -> NDArray[np.float32]:
    """Bake a channel of a look.

    Parameters
    ----------
    look : Look
        The surfaces.
    channel : Channel
        What to bake; `NORMAL` gives a normal map in tangent space.
    size : TextureSize
        How to bake it.
    reach : float
        Largest distance between mesh and shape, scene units.

    Returns
    -------
    (size, size, 4) float32
        Linear values, rows from the bottom; alpha is 0 where there is no surface within reach.

    Raises
    ------
    ConvwassError
        Cycles could not bake.
    """
    image = bpy.data.images.new("Baking", size.pixels, size.pixels, alpha=True, float_buffer=True)
    image.colorspace_settings.name = color_space(DATA)
    # Blender would clear the image with an alpha of 1.
    image.pixels.foreach_set(np.zeros(4 * size.pixels**2, np.float32))
    try:
        with scratch_scene() as scene, _made_objects(look, scene) as objects, _shown(objects[-1], channel) as materials:
            receiving = materials if look.shape is None else [_receiver(objects[0])]
            for material in receiving:
                _receive(material, image)
            look.scene.write_to(scene)
            _tag_keyframes(materials)
            try:
                _bake(scene, objects, channel, size, reach)
            finally:
                if look.shape is not None:
                    bpy.data.materials.remove(receiving[0])
        return pixel_values(image)
    finally:
        bpy.data.images.remove(image)


@contextmanager
def _made_objects(look: Look, scene: bpy.types.Scene) -> Iterator[list[bpy.types.Object]]:
    """Link the mesh, and the shape if it is another one, to a scene."""
    objects = [look.onto.object_in(scene, "Onto")]
    try:
        if look.shape is not None:
            objects.append(look.shape.object_in(scene, "Shape"))
        yield objects
    finally:
        needed = [block for obj in objects for block in (obj.data, obj.parent) if block is not None]
        bpy.data.batch_remove([*objects, *needed])


@contextmanager
def _shown(obj: bpy.types.Object, channel: Channel) -> Iterator[list[bpy.types.Material]]:
    """Let the materials of an object emit a channel; normals are baked from copies of its materials."""
    mesh = obj.data
    if not len(mesh.materials):
        mesh.materials.append(None)
    shown: list[ShownChannel] = []
    try:
        for place, material in enumerate(mesh.materials):
            if channel == NORMAL and material is not None:
                shown.append(ShownChannel(material.copy(), [], None))
            else:
                shown.append(shown_channel(material, channel))
            mesh.materials[place] = shown[-1].material
        yield [own.material for own in shown]
    finally:
        mesh.materials.clear()
        bpy.data.batch_remove([block for own in shown for block in (own.material, *own.groups)])


def _receiver(obj: bpy.types.Object) -> bpy.types.Material:
    """Give an object a single new material."""
    mesh, material = obj.data, bpy.data.materials.new("Onto")
    mesh.materials.clear()
    mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", np.zeros(len(mesh.polygons), np.int32))
    return material


def _receive(material: bpy.types.Material, image: bpy.types.Image) -> None:
    """Let a bake of a material go to an image."""
    tree = own_tree(material)
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    for own in tree.nodes:
        own.select = own == node
    tree.nodes.active = node


def _tag_keyframes(materials: Sequence[bpy.types.Material]) -> None:
    """Let a bake evaluate the keyframes of materials.

    By default, it shows the values of the frame that the user looks at when the materials are copied.
    """
    for tree in {node.id_data for node in nodes_of(materials)}:
        tree.update_tag(refresh={"TIME"})


def _bake(
    scene: bpy.types.Scene, objects: Sequence[bpy.types.Object], channel: Channel, size: TextureSize, reach: float
) -> None:
    """Bake the last object onto the first one, or a single object onto itself."""
    layer = scene.view_layers[0]
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", size.samples, False
    scene.cycles.use_adaptive_sampling = False
    for obj in objects:
        obj.select_set(True, view_layer=layer)
    layer.objects.active = objects[0]
    layer.update()
    how = {
        "type": "NORMAL" if channel == NORMAL else "EMIT",
        "use_selected_to_active": len(objects) > 1,
        "cage_extrusion": reach,
        "max_ray_distance": 2.0 * reach,
        "margin": 0,
        "use_clear": False,
        "target": "IMAGE_TEXTURES",
        "uv_layer": size.uv_map,
    }
    context = {"active_object": objects[0], "object": objects[0], "selected_objects": list(objects)}
    with bpy.context.temp_override(scene=scene, view_layer=layer, **context):
        try:
            bpy.ops.object.bake(**how)
        except RuntimeError as error:
            values = {"channel": channel.name, "reason": reason(error)}
            raise ConvwassError("Cycles could not bake {channel}: {reason}", **values) from error
