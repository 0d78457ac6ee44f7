# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes as a command line names them: files of meshes, drawings and pictures, objects of a .blend, and words."""

from __future__ import annotations

import math
import os
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from ...errors import InputError
from ..image_files import loaded_image
from ..imports import BLEND, READERS, checked_file, import_objects, only_kept_data, parse_source, run_importer
from ..scratch_scene import scratch_scene

TEXT = "text:"
"""What a word begins with."""

DRAWING = ".svg"
PICTURES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp")
"""Endings of images whose silhouettes are taken."""


def imported_shape(text: str) -> list[bpy.types.Object]:
    """Bring what a command line names into the current scene, as an object.

    Parameters
    ----------
    text : str
        ``text:WORD``, an SVG or an image, or what :func:`.imports.import_objects` reads.

    Raises
    ------
    InputError
        No word, or a file that cannot be used; the scene is as before then.
    """
    if text.startswith(TEXT) and not os.path.exists(text):
        return [_text_object(text.removeprefix(TEXT))]
    source = parse_source(text)
    suffix = source.path.suffix.lower()
    if suffix == DRAWING:
        return [_drawing(source.path)]
    if suffix in PICTURES:
        return [_picture(source.path)]
    names = [source.object_name] if source.object_name else None
    checked_file(source.path, names, (*READERS, BLEND, DRAWING, *PICTURES))
    return import_objects(source.path, names)


def _text_object(word: str) -> bpy.types.Object:
    """Make a text in Blender's own font."""
    if not word.strip():
        raise InputError("{text} has no letters; write them after the colon, as in text:HELLO.", text=TEXT)
    curve = bpy.data.curves.new(word, "FONT")
    curve.body = word
    return _linked(bpy.data.objects.new(word, curve))


def _picture(path: Path) -> bpy.types.Object:
    """Make an empty that shows an image."""
    file = checked_file(path, None, PICTURES)
    image = loaded_image(file)
    obj = bpy.data.objects.new(file.stem, None)
    obj.empty_display_type, obj.data = "IMAGE", image
    return _linked(obj)


def _drawing(path: Path) -> bpy.types.Object:
    """Read an SVG as one curve object."""
    file = checked_file(path, None, (DRAWING,))
    with only_kept_data() as kept, scratch_scene() as scene:
        run_importer(lambda path: bpy.ops.import_curve.svg(filepath=path), file)
        bpy.context.view_layer.update()
        curves = [obj for obj in scene.collection.all_objects if obj.type == "CURVE" and obj.data.splines]
        if not curves:
            raise InputError("{file} holds no curve; convert its objects to paths and export it again.", file=file.name)
        kept.append(_one_of(curves))
    kept[0].name = kept[0].data.name = file.stem
    return _linked(kept[0])


def _one_of(curves: list[bpy.types.Object]) -> bpy.types.Object:
    """Make one curve object of several, whose splines keep their materials: Blender's own joining mixes these up."""
    data = bpy.data.curves.new("Drawing", "CURVE")
    data.dimensions, data.fill_mode = "2D", "BOTH"
    for obj in curves:
        slots = {}
        for index, material in enumerate(obj.data.materials):
            if material not in list(data.materials):
                data.materials.append(material)
            slots[index] = list(data.materials).index(material)
        for spline in obj.data.splines:
            if spline.type == "BEZIER":
                _copy_spline(spline, data, obj.matrix_world, slots.get(spline.material_index, 0))
    return bpy.data.objects.new("Drawing", data)


def _copy_spline(spline: bpy.types.Spline, data: bpy.types.Curve, place: Matrix, slot: int) -> None:
    """Add a Bezier spline to a curve, moved by a matrix."""
    matrix = np.array(place, dtype=np.float64)
    own = data.splines.new("BEZIER")
    own.bezier_points.add(len(spline.bezier_points) - 1)
    for name in ("co", "handle_left", "handle_right"):
        points = np.empty(3 * len(spline.bezier_points), np.float32)
        spline.bezier_points.foreach_get(name, points)
        moved = points.reshape(-1, 3).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
        for kind in ("handle_left_type", "handle_right_type"):
            own.bezier_points.foreach_set(kind, np.zeros(len(moved), np.int32))
        own.bezier_points.foreach_set(name, moved.astype(np.float32).ravel())
    own.use_cyclic_u, own.material_index = spline.use_cyclic_u, slot
    own.resolution_u = spline.resolution_u


def _linked(obj: bpy.types.Object) -> bpy.types.Object:
    """Put an object into the scene, upright: to be looked at from the front, as pictures are made of it."""
    obj.rotation_euler = (math.pi / 2.0, 0.0, 0.0)
    bpy.context.scene.collection.objects.link(obj)
    return obj
