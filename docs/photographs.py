# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared functions of the scripts in this folder that render pictures; requires Blender's module bpy."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from PIL import Image

from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.studio.framing import Pose, View
from convwass_addon.bridge.studio.rendered_scene import Studio, world_points

PROJECT = Path(__file__).resolve().parents[1]

# Samples per pixel, and JPEG quality.
_SAMPLES, _QUALITY = 24, 90


def sample_shape(name: str) -> bpy.types.Object:
    """Import one of the sample shapes."""
    (obj,) = import_objects(PROJECT / "assets" / "shapes" / f"{name}.ply", None)
    return obj


def finer(obj: bpy.types.Object, levels: int) -> bpy.types.Object:
    """Subdivide an object `levels` times, activate it, and return it."""
    modifier = obj.modifiers.new("Finer", "SUBSURF")
    modifier.levels = levels
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    return obj


def color_material(name: str, attribute: str, roughness: float = 0.5) -> bpy.types.Material:
    """Make a material that shows a color attribute; a new one has the roughness 0.5."""
    material = bpy.data.materials.new(name)
    nodes = own_tree(material).nodes
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = roughness
    source = nodes.new("ShaderNodeVertexColor")
    source.layer_name = attribute
    material.node_tree.links.new(source.outputs["Color"], shader.inputs["Base Color"])
    return material


def save_jpeg(rendered: Path, name: str, size: tuple[int, int] | None = None) -> None:
    """Save a rendered picture as docs/pictures/NAME.jpg.

    Parameters
    ----------
    rendered : Path
        Image file that Blender can read.
    name : str
        File name without suffix.
    size : (int, int), optional
        Width and height to scale to, in pixels.
    """
    picture = bpy.data.images.load(str(rendered))
    # Reading the file, which Blender delays until pixels are used, resets the format.
    picture.update()
    if size is not None:
        picture.scale(*size)
    picture.file_format = "JPEG"
    picture.save(filepath=str(PROJECT / "docs" / "pictures" / f"{name}.jpg"), quality=_QUALITY)


def photograph_row(
    studio: Studio, shown: Sequence[bpy.types.Object], view: View, step: float, size: tuple[int, int], name: str
) -> None:
    """Render objects in a row, without perspective, as docs/pictures/NAME.jpg.

    Parameters
    ----------
    studio : Studio
        The studio; each object is `step` to the right of the previous one.
    shown : sequence of bpy.types.Object
        The objects.
    view : View
        Direction of the view.
    step : float
        Distance between objects, in scene units.
    size : (int, int)
        Width and height in pixels.
    name : str
        Name of the picture, without suffix.
    """
    with TemporaryDirectory() as folder:
        _render_row(studio, shown, view, step, size, _SAMPLES, Path(folder) / "row.png")
        save_jpeg(Path(folder) / "row.png", name)


def row_picture(
    shown: Sequence[bpy.types.Object], view: View, step: float, size: tuple[int, int], samples: int
) -> Image.Image:
    """Render copies of objects in a row, `step` apart, without perspective, with so many light paths per pixel."""
    with Studio() as studio, TemporaryDirectory() as folder:
        copies = [studio.show(one, step * number * view.axes[0]) for number, one in enumerate(shown)]
        _render_row(studio, copies, view, step, size, samples, Path(folder) / "row.png")
        with Image.open(Path(folder) / "row.png") as picture:
            return picture.convert("RGB")


def _render_row(
    studio: Studio,
    shown: Sequence[bpy.types.Object],
    view: View,
    step: float,
    size: tuple[int, int],
    samples: int,
    target: Path,
) -> None:
    points = [world_points(one) for one in shown]
    studio.build(points, view)
    joined = np.concatenate(points)
    middle = (joined.min(axis=0) + joined.max(axis=0)) / 2.0
    studio.look_flat(Pose(middle + 50.0 * view.axes[2], view), step * len(shown), 200.0)
    studio.set_quality(size, samples)
    studio.render(target)
