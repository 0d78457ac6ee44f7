# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors and lines of Grease Pencil strokes, as read and as drawn in blends."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.bridge.flat.flat_job import FlatJob
from convwass_addon.bridge.flat.flat_moves import moved_flats
from convwass_addon.bridge.flat.flat_objects import flat_objects
from convwass_addon.bridge.flat.pencil_looks import StrokeLine, mean_line
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.errors import InputError
from tests.bridge.test_flat import drawing, square, text

pytestmark = pytest.mark.usefixtures("empty_scene")

SINCE_5_2 = bpy.app.version >= (5, 2)


def read(obj):
    (flat,) = flat_objects([obj], bpy.context.evaluated_depsgraph_get())
    return flat


def strokes_of(obj, number=1):
    return {frame.frame_number: frame.drawing for frame in obj.data.layers[0].frames}[number].strokes


def with_line(obj, radius, color, opacity=None):
    """Give all strokes of a drawing a line."""
    for stroke in strokes_of(obj):
        for point in stroke.points:
            point.radius, point.vertex_color = radius, (*color, 1.0)
            if opacity is not None:
                point.opacity = opacity
        if SINCE_5_2:
            stroke.hide_stroke = False
    if not SINCE_5_2:
        for material in obj.data.materials:
            material.grease_pencil.show_stroke = True
    return obj


def without_line(obj):
    for stroke in strokes_of(obj) if SINCE_5_2 else ():
        stroke.hide_stroke = True
    for material in obj.data.materials if not SINCE_5_2 else ():
        material.grease_pencil.show_stroke = False
    return obj


def baked(shapes, kind, frames=3):
    settings = FlatSettings(resolution=128, motion="transport")
    job = FlatJob(shapes, path_blends(len(shapes), frames), settings, {"flat_output": kind}, 1)
    for step in job.steps():
        job.write(step)
    return job, frame_objects(job.finish(hide_inputs=False))


def test_colors_of_strokes_and_layers_lie_over_that_of_the_material():
    # The material is (0.1, 0.2, 0.3).
    obj = drawing([square(2.0)], [1])
    layer, stroke = obj.data.layers[0], strokes_of(obj)[0]
    stroke.fill_color, stroke.fill_opacity = (1.0, 0.0, 0.0, 0.5), 0.5
    layer.opacity = 0.8
    np.testing.assert_allclose(read(obj).shape.colors, [(0.55, 0.1, 0.15, 0.4)], atol=1e-6)
    layer.tint_color, layer.tint_factor = (0.0, 0.0, 1.0), 1.0
    np.testing.assert_allclose(read(obj).shape.colors, [(0.0, 0.0, 1.0, 0.4)], atol=1e-6)


def test_strokes_that_are_not_drawn_are_not_read():
    obj = drawing([square(2.0), square(2.0, 5.0)], [1, 2])
    strokes_of(obj)[1].material_index = 0
    if not SINCE_5_2:
        obj.data.materials[0].grease_pencil.show_fill = True
    assert len(read(obj).shape.rings) == 2
    obj.data.materials[0].grease_pencil.hide = True
    assert len(read(obj).shape.rings) == 1
    group = obj.data.layer_groups.new("Group")
    obj.data.layers.move_to_layer_group(obj.data.layers[0], group)
    assert len(read(obj).shape.rings) == 1
    group.hide = True
    with pytest.raises(InputError, match="no filled stroke"):
        read(obj)


@pytest.mark.skipif(not SINCE_5_2, reason="Each stroke is filled by itself")
def test_the_first_stroke_of_a_fill_gives_its_holes_their_color():
    obj = drawing([square(4.0), square(2.0)], [3, 3])
    strokes_of(obj)[1].fill_color = (1.0, 0.0, 0.0, 1.0)
    np.testing.assert_allclose(read(obj).shape.colors, [(0.1, 0.2, 0.3, 1.0)] * 2, atol=1e-6)


def test_lines_have_the_size_that_they_have_in_the_scene():
    obj = with_line(drawing([square(2.0)], [1]), 0.02, (1.0, 0.5, 0.0), opacity=0.5)
    obj.scale = (3.0, 3.0, 3.0)
    obj.data.layers[0].radius_offset = 0.01
    (line,) = read(obj).read.lines
    assert line.radius == pytest.approx(0.09, rel=1e-5)
    np.testing.assert_allclose(line.color, (1.0, 0.5, 0.0, 0.5), atol=1e-6)
    small = drawing([square(1.0)], [1])
    _, moved = moved_flats([read(small), read(obj)], "PLACED", "EQUAL_VOLUME")
    # The large square has the sides 6, and becomes as small as the other one.
    assert moved.lines[0].radius == pytest.approx(0.09 / 6.0, rel=1e-4)
    assert read(without_line(obj)).read.lines == (None,)
    assert read(text("A")).read.lines is None


def test_lines_become_thinner_toward_shapes_without_one():
    red, blue = StrokeLine(0.2, (1.0, 0.0, 0.0, 1.0)), StrokeLine(0.4, (0.0, 0.0, 1.0, 0.5))
    assert mean_line([red, None], [0.25, 0.75]) == StrokeLine(0.05, red.color)
    mixed = mean_line([red, blue, None], [0.5, 0.25, 0.25])
    assert mixed.radius == pytest.approx(0.2)
    np.testing.assert_allclose(mixed.color, (2 / 3, 0.0, 1 / 3, 5 / 6))
    assert mean_line([red, None], [0.0, 1.0]) is None


def test_drawn_blends_have_the_opacity_and_the_lines_of_their_shapes():
    first = with_line(drawing([square(2.0)], [1]), 0.06, (1.0, 0.0, 0.0))
    last = without_line(drawing([square(2.0, 3.0)], [1]))
    strokes_of(first)[0].fill_opacity = 0.5
    strokes_of(last)[0].fill_color = (0.4, 0.5, 0.6, 1.0)
    job, (obj,) = baked([first, last], "DRAWING")
    assert job.notices == []
    opacities, radii = [], []
    for number in (1, 2, 3, 4):
        bpy.context.scene.frame_set(number)
        flat = read(obj)
        opacities.append(flat.shape.colors[0, 3])
        (line,) = set(flat.read.lines)
        assert line is None
        inks = [material.name for material in obj.data.materials]
        outlines = [stroke for stroke in strokes_of(obj, number) if inks[stroke.material_index] == "Lines"]
        radii.append([point.radius for stroke in outlines for point in stroke.points])
        assert all(stroke.cyclic for stroke in outlines)
    np.testing.assert_allclose(opacities, (1 / 2, 2 / 3, 5 / 6, 1.0), atol=1e-5)
    for own, radius in zip(radii[:3], (0.06, 0.04, 0.02), strict=True):
        np.testing.assert_allclose(own, radius, rtol=1e-5)
        assert len(own) >= 4
    assert not radii[3]
    # Colors of blends cover those of the materials, whatever their opacity is.
    bpy.context.scene.frame_set(2)
    np.testing.assert_allclose(read(obj).shape.colors[0, :3], (0.2, 0.3, 0.4), atol=1e-5)


def test_what_blends_of_drawings_lack_is_said():
    lined = with_line(drawing([square(2.0), square(3.0)], [1, 0]), 0.05, (0.0, 0.0, 0.0))
    lined.name = "Lined"
    plain = without_line(drawing([square(2.0, 5.0), square(3.0, 5.0)], [1, 0]))
    plain.name = "Plain"
    lined.data.materials[1].grease_pencil.fill_style = "GRADIENT"
    lined.data.materials[1].name = "Sunset"
    job, _ = baked([lined, plain], "CURVE")
    assert [str(notice) for notice in job.notices] == [
        "Blends leave out the strokes of Lined that are not filled.",
        "Blends show the base colors of Sunset (Lined), not their gradients or images.",
        "Blends leave out the lines around the fills of Lined; set Flat Frames to Drawings to keep them.",
    ]
