# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of pairs, as buttons, scripts and clicks fill it."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import pytest
from mathutils import Matrix, Vector

from convwass_addon.bridge import surfaces
from convwass_addon.errors import InputError
from convwass_addon.operators import picking, soft_map_pick
from convwass_addon.operators.soft_map_compute import chosen_pairs
from convwass_addon.operators.soft_map_pairs import CONVWASS_OT_add_map_pair
from convwass_addon.properties.soft_maps import labeled_vertices
from tests.operators.running import ESCAPE, TIMER, Pressed, call, pretend_window, window_context
from tests.operators.soft_maps import choose, own, select, sphere
from tests.scene import edited, reversed_order, without

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def pair():
    objects = sphere("Cow"), sphere("Horse", location=(5, 0, 0))
    choose(*objects)
    return objects


def listed():
    return [(item.label, item.source_vertex, item.target_vertex) for item in own().pairs]


def test_vertices_that_are_named(pair):
    assert call("add_map_pair", source_vertex=3, target_vertex=7, label="nose") == {"FINISHED"}
    call("add_map_pair", source_vertex=4, target_vertex=8)
    assert listed() == [("nose", 3, 7), ("", 4, 8)]
    assert own().active_pair == 1
    with pytest.raises(RuntimeError, match="There is no vertex 9999; Horse has 482 vertices"):
        call("add_map_pair", source_vertex=1, target_vertex=9999)
    with pytest.raises(RuntimeError, match="Vertex 7 of Horse is already in pair 1; remove that pair first"):
        call("add_map_pair", source_vertex=1, target_vertex=7)
    own().pairs[0].enabled = False
    assert call("add_map_pair", source_vertex=1, target_vertex=7) == {"FINISHED"}


def test_the_selected_vertex_of_each(pair):
    select(pair[0], 5)
    select(pair[1], 6)
    call("add_map_pair")
    assert listed() == [("", 5, 6)]
    select(pair[1], 6, 9)
    with pytest.raises(RuntimeError, match="Select one vertex of Horse in Edit Mode; 2 are selected now"):
        call("add_map_pair", source_vertex=1)
    assert len(listed()) == 1


def test_both_at_once_in_edit_mode(pair):
    select(pair[0], 5)
    select(pair[1], 6)
    for obj in pair:
        obj.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    assert {obj.mode for obj in pair} == {"EDIT"}
    call("add_map_pair", "INVOKE_DEFAULT")
    assert listed() == [("", 5, 6)]
    assert {obj.mode for obj in pair} == {"EDIT"}


def test_selecting_everything_identifies_no_vertex(pair):
    with pytest.raises(RuntimeError, match="All vertices of Cow are selected; select fewer"):
        call("add_map_pair")


def test_two_vertices_of_one_object(pair):
    choose(pair[0], pair[0])
    select(pair[0], 5, 9)
    call("add_map_pair")
    select(pair[0], 11)
    call("add_map_pair")
    assert listed() == [("", 5, 9), ("", 11, 11)]
    select(pair[0], 1, 2, 3)
    with pytest.raises(RuntimeError, match="Select two vertices of Cow that mirror each other"):
        call("add_map_pair")


def test_groups_and_empties_add_only_new_pairs(pair, capfd):
    for obj in pair:
        for name, vertex in (("nose", 3), ("tail", 4)):
            obj.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
        obj.vertex_groups.new(name="bone").add(list(range(100)), 1.0, "REPLACE")
    call("add_map_pair", source_vertex=3, target_vertex=9)
    assert call("map_pairs_from_groups") == {"FINISHED"}
    assert listed()[1:] == [("tail", 4, 4)]
    assert "1 pairs added; ignored: bone" in capfd.readouterr().out
    assert call("map_pairs_from_groups", pattern="t*") == {"CANCELLED"}
    with pytest.raises(RuntimeError, match="Cow and Horse have no small vertex groups of the same name"):
        call("map_pairs_from_groups", pattern="b*")
    with pytest.raises(RuntimeError, match="no two Empties of the same name"):
        call("map_pairs_from_empties")
    for name, x in (("ear", 1), ("ear.001", 6)):
        bpy.ops.object.empty_add(location=(x, 0, 0))
        bpy.context.object.name = name
    assert call("map_pairs_from_empties") == {"FINISHED"}
    assert listed()[-1][0] == "ear"


def test_a_vertex_is_added_to_one_pair_only(pair, capfd):
    for obj, vertices in zip(pair, ((3, 3, 4), (5, 6, 7)), strict=True):
        for name, vertex in zip(("nose", "tip", "tail"), vertices, strict=True):
            obj.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    assert call("map_pairs_from_groups") == {"FINISHED"}
    assert listed() == [("nose", 3, 5), ("tail", 4, 7)]
    assert "2 pairs added; ignored: tip" in capfd.readouterr().out


def test_pairs_come_off_the_list(pair):
    for vertex in range(4):
        call("add_map_pair", source_vertex=vertex, target_vertex=vertex)
    call("remove_map_pair", index=0)
    assert [item[1] for item in listed()] == [1, 2, 3]
    assert own().active_pair == 2
    call("remove_map_pair")
    assert [item[1] for item in listed()] == [1, 2]
    with pytest.raises(RuntimeError, match="no item 5"):
        call("remove_map_pair", index=5)
    call("clear_map_pairs")
    assert listed() == []
    for name in ("remove_map_pair", "clear_map_pairs"):
        with pytest.raises(RuntimeError, match="The list of pairs is empty"):
            call(name)


def test_one_undo_step_each(pair):
    bpy.ops.ed.undo_push(message="before")
    call("add_map_pair", source_vertex=3, target_vertex=7)
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert listed() == []


def test_sides_change_places(pair):
    call("add_map_pair", source_vertex=3, target_vertex=7)
    call("swap_map_objects")
    assert (own().source, own().target) == (pair[1], pair[0])
    assert listed() == [("", 7, 3)]


@pytest.mark.parametrize("change", [without(*range(5)), reversed_order], ids=["deleted", "sorted"])
def test_pairs_stay_where_they_were_chosen_when_vertices_are_deleted_or_sorted(pair, change):
    before = [pair[side].data.vertices[vertex].co.copy() for side, vertex in ((0, 30), (1, 70))]
    call("add_map_pair", source_vertex=30, target_vertex=70)
    edited(pair[1], change)
    call("swap_map_objects")
    edited(pair[0], change)
    assert own().vertices_now(own().pairs[0]) == tuple(label.vertex for label in labeled_vertices(bpy.context))
    with pytest.raises(RuntimeError, match="is already in pair 1"):
        call("add_map_pair", source_vertex=own().vertices_now(own().pairs[0])[0], target_vertex=1)
    ((target, source),) = chosen_pairs(own(), "")
    assert [pair[0].data.vertices[source].co, pair[1].data.vertices[target].co] == before
    assert listed() == [("", target, source)]


def test_another_object_has_pairs_at_its_vertices_of_the_same_numbers(pair):
    call("add_map_pair", source_vertex=30, target_vertex=70)
    own().source = sphere("Dog", segments=12, ring_count=6)
    assert chosen_pairs(own(), "").tolist() == [[30, 70]]


def test_a_pair_on_a_part_that_is_deleted_is_shown_and_named(pair):
    call("add_map_pair", source_vertex=0, target_vertex=70)
    upper = [vertex.index for vertex in pair[0].data.vertices if vertex.co.z * pair[0].data.vertices[0].co.z > 0.0]
    edited(pair[0], without(*upper))
    assert own().vertices_now(own().pairs[0]) == (None, 70)
    with pytest.raises(InputError, match="Pair 1 was on a part of Cow that was deleted; remove the pair, or"):
        chosen_pairs(own(), "")


NAMES = ("add_map_pair", "map_pairs_from_groups", "map_pairs_from_empties", "swap_map_objects")


@pytest.mark.parametrize("name", NAMES)
def test_missing_input_is_reported(name):
    with pytest.raises(RuntimeError, match="Choose a source and a target"):
        call(name)
    objects = sphere("Cow"), sphere("Horse")
    choose(*objects)
    bpy.context.collection.objects.unlink(objects[1])
    with pytest.raises(RuntimeError, match="has been deleted; choose another one"):
        call(name)
    choose(objects[0], objects[0])
    bpy.context.window_manager.convwass_progress.running = True
    try:
        with pytest.raises(RuntimeError, match="A job is running"):
            call(name)
    finally:
        bpy.context.window_manager.convwass_progress.running = False


def test_numbers_are_drawn_where_pairs_are(pair):
    call("add_map_pair", source_vertex=3, target_vertex=7)
    call("add_map_pair", source_vertex=4, target_vertex=8)
    own().pairs[0].enabled = False
    found = labeled_vertices(bpy.context)
    assert [(item.obj, item.vertex, item.number) for item in found] == [(pair[0], 4, 2), (pair[1], 8, 2)]
    own().show_labels = False
    assert labeled_vertices(bpy.context) == []


def click(context, pressed, x, y):
    event = SimpleNamespace(type="LEFTMOUSE", value="PRESS", mouse_x=x, mouse_y=y)
    return pressed.modal(context, event)


@pytest.fixture
def clicking(pair, monkeypatch):
    """A window that looks down the Z axis: its pixels are hundredths of a unit."""
    context = window_context()
    context.mode = "OBJECT"
    view = SimpleNamespace(view_matrix=Matrix.Translation((0, 0, 10)).inverted())
    region = SimpleNamespace(type="WINDOW", x=0, y=0, width=2000, height=2000, data=view)
    context.window.screen.areas = [SimpleNamespace(type="VIEW_3D", regions=[region], tag_redraw=lambda: None)]
    said = []
    context.workspace.status_text_set = said.append
    pretend_window(monkeypatch, soft_map_pick)
    monkeypatch.setattr(
        picking,
        "region_2d_to_origin_3d",
        lambda region, view, place: Vector((place[0] / 100 - 2, place[1] / 100 - 2, 10)),
    )
    monkeypatch.setattr(picking, "region_2d_to_vector_3d", lambda region, view, place: Vector((0, 0, -1)))
    context.said = said
    return context


def test_clicks_make_pairs_until_escape(pair, clicking):
    pressed = Pressed(CONVWASS_OT_add_map_pair)
    assert pressed.invoke(clicking, None) == {"RUNNING_MODAL"}
    assert "Pair 1: click on Cow or Horse" in clicking.said[-1]
    assert pressed.modal(clicking, TIMER) == {"PASS_THROUGH"}
    # Horse first, next to its middle; the vertex is the nearest one.
    click(clicking, pressed, 700, 205)
    assert listed() == [("", -1, listed()[0][2])]
    assert "Pair 1: now click on Cow" in clicking.said[-1]
    click(clicking, pressed, 1500, 1500)
    assert "This is not on the source or the target" in pressed.reports[-1][1]
    click(clicking, pressed, 200, 205)
    ((_, source, target),) = listed()
    top = max(pair[0].data.vertices, key=lambda vertex: vertex.co.z).index
    assert (source, target) == (top, top)
    assert "Pair 2" in clicking.said[-1]
    click(clicking, pressed, 200, 205)
    assert pressed.reports[-1][0] == "WARNING"
    assert "of Cow is already in pair 1" in pressed.reports[-1][1]
    assert len(listed()) == 1
    # The last click on an object counts; half a pair is not kept.
    click(clicking, pressed, 230, 200)
    first = listed()[1][1]
    click(clicking, pressed, 260, 200)
    assert listed()[1][1] != first
    assert len(listed()) == 2
    assert pressed.modal(clicking, ESCAPE) == {"CANCELLED"}
    assert len(listed()) == 1
    assert clicking.said[-1] is None


def test_two_clicks_on_one_object(pair, clicking):
    choose(pair[0], pair[0])
    pressed = Pressed(CONVWASS_OT_add_map_pair)
    pressed.invoke(clicking, None)
    click(clicking, pressed, 270, 200)
    click(clicking, pressed, 130, 200)
    ((_, source, target),) = listed()
    assert (pair[0].data.vertices[source].co.x, pair[0].data.vertices[target].co.x) == pytest.approx(
        (0.7, -0.7), abs=0.1
    )


def test_the_nearer_surface_is_clicked_on(pair, clicking):
    pair[1].location = (0, 0, -3)
    bpy.context.view_layer.update()
    pressed = Pressed(CONVWASS_OT_add_map_pair)
    pressed.invoke(clicking, None)
    click(clicking, pressed, 200, 205)
    assert listed()[0][1] >= 0
    pair[0].hide_set(True)
    click(clicking, pressed, 200, 205)
    assert listed()[0][2] >= 0


def test_an_object_that_cannot_be_read_ends_it(pair, clicking, monkeypatch):
    def refuse(*_arguments):
        raise surfaces.InputError("No surface.")

    pressed = Pressed(CONVWASS_OT_add_map_pair)
    pressed.invoke(clicking, None)
    monkeypatch.setattr(picking, "vertex_at", refuse)
    assert click(clicking, pressed, 200, 200) == {"CANCELLED"}
    assert pressed.reports[-1] == ("ERROR", "No surface.")


def test_a_deleted_choice_ends_it(pair, clicking):
    pressed = Pressed(CONVWASS_OT_add_map_pair)
    pressed.invoke(clicking, None)
    own().target = None
    assert pressed.modal(clicking, TIMER) == {"CANCELLED"}
