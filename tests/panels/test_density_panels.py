# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels of densities show, drawn into a recording layout; drawing has no other effect."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.properties.densities import OUTPUTS, OutputProperties, PathProperties, SurfaceProperties
from tests.operators.densities import ball
from tests.operators.running import inventory

from .drawing import draw, forbid, named, panels, texts

pytestmark = pytest.mark.usefixtures("empty_scene")


def draw_all():
    return [entry for panel in panels("CONVWASS_PT_densit") for entry in draw(panel)]


@pytest.fixture
def obj():
    return ball()


@pytest.fixture
def played(obj):
    bpy.ops.convwass.interpolate_density(groups="A, B", steps=2)
    return obj


def test_only_meshes_have_these_panels(obj):
    assert draw_all()
    bpy.ops.object.empty_add()
    assert not draw(bpy.types.CONVWASS_PT_densities)
    obj.select_set(False)
    bpy.ops.object.delete()
    bpy.context.view_layer.objects.active = None
    assert not draw(bpy.types.CONVWASS_PT_densities)


def test_painting_and_interpolating_are_open_by_default():
    opened = [panel.__name__ for panel in panels("CONVWASS_PT_density_") if "DEFAULT_CLOSED" not in panel.bl_options]
    assert sorted(opened) == ["CONVWASS_PT_density_interpolate", "CONVWASS_PT_density_paint"]


def test_without_a_group_there_are_instructions():
    bpy.ops.mesh.primitive_cube_add()
    assert ("label", "Paint a vertex group first") in draw_all()


@pytest.mark.parametrize("mode", ["OBJECT", "WEIGHT_PAINT"])
def test_the_active_group_is_shown_with_its_figures(obj, mode):
    bpy.ops.object.mode_set(mode=mode)
    assert "Radius" not in texts(draw(bpy.types.CONVWASS_PT_densities))
    bpy.ops.convwass.normalize_density()
    shown = texts(draw(bpy.types.CONVWASS_PT_densities))
    assert shown.startswith("A Covers 1")
    assert "Radius" in shown
    obj.vertex_groups.active_index = 1
    assert texts(draw(bpy.types.CONVWASS_PT_densities)) == "B"


def test_distances_are_shown(obj):
    bpy.ops.convwass.measure_distance(first="A", second="B")
    bpy.ops.convwass.measure_groups()
    shown = texts(draw(bpy.types.CONVWASS_PT_density_measure))
    assert "From A to B: 2." in shown
    assert "Sphere Distances" in shown


def test_a_list_replaces_the_pair(obj):
    drawn = draw(bpy.types.CONVWASS_PT_density_interpolate)
    assert ("prop", "first") in drawn
    assert "convwass.blend_densities" not in named(drawn, "operator")
    bpy.ops.convwass.add_density_stop(which="ALL")
    bpy.ops.convwass.add_density_stop(which="EMPTY")
    obj.convwass_density.stops[0].enabled = False
    drawn = draw(bpy.types.CONVWASS_PT_density_interpolate)
    assert ("prop", "first") not in drawn
    assert {"convwass.blend_densities", "convwass.propagate_densities"} <= named(drawn, "operator")
    assert [text for kind, text in drawn if kind == "label"] == ["", "0", "1"]


def test_every_setting_is_shown(played):
    own = played.convwass_density
    own.entropy_limit, own.output = "NUMBER", "IMAGES"
    drawn = named(draw_all(), "prop")
    kinds = (*PathProperties.__mro__, *OutputProperties.__mro__, SurfaceProperties)
    expected = {name for kind in kinds for name in vars(kind).get("__annotations__", {})}
    assert expected <= drawn


def test_every_operator_is_shown(played):
    before = named(draw_all(), "operator")
    bpy.ops.convwass.add_density_stop(which="ALL")
    kinds = [name for name in dir(bpy.types) if name.startswith("CONVWASS_OT_")]
    own = {getattr(bpy.types, name).bl_idname for name in kinds if "density" in getattr(bpy.types, name).__module__}
    assert own == (before | named(draw_all(), "operator")) - {"convwass.stop"}
    assert len(own) == 18


def test_an_animated_density_shows_its_value(obj):
    assert not draw(bpy.types.CONVWASS_PT_density_output)
    bpy.ops.convwass.interpolate_density(groups="A, B", steps=2)
    assert ("text", "Density") in draw(bpy.types.CONVWASS_PT_densities)
    for name in [name for name, *_ in OUTPUTS]:
        obj.convwass_density.output = name
        drawn = draw(bpy.types.CONVWASS_PT_density_output)
        assert (("prop", "folder") in drawn) == (name == "IMAGES")
    assert {"convwass.rebake_density", "convwass.remove_density"} <= named(drawn, "operator")


def test_changed_inputs_are_reported(played):
    assert "Changed" not in texts(draw_all())
    played.vertex_groups.remove(played.vertex_groups["B"])
    assert "Changed since it was made: B" in texts(draw_all())


def test_edited_nodes_are_left_out(played):
    tree = played.modifiers[0].node_group
    for item in [item for item in tree.interface.items_tree if item.name == "Density"]:
        tree.interface.remove(item)
    assert ("text", "Density") not in draw(bpy.types.CONVWASS_PT_densities)


def test_without_groups_little_is_shown():
    bpy.ops.mesh.primitive_cube_add()
    assert not bpy.types.CONVWASS_PT_density_interpolate.poll(bpy.context)
    assert not bpy.types.CONVWASS_PT_density_measure.poll(bpy.context)
    bpy.context.object.vertex_groups.new(name="A")
    assert bpy.types.CONVWASS_PT_density_interpolate.poll(bpy.context)


def test_drawing_computes_and_writes_nothing(played, monkeypatch):
    forbid(
        monkeypatch,
        "operators.density_changes.read_groups",
        "operators.density_job.read_surface",
        "operators.density_manage.stored_frames",
        "bridge.vertex_groups.read_groups",
    )
    bpy.ops.convwass.add_density_stop(which="ALL")
    before = inventory()
    draw_all()
    assert inventory() == before
