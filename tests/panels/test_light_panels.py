# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels of light show; drawing changes nothing."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.applications.reflectance.weight_sheets import MOST_ON_PAD
from convwass_addon.properties.light import ReflectanceProperties, SkyProperties
from tests.lights import principled
from tests.operators.running import inventory

from .drawing import draw, named, panels

pytestmark = pytest.mark.usefixtures("empty_scene")

NAMES = ("CONVWASS_PT_light", "CONVWASS_PT_reflectance", "CONVWASS_PT_sky")


def draw_all():
    found = {panel for name in NAMES for panel in panels(name)}
    return [entry for panel in sorted(found, key=lambda panel: panel.__name__) for entry in draw(panel)]


def shown(kind):
    return named(draw_all(), kind)


def said():
    """Return all labels in order; long sentences consist of several."""
    return " ".join(text for own, text in draw_all() if own == "label")


def test_it_is_closed_by_default():
    assert "DEFAULT_CLOSED" in bpy.types.CONVWASS_PT_light.bl_options


def test_every_setting_and_every_operator_is_shown():
    expected = {*vars(ReflectanceProperties)["__annotations__"], *vars(SkyProperties)["__annotations__"]}
    assert expected | {"sun", "world", "world_2", "material"} <= shown("prop")
    assert {"convwass.blend_materials", "convwass.blend_skies", "convwass.import_lobes"} <= shown("operator")


def test_there_is_one_empty_material_slot_and_weights_are_shown_where_used():
    own = bpy.context.scene.convwass_reflectance
    assert "material_2" not in shown("prop")
    own.material = principled("A", 0.4)
    assert "material_2" in shown("prop")
    assert "weight" not in shown("prop")
    own.blend = "WEIGHTS"
    assert "weight" in shown("prop")
    assert "blends" not in shown("prop")


def test_a_message_explains_disabled_buttons_if_too_few_are_chosen():
    reflectance, skies = bpy.context.scene.convwass_reflectance, bpy.context.scene.convwass_sky
    materials, worlds = "Choose at least two materials", "Choose at least two worlds"
    assert materials in said() and worlds in said()
    reflectance.material = reflectance.material_2 = principled("A", 0.4)
    assert materials not in said() and worlds in said()
    reflectance.blend = "PAD"
    assert "three or four materials, not 2" in said()
    reflectance.material_3 = reflectance.material
    assert "A pad" not in said()
    reflectance.blends = MOST_ON_PAD + 1
    assert f"A pad can have at most {MOST_ON_PAD} steps" in said()
    assert f"At most {MOST_ON_PAD} for a pad" in reflectance.bl_rna.properties["blends"].description
    skies.world = skies.world_2 = bpy.data.worlds.new("Sky")
    assert worlds not in said()


def test_every_chosen_world_and_one_empty_slot_are_drawn():
    own, worlds = bpy.context.scene.convwass_sky, {"world", "world_2", "world_3", "world_4"}
    assert shown("prop") & worlds == {"world", "world_2"}
    own.world = own.world_4 = bpy.data.worlds.new("Sky")
    assert shown("prop") & worlds == {"world", "world_2", "world_4"}
    own.world_2 = own.world_3 = own.world
    assert shown("prop") & worlds == worlds


def test_drawing_changes_nothing():
    before = inventory()
    draw_all()
    assert inventory() == before
