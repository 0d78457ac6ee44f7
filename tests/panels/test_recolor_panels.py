# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels for recoloring show; drawing has no other effect."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import pytest

from convwass_addon.properties.recolor import RecolorProperties
from tests.operators.running import inventory
from tests.pictures import blue_image, red_image

from .drawing import draw, named, panels

pytestmark = pytest.mark.usefixtures("empty_scene")


def draw_all():
    return [entry for panel in panels("CONVWASS_PT_recolor") for entry in draw(panel)]


def test_every_setting_and_every_operator_is_shown():
    drawn = draw_all()
    shown = named(drawn, "prop")
    assert {*RecolorProperties.__annotations__, "mask", "palette_mask", "output", "cube_size", "result"} <= shown
    expected = {
        f"convwass.{name}" for name in ("recolor_image", "write_cube", "build_grade_nodes", "recolor_attribute")
    }
    assert named(drawn, "operator") == expected


def test_weights_are_shown_for_several_palettes():
    own = bpy.context.scene.convwass_recolor

    def shown():
        return [name for kind, name in draw_all() if kind == "prop" and name.startswith(("palette", "weight"))]

    def images():
        return [name for name in shown() if name not in ("palette_mask", "palette_object")]

    assert images() == ["palette"]
    own.palette = red_image()
    assert images() == ["palette", "palette_2"]
    own.palette_2 = blue_image()
    assert images() == ["palette", "weight", "palette_2", "weight_2", "palette_3"]


def test_clips_have_a_separate_button():
    """In an editor that shows a sequence: for all frames, or for the current one as a new image."""
    clip = red_image("Shot")
    clip.source = "SEQUENCE"
    scene, manager = bpy.context.scene, bpy.context.window_manager
    context = SimpleNamespace(
        scene=scene, window_manager=manager, space_data=SimpleNamespace(type="IMAGE_EDITOR", image=clip)
    )
    drawn = draw(bpy.types.CONVWASS_PT_recolor_image, context)
    assert ("operator", "convwass.recolor_clip") in drawn and ("operator", "convwass.recolor_image") in drawn
    assert ("prop", "clip_folder") in drawn and ("prop", "output") not in drawn
    context.space_data.image = blue_image()
    assert ("operator", "convwass.recolor_clip") not in draw(bpy.types.CONVWASS_PT_recolor_image, context)


def test_drawing_changes_nothing():
    known = inventory()
    draw_all()
    assert inventory() == known
