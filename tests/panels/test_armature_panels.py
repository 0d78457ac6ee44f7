# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels of armatures show, drawn into a recording layout; drawing has no other effect."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.properties.armatures import FitProperties
from tests.operators.running import call, inventory
from tests.rigs import chain, choose, lines, own, tube

from .drawing import draw, forbid, named, panels, texts

pytestmark = pytest.mark.usefixtures("empty_scene")


def draw_all():
    return [entry for panel in panels("CONVWASS_PT_armature") for entry in draw(panel)]


@pytest.fixture
def rig():
    body, rig = tube(), chain(20)
    choose(body, rig)
    return rig


def test_without_inputs_it_asks_for_a_body_and_an_armature():
    drawn = draw_all()
    assert {("prop", "body"), ("prop", "rig")} <= set(drawn)
    assert "Pin the ends" not in texts(drawn)
    assert "DEFAULT_CLOSED" in bpy.types.CONVWASS_PT_armature.bl_options


def test_the_active_armature_is_named(rig):
    assert "Active armature" not in texts(draw_all())
    own().rig = None
    bpy.context.view_layer.objects.active = rig
    assert "Active armature: Rig" in texts(draw_all())


def test_every_setting_and_every_operator_is_shown(rig):
    call("pin_joints", joints="A.head")
    drawn = draw_all()
    shown = named(drawn, "prop")
    assert {*vars(FitProperties)["__annotations__"], "depth", "show_joints"} <= shown
    kinds = [getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("CONVWASS_OT_")]
    expected = {kind.bl_idname for kind in kinds if "armature" in kind.__module__}
    assert named(drawn, "operator") == expected
    assert len(expected) == 5


def test_pins_are_listed_with_their_buttons(rig):
    assert "Pin the ends of limbs" in texts(draw_all())
    call("pin_joints", joints="A.head, C.tail")
    drawn = draw(bpy.types.CONVWASS_PT_armature_pins)
    assert [text for kind, text in drawn if kind == "label"] == ["A.head", "C.tail"]
    assert drawn.count(("operator", "convwass.unpin_joints")) == 3
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    assert "C.tail" in texts(draw_all())


def test_many_pins_are_counted():
    edges = lines([(place, 0, 0) for place in range(50)], [(place, place + 1) for place in range(49)])
    choose(tube(), edges)
    call("pin_joints", joints=", ".join(str(place) for place in range(40)))
    drawn = draw(bpy.types.CONVWASS_PT_armature_pins)
    assert "and 10 more" in texts(drawn)
    assert ("label", "30") not in drawn


def test_drawing_computes_and_writes_nothing(rig, monkeypatch):
    call("pin_joints", joints="A.head")
    forbid(monkeypatch, "bridge.armatures.rigs.armature_graph", "bridge.armatures.rigs.triangle_mesh")
    before = inventory()
    draw_all()
    assert inventory() == before
