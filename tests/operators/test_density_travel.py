# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities that travel, blend and are filled in, as buttons and scripts ask for them."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.densities.density_attributes import stored_frames
from convwass_addon.bridge.densities.density_player import density_value, played_densities
from convwass_addon.bridge.densities.density_store import stored_density
from convwass_addon.bridge.densities.result_groups import RESULTS_KEY
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.vertex_groups import read_group, write_group
from convwass_addon.operators.density_travel import CONVWASS_OT_interpolate_density, CONVWASS_OT_propagate_densities
from tests.operators.densities import ball, center, curve, linked, positions, two_balls
from tests.operators.running import (
    ESCAPE,
    TIMER,
    Pressed,
    call,
    inventory,
    show_other_scene,
    started,
    until,
    wait_for_the_thread,
    window_context,
)

pytestmark = pytest.mark.usefixtures("empty_scene")

PAIR = {"first": "A", "second": "B"}
QUICK = {**PAIR, "steps": 4}


@pytest.fixture
def obj():
    """A ball with a third group, C, a cap at the front."""
    made = ball()
    write_group(made, "C", (positions(made)[:, 1] < -0.8).astype(float))
    made.vertex_groups.active_index = 0
    return made


def values_at(obj, frame, name="Density"):
    bpy.context.scene.frame_set(int(np.floor(frame)), subframe=float(frame - np.floor(frame)))
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    values = element_values(evaluated.data.attributes[name].data, "value")
    return values.astype(float)


def test_a_density_travels_from_group_to_group(obj):
    assert call("interpolate_density", **QUICK) == {"FINISHED"}
    assert played_densities(obj) == ["Density"]
    assert stored_frames(obj).shape == (5, 266)
    assert center(obj, values_at(obj, 1))[0] > 0.85
    assert abs(center(obj, values_at(obj, 3))[0]) < 0.1
    assert center(obj, values_at(obj, 5))[0] < -0.85
    assert curve(obj) == [(1, 0, "LINEAR"), (5, 1, "LINEAR")]
    assert obj.active_material.name == "Density Heat Map"
    stored = stored_density(obj, "Density")
    assert stored.inputs == ["A", "B"]
    assert (stored.settings["steps"], stored.settings["entropy_limit"]) == (4, "between")
    assert len(stored.records) == 5


def test_two_groups_need_no_choice(obj):
    with pytest.raises(RuntimeError, match="Choose a first and a second group"):
        call("interpolate_density", steps=2)
    obj.vertex_groups.remove(obj.vertex_groups["C"])
    assert call("interpolate_density", steps=2) == {"FINISHED"}
    assert stored_density(obj, "Density").inputs == ["A", "B"]


def test_the_list_gives_groups_and_frames(obj):
    for name, frame in (("A", 10), ("C", 14.5), ("B", 30)):
        call("add_density_stop", group=name)
        obj.convwass_density.stops[-1].frame = frame
    call("add_density_stop", which="EMPTY")
    obj.convwass_density.stops[-1].enabled = False
    assert call("interpolate_density", steps=2, easing="SMOOTH", density="Moss growth") == {"FINISHED"}
    assert curve(obj) == [(10, 0, "SINE"), (14.5, 0.225, "SINE"), (30, 1, "SINE")]
    assert center(obj, values_at(obj, 14.5, "Moss growth"))[1] < -0.85
    assert stored_density(obj, "Moss growth").inputs == ["A", "C", "B"]


def test_scripts_name_groups_and_frames(obj):
    obj.convwass_density.first = obj.convwass_density.second = "C"
    call("interpolate_density", groups="A, C, A", frames="0, 8, 300", steps=2)
    assert stored_density(obj, "Density").inputs == ["A", "C", "A"]
    assert bpy.context.scene.frame_end == 300
    call("interpolate_density", steps=1)
    assert stored_density(obj, "Density").inputs == ["C", "C"]


@pytest.mark.parametrize(
    ("frames", "end"), [("1, 13", 250), ("1, 300.5", 301), ("", 250), ("20, 40", 250), ("20, 400", 400)]
)
def test_the_scene_range_is_extended_to_the_density_and_never_shortened(obj, frames, end):
    scene = bpy.context.scene
    assert (scene.frame_start, scene.frame_end) == (1, 250)
    call("interpolate_density", groups="A, C", frames=frames, steps=2)
    assert (scene.frame_start, scene.frame_end) == (1, end)


def test_groups_may_begin_and_end_with_spaces(obj):
    obj.vertex_groups["A"].name, obj.vertex_groups["C"].name = "Arm, left ", " C"
    assert call("interpolate_density", first="Arm, left ", second=" C", steps=2) == {"FINISHED"}
    assert bpy.ops.convwass.rebake_density() == {"FINISHED"}
    assert bpy.ops.convwass.measure_groups(groups="Arm, left \n C") == {"FINISHED"}
    assert stored_density(obj, "Density").inputs == ["Arm, left ", " C"]


def test_unchanged_keys_leave_the_scene_unchanged(obj):
    call("interpolate_density", groups="A, C", frames="1, 13", steps=2)
    bpy.context.scene.frame_end = 99
    call("interpolate_density", groups="A, C", frames="1, 13", steps=2, set_keys=False)
    assert bpy.context.scene.frame_end == 99


def drive(value):
    value.owner.driver_add(value.path).driver.expression = "0.5"


def lock(value):
    (own,) = curves_of(value.modifier.id_data)
    own.lock = True


@pytest.mark.parametrize("animate", [drive, lock])
def test_drivers_and_locked_keys_stay(obj, animate, capfd):
    call("interpolate_density", groups="A, C", frames="1, 13", steps=2)
    value, keys = density_value(obj), curve(obj)
    if animate == drive:
        obj.animation_data_clear()
    animate(value)
    assert call("interpolate_density", groups="A, C", frames="20, 400", steps=3) == {"FINISHED"}
    assert "no keys were set" in capfd.readouterr().out
    assert stored_density(obj, "Density").settings["steps"] == 3
    assert curve(obj) == keys if animate == lock else not curves_of(obj) and len(obj.animation_data.drivers) == 1
    assert bpy.context.scene.frame_end == 250


@pytest.mark.parametrize("entropy_limit", ["OFF", "BETWEEN", "MAX", "NUMBER"])
def test_the_bound_keeps_it_from_spreading(obj, entropy_limit):
    call("interpolate_density", groups="A, C", steps=4, entropy_limit=entropy_limit, entropy_bound=-1.8)
    entropies = [record["entropy"] for record in stored_density(obj, "Density").records]
    assert (max(entropies) > max(entropies[0], -1.8) + 0.05) == (entropy_limit == "OFF")


def test_it_works_in_weight_paint_mode_and_not_in_edit_mode(obj):
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    assert call("interpolate_density", **QUICK) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Go to Object or Weight Paint Mode first"):
        call("interpolate_density", **QUICK)


def test_materials_stay(obj):
    own = bpy.data.materials.new("Own")
    obj.data.materials.append(own)
    call("interpolate_density", **QUICK)
    assert obj.data.materials[:] == [own]
    call("interpolate_density", **QUICK, add_material=False)
    assert len(bpy.data.materials) == 1


def test_undo_takes_it_away(obj):
    bpy.ops.ed.undo_push(message="painted")
    before = inventory()
    call("interpolate_density", **QUICK)
    bpy.ops.ed.undo_push(message="interpolated")
    bpy.ops.ed.undo()
    assert inventory() == before


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"first": "A"}, "Choose a first and a second group"),
        ({"groups": "A"}, "at least two groups"),
        ({"groups": "A, Nobody"}, "no vertex group Nobody"),
        ({**PAIR, "frames": "1, x"}, "Frames and weights must be numbers"),
        ({**PAIR, "frames": "9, 3"}, "each later than the one before"),
        ({**PAIR, "frames": "1, 1e30"}, "must lie between -1048574 and 1048574, not at 1e[+]30"),
        ({**PAIR, "frames": "1, 2, 3"}, "2 groups and 3 key times"),
        ({**PAIR, "density": "A"}, "already has a vertex group or an attribute A"),
        ({**PAIR, "density": ""}, "A density needs a name"),
        ({**PAIR, "blur": 1e-4}, "finer than the mesh can carry"),
        ({**PAIR, "blur": 100.0}, "longer than the whole surface"),
    ],
)
def test_invalid_input_is_reported_and_leaves_nothing_behind(obj, arguments, message):
    before = inventory()
    with pytest.raises(RuntimeError, match=message):
        call("interpolate_density", **arguments)
    assert inventory() == before


def test_stops_without_a_group_are_numbered(obj):
    call("add_density_stop")
    call("add_density_stop", which="EMPTY")
    with pytest.raises(RuntimeError, match="Stop number 1 on the list has no group"):
        call("interpolate_density")


@pytest.mark.parametrize("name", ["interpolate_density", "blend_densities", "propagate_densities"])
def test_polls(name, tmp_path):
    with pytest.raises(RuntimeError, match="Make a mesh object active"):
        call(name)
    bpy.ops.mesh.primitive_cube_add()
    with pytest.raises(RuntimeError, match="Paint a vertex group first"):
        call(name)
    linked(tmp_path)
    with pytest.raises(RuntimeError, match="is linked from another file"):
        call(name, groups="A, B")


def test_pieces_are_named_or_matched():
    obj = two_balls()
    write_group(obj, "Whole", np.ones(len(obj.data.vertices)))
    before = inventory()
    with pytest.raises(RuntimeError, match=r"different pieces.*266 vertices"):
        call("interpolate_density", **QUICK)
    with pytest.raises(RuntimeError, match="different shares"):
        call("interpolate_density", groups="Both, Whole", steps=2)
    assert inventory() == before
    assert call("interpolate_density", groups="Both, Whole", steps=2, pieces="match") == {"FINISHED"}


def test_loose_vertices_have_no_mass(obj):
    obj.data.vertices.add(2)
    obj.vertex_groups["A"].add([266], 1.0, "REPLACE")
    call("interpolate_density", **QUICK)
    assert not stored_frames(obj)[:, 266:].any()


def test_a_blend_lies_between(obj):
    assert call("blend_densities", groups="A, B, C", weights="1, 0, 1") == {"FINISHED"}
    place = center(obj, read_group(obj, "Blend"))
    np.testing.assert_allclose(place / np.linalg.norm(place), [0.5**0.5, -(0.5**0.5), 0], atol=0.1)
    assert obj.vertex_groups.active.name == "Blend"
    call("add_density_stop", group="A")
    call("add_density_stop", group="C")
    obj.convwass_density.stops[1].weight = 0.0
    call("blend_densities", group="Only A")
    assert center(obj, read_group(obj, "Only A"))[0] > 0.85


def test_painted_groups_are_kept_and_blends_replaced(obj):
    before = read_group(obj, "A")
    with pytest.raises(RuntimeError, match="already has a vertex group A that is no result"):
        call("blend_densities", groups="A, B", group="A")
    np.testing.assert_array_equal(read_group(obj, "A"), before)
    obj.vertex_groups.new(name="Mix")
    mixed = []
    for weights in ("1, 0", "0, 1"):
        call("blend_densities", groups="A, B", group="Mix", weights=weights)
        mixed.append(center(obj, read_group(obj, "Mix"))[0])
    assert mixed[0] > 0.85 and mixed[1] < -0.85


def test_a_group_painted_in_the_place_of_a_result_is_kept(obj):
    call("blend_densities", groups="A, B")
    obj.vertex_groups["Blend"].name = "Kept"
    painted = obj.vertex_groups.new(name="Blend")
    painted.add([0, 1, 2], 0.7, "REPLACE")
    with pytest.raises(RuntimeError, match="vertex group Blend that is no result"):
        call("blend_densities", groups="A, B")
    obj.vertex_groups.remove(painted)
    call("blend_densities", groups="A, B")
    obj.vertex_groups["Blend"].add([0], 1.0, "REPLACE")
    with pytest.raises(RuntimeError, match="or was changed since"):
        call("blend_densities", groups="A, B")


@pytest.mark.parametrize("damage", ["{", "3", 7])
def test_damaged_names_of_results_protect_all_groups(obj, damage):
    call("blend_densities", groups="A, B")
    obj[RESULTS_KEY] = damage
    with pytest.raises(RuntimeError, match="vertex group Blend that is no result"):
        call("blend_densities", groups="A, B")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"weights": "1"}, "each of the 2 inputs, but there are 1"),
        ({"weights": "0, 0"}, "All weights are zero"),
        ({"weights": "-1, 2"}, "zero or positive"),
    ],
)
def test_weights_that_cannot_be(obj, arguments, message):
    with pytest.raises(RuntimeError, match=message):
        call("blend_densities", groups="A, B", **arguments)


def test_a_locked_group_is_reported_before_the_work(obj, monkeypatch):
    group = obj.vertex_groups.new(name="Blend")
    group.lock_weight = True
    with pytest.raises(RuntimeError, match="Blend is locked"):
        call("blend_densities", groups="A, B")
    with pytest.raises(RuntimeError, match="Blend is locked"):
        call("propagate_densities", groups="A, Blend, B")


def test_places_without_weight_are_filled_in(obj):
    obj.vertex_groups.new(name="Empty")
    assert call("propagate_densities", groups="A, Missing, C") == {"FINISHED"}
    place = center(obj, read_group(obj, "Missing"))
    np.testing.assert_allclose(place / np.linalg.norm(place), [0.5**0.5, -(0.5**0.5), 0], atol=0.1)
    call("propagate_densities", groups="A, Empty, B, C", edges="0 - 1, 1-3, 2-3")
    assert center(obj, read_group(obj, "Empty"))[1] < -0.4


def test_places_on_the_list_get_names(obj):
    call("add_density_stop", group="A")
    call("add_density_stop", which="EMPTY")
    call("add_density_stop", group="C")
    for _ in range(2):
        assert call("propagate_densities") == {"FINISHED"}
        assert obj.vertex_groups.keys() == ["A", "B", "C", "Place 1"]
    obj.convwass_density.edges = "0-2"
    with pytest.raises(RuntimeError, match="No edges lead from a painted place to Place 1"):
        call("propagate_densities")


def test_a_painted_group_is_not_replaced_by_a_place_without_a_name(obj):
    write_group(obj, "Place 1", read_group(obj, "B"))
    call("add_density_stop", group="A")
    call("add_density_stop", which="EMPTY")
    call("add_density_stop", group="C")
    with pytest.raises(RuntimeError, match="already has a vertex group Place 1 that is no result"):
        call("propagate_densities")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"groups": "A, B"}, "All stops have painted groups"),
        ({"groups": "A, X, B", "edges": "0-1, 5"}, "Edges must be pairs of numbers"),
        ({"groups": "A, X, B", "edges": "0-1, 1-7"}, "numbers from 0 to 2"),
        ({"groups": "A, X, B", "edges": "0-0"}, "to itself"),
        ({"groups": "X, Y"}, "No place of the graph is known"),
        ({"groups": "A, X, B, X"}, "Two stops would be filled in as the group X"),
    ],
)
def test_graphs_that_cannot_be(obj, arguments, message):
    with pytest.raises(RuntimeError, match=message):
        call("propagate_densities", **arguments)


@pytest.fixture
def press():
    def start(context, kind=CONVWASS_OT_interpolate_density, **arguments):
        pressed = Pressed(kind, **arguments)
        assert started(pressed, context)
        return pressed

    return start


def test_it_runs_in_the_background(obj, press):
    context = window_context()
    pressed = press(context, **QUICK)
    assert until(pressed, context) == {"FINISHED"}
    assert played_densities(obj) == ["Density"]
    assert not context.window_manager.convwass_progress.running
    assert pressed.reports[-1][1].startswith("Density: 4 steps from frame 1 to 5")


@pytest.mark.parametrize("kind", [CONVWASS_OT_interpolate_density, CONVWASS_OT_propagate_densities])
@pytest.mark.parametrize("way", ["escape", "button", "file"])
def test_stopping_leaves_nothing_behind(obj, press, kind, way):
    before = inventory()
    context = window_context()
    pressed = press(context, kind, groups="A, X, C" if kind is CONVWASS_OT_propagate_densities else "A, B, C, A")
    until(pressed, context, lambda: context.window_manager.convwass_progress.fraction > 0.0)
    if way == "file":
        pressed.cancel(context)
    else:
        context.window_manager.convwass_progress.stopping = way == "button"
        assert pressed.modal(context, TIMER if way == "button" else ESCAPE) == {"CANCELLED"}
        assert pressed.reports == [("INFO", "Stopped; nothing was changed")]
    assert inventory() == before
    assert not context.window_manager.convwass_progress.running


def test_the_result_waits_until_edit_mode_is_left(obj, press):
    context = window_context()
    pressed = press(context, **QUICK)
    bpy.ops.object.mode_set(mode="EDIT")
    wait_for_the_thread()
    assert [pressed.modal(context, TIMER) for _ in range(3)] == [{"PASS_THROUGH"}] * 3
    assert "leave Edit Mode" in context.window_manager.convwass_progress.message
    bpy.ops.object.mode_set(mode="OBJECT")
    context.window.modal_operators = [SimpleNamespace(bl_idname="TRANSFORM_OT_translate")]
    assert pressed.modal(context, TIMER) == {"PASS_THROUGH"}
    context.window.modal_operators = [SimpleNamespace(bl_idname="CONVWASS_OT_interpolate_density")]
    assert pressed.modal(context, TIMER) == {"FINISHED"}
    assert played_densities(obj) == ["Density"]


def test_cancelling_in_edit_mode_leaves_nothing_behind(obj, press):
    before = inventory()
    context = window_context()
    pressed = press(context, **QUICK)
    bpy.ops.object.mode_set(mode="EDIT")
    wait_for_the_thread()
    pressed.modal(context, TIMER)
    assert pressed.modal(context, ESCAPE) == {"CANCELLED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert inventory() == before


def test_a_changed_mesh_is_reported(obj, press):
    context = window_context()
    pressed = press(context, **QUICK)
    obj.data.vertices.add(1)
    assert until(pressed, context) == {"CANCELLED"}
    assert "vertices of Sphere have changed since the start" in pressed.reports[-1][1]
    assert played_densities(obj) == []


def test_errors_during_the_work_are_reported(obj, press):
    context = window_context()
    pressed = press(context, **QUICK, blur=1e-5)
    assert until(pressed, context) == {"CANCELLED"}
    assert pressed.reports[-1][0] == "ERROR"
    assert "finer than the mesh can carry" in pressed.reports[-1][1]


def test_the_value_can_be_moved_by_hand(obj):
    call("interpolate_density", **QUICK)
    density_value(obj).set(0.5)
    bpy.context.view_layer.update()
    assert density_value(obj).get() == pytest.approx(0.5)


def test_the_scene_that_it_began_in_is_made_longer(obj):
    own = bpy.context.scene
    own.frame_end = 10
    pressed = Pressed(CONVWASS_OT_interpolate_density, groups="A, B", frames="1, 30", steps=2)
    context = window_context()
    assert started(pressed, context)
    other = show_other_scene(context)
    assert until(pressed, context) == {"FINISHED"}
    assert (own.frame_end, other.frame_end) == (30, 250)
