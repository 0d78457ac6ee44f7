# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Import shapes named on the command line: mesh files, drawings, images, objects of a .blend, and text."""

from __future__ import annotations

import math
import os
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from ...errors import InputError
from ...geometry.algebra.affine import transformed_points
from ..element_values import element_values, write_floats
from ..files.image_files import loaded_image
from ..files.imports import BLEND, READERS, checked_file, import_objects, only_kept_data, parse_source, run_importer
from ..files.scratch_scene import scratch_scene

TEXT = "text:"
"""Prefix of text shapes."""

DRAWING = ".svg"
PICTURES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp")
"""Extensions of images, whose silhouettes are used."""


def imported_shape(text: str) -> list[bpy.types.Object]:
    """Import a shape into the current scene.

    Parameters
    ----------
    text : str
        ``text:WORD``, an SVG file, an image, or a source for :func:`.imports.import_objects`.

    Raises
    ------
    InputError
        The text is empty, or the file cannot be used; the scene is not changed then.
    """
    if text.startswith(TEXT) and not os.path.exists(text):
        return [_text_object(text.removeprefix(TEXT))]
    source = parse_source(text)
    suffix = source.path.suffix.lower()
    if suffix == DRAWING:
        return [_drawing(source.path)]
    if suffix in PICTURES:
        return [_picture(source.path)]
    names = source.names
    checked_file(source.path, names, (*READERS, BLEND, DRAWING, *PICTURES))
    return import_objects(source.path, names)


def _text_object(word: str) -> bpy.types.Object:
    """Create a text object with Blender's default font."""
    if not word.strip():
        raise InputError("{text} needs some letters after the colon, as in text:HELLO.", text=TEXT)
    curve = bpy.data.curves.new(word, "FONT")
    curve.body = word
    return _linked(bpy.data.objects.new(word, curve))


def _picture(path: Path) -> bpy.types.Object:
    """Create an Empty that shows an image."""
    file = checked_file(path, None, PICTURES)
    image = loaded_image(file)
    obj = bpy.data.objects.new(file.stem, None)
    obj.empty_display_type, obj.data = "IMAGE", image
    return _linked(obj)


def _drawing(path: Path) -> bpy.types.Object:
    """Import an SVG as one curve object."""
    file = checked_file(path, None, (DRAWING,))
    with only_kept_data() as kept, scratch_scene() as scene:
        run_importer(lambda path: bpy.ops.import_curve.svg(filepath=path), file)
        bpy.context.view_layer.update()
        curves = [obj for obj in scene.collection.all_objects if obj.type == "CURVE" and obj.data.splines]
        if not curves:
            raise InputError(
                "{file} contains no curve; convert its objects to paths and export it again.", file=file.name
            )
        kept.append(_one_of(curves))
    kept[0].name = kept[0].data.name = file.stem
    return _linked(kept[0])


def _one_of(curves: list[bpy.types.Object]) -> bpy.types.Object:
    """Combine several curve objects into one, keeping the materials of splines, which Blender's Join mixes up."""
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
    """Add a transformed Bezier spline to a curve."""
    own = data.splines.new("BEZIER")
    own.bezier_points.add(len(spline.bezier_points) - 1)
    for name in ("co", "handle_left", "handle_right"):
        points = element_values(spline.bezier_points, name, 3)
        moved = transformed_points(points.astype(np.float64), place)
        for kind in ("handle_left_type", "handle_right_type"):
            own.bezier_points.foreach_set(kind, np.zeros(len(moved), np.int32))
        write_floats(own.bezier_points, name, moved)
    own.use_cyclic_u, own.material_index = spline.use_cyclic_u, slot
    own.resolution_u = spline.resolution_u


def _linked(obj: bpy.types.Object) -> bpy.types.Object:
    """Add an object to the scene, upright so that it faces the front view."""
    obj.rotation_euler = (math.pi / 2.0, 0.0, 0.0)
    bpy.context.scene.collection.objects.link(obj)
    return obj
