# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels of soft maps show, drawn into a recording layout; drawing has no other effect."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.properties.soft_maps import FromGroupsProperties, SoftMapProperties, TransferProperties
from tests.operators.running import call, inventory
from tests.operators.soft_maps import choose, own, sphere, store_closest

from .drawing import draw, forbid, named, panels, texts

pytestmark = pytest.mark.usefixtures("empty_scene")

PANELS = ("CONVWASS_PT_soft_map", "CONVWASS_PT_map_")


def draw_all():
    return [entry for prefix in PANELS for panel in panels(prefix) for entry in draw(panel)]


@pytest.fixture
def mapped():
    objects = sphere("Cow"), sphere("Horse", segments=12, ring_count=8)
    store_closest(*objects)
    call("add_map_pair", source_vertex=3, target_vertex=4, label="nose")
    return objects


def test_without_inputs_it_asks_for_two_objects():
    drawn = draw_all()
    assert {("prop", "source"), ("prop", "target")} <= set(drawn)
    assert "convwass.compute_soft_map" in named(drawn, "operator")
    assert not {"convwass.transfer_by_map", "convwass.show_soft_map"} & named(drawn, "operator")


def test_it_is_closed_by_default():
    assert "DEFAULT_CLOSED" in bpy.types.CONVWASS_PT_soft_map.bl_options


def test_pairs_have_numbers_names_and_buttons(mapped):
    drawn = draw(bpy.types.CONVWASS_PT_map_pairs)
    assert ("label", "1") in drawn
    assert {("prop", name) for name in ("enabled", "label", "source_vertex", "target_vertex")} <= set(drawn)
    assert "convwass.remove_map_pair" in named(drawn, "operator")


def test_every_setting_is_shown(mapped):
    drawn = named(draw_all(), "prop")
    kinds = (SoftMapProperties, TransferProperties, FromGroupsProperties)
    expected = {name for kind in kinds for name in vars(kind).get("__annotations__", {})}
    assert expected | {"show_labels", "threshold"} <= drawn


def test_every_operator_is_shown(mapped):
    shown = named(draw_all(), "operator")
    choose(mapped[0], mapped[0])
    shown |= named(draw_all(), "operator")
    kinds = [getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("CONVWASS_OT_")]
    expected = {kind.bl_idname for kind in kinds if "soft_map" in kind.__module__}
    assert shown == expected
    assert len(expected) == 14


def test_one_object_for_both_gets_the_mirror_button(mapped):
    choose(mapped[0], mapped[0])
    drawn = named(draw(bpy.types.CONVWASS_PT_soft_map), "operator")
    assert "convwass.mirror_map" in drawn
    assert "convwass.compute_soft_map" not in drawn


def test_the_map_and_its_direction_are_shown(mapped):
    assert "Map from Cow to Horse" in texts(draw(bpy.types.CONVWASS_PT_soft_map))
    call("swap_map_objects")
    assert "Map from Cow to Horse" in texts(draw(bpy.types.CONVWASS_PT_soft_map))
    assert "convwass.transfer_by_map" in named(draw(bpy.types.CONVWASS_PT_map_transfer), "operator")
    call("remove_soft_map")
    assert "Map from" not in texts(draw_all())


def test_changed_inputs_are_reported(mapped):
    assert "Vertices or faces have changed" not in texts(draw_all())
    mapped[1].data.vertices.add(1)
    assert "Vertices or faces have changed since the map was computed: Horse" in texts(draw_all())


def test_settings_of_groups_are_shown_only_for_groups(mapped):
    own().what = {"KEYS"}
    drawn = draw(bpy.types.CONVWASS_PT_map_transfer)
    assert ("prop", "limit") not in drawn


def test_drawing_computes_and_writes_nothing(mapped, monkeypatch):
    forbid(
        monkeypatch,
        "operators.soft_map_targets.stored_soft_map",
        "operators.soft_map_targets.map_state",
        "bridge.soft_maps.soft_map_store.unpacked",
        "bridge.soft_maps.soft_map_store.mesh_mark",
        "bridge.vertex_groups.read_groups",
    )
    before = inventory()
    draw_all()
    assert inventory() == before
