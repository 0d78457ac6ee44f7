# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins, as buttons and scripts set them, and joints that are placed by clicks."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Vector

from convwass_addon.applications.skeletons import inner_points
from convwass_addon.applications.skeletons.inner_points import InnerPoint
from convwass_addon.bridge.armatures.pins import pinned_ends
from convwass_addon.bridge.armatures.rigs import rig_graph
from convwass_addon.errors import InputError
from convwass_addon.operators import armature_place, picking
from convwass_addon.operators.armature_place import CONVWASS_OT_place_joint
from convwass_addon.properties.armatures import chosen_rig, dotted_rig, is_mesh, is_rig
from tests.operators.running import ESCAPE, TIMER, Pressed, call, window_context
from tests.rigs import armature, chain, choose, lines, own, select_joints, tube, world_ends

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def rig():
    body, rig = tube(), chain(3)
    choose(body, rig)
    bpy.context.view_layer.objects.active = rig
    return rig


def in_edit_mode(rig, *selected):
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    select_joints(rig, *selected)


def test_selected_joints_are_pinned_and_let_go(rig, capfd):
    in_edit_mode(rig, "A.head", "C.tail", "B.tail")
    assert call("pin_joints") == {"FINISHED"}
    assert pinned_ends(rig) == ["A.head", "B.tail", "C.tail"]
    assert "Pinned: A.head, B.tail, C.tail" in capfd.readouterr().out
    select_joints(rig, "C.head")
    call("unpin_joints")
    assert pinned_ends(rig) == ["A.head", "C.tail"]
    assert "No longer pinned: B.tail" in capfd.readouterr().out
    assert rig.mode == "EDIT"


def test_named_joints_in_any_mode(rig):
    for mode in ("OBJECT", "POSE", "EDIT"):
        bpy.ops.object.mode_set(mode=mode)
        call("pin_joints", joints="A.head, B.head\n" if mode == "POSE" else "A.head,B.head")
        assert pinned_ends(rig) == ["A.head", "A.tail"]
        call("clear_pins")
        assert pinned_ends(rig) == []


def test_each_is_an_undo_step(rig):
    for mode in ("OBJECT", "EDIT"):
        bpy.ops.object.mode_set(mode=mode)
        bpy.ops.ed.undo_push(message="before")
        call("pin_joints", joints="A.head")
        bpy.ops.ed.undo_push(message="pinned")
        call("clear_pins")
        bpy.ops.ed.undo_push(message="cleared")
        bpy.ops.ed.undo()
        assert pinned_ends(bpy.data.objects["Rig"]) == ["A.head"]
        bpy.ops.ed.undo()
        assert pinned_ends(bpy.data.objects["Rig"]) == []


def test_joints_that_cannot_be_pinned(rig):
    for name in ("pin_joints", "unpin_joints"):
        with pytest.raises(RuntimeError, match="No joint of Rig is selected; go to Edit Mode"):
            call(name)
        with pytest.raises(RuntimeError, match=r"There is no joint Arm\.tail"):
            call(name, joints="Arm.tail")
    with pytest.raises(RuntimeError, match="No joint is pinned"):
        call("clear_pins")
    rig.hide_set(True)
    with pytest.raises(RuntimeError, match="Rig or its collection is hidden"):
        call("pin_joints", joints="A.head")


def test_the_active_armature_is_the_default(rig):
    own().rig = None
    assert chosen_rig(bpy.context) == rig
    call("pin_joints", joints="A.head")
    assert pinned_ends(rig) == ["A.head"]
    bpy.context.view_layer.objects.active = own().body
    with pytest.raises(RuntimeError, match="Choose an armature, or make one active"):
        call("pin_joints", joints="A.head")
    own().rig = rig
    bpy.context.collection.objects.unlink(rig)
    with pytest.raises(RuntimeError, match="The armature has been deleted; choose another one"):
        call("pin_joints", joints="A.head")


def test_only_suitable_objects_can_be_chosen(rig):
    edges, body = lines([(0, 0, 0), (1, 0, 0)], [(0, 1)]), own().body
    assert [is_rig(own(), obj) for obj in (rig, edges, body)] == [True, True, False]
    assert [is_mesh(own(), obj) for obj in (rig, edges, body)] == [False, True, True]


def test_joints_are_drawn_while_there_is_a_body(rig):
    assert dotted_rig(bpy.context) == rig
    own().show_joints = False
    assert dotted_rig(bpy.context) is None
    own().show_joints, own().body = True, None
    assert dotted_rig(bpy.context) is None


def test_a_mesh_of_edges_has_pins_too(rig):
    edges = lines([(0, 0, 0), (1, 0, 0)], [(0, 1)])
    own().rig = edges
    call("pin_joints", joints="1")
    assert pinned_ends(edges) == ["1"]
    call("clear_pins")
    assert pinned_ends(edges) == []


# Joints that are placed.


@pytest.fixture
def axis(monkeypatch):
    """The point behind a point of the tube is the one on its axis, at its own place along it."""
    asked = []

    class Finder:
        def __init__(self, mesh):
            self.mesh = mesh

        def find(self, point, depth):
            asked.append((np.array(point), depth))
            return InnerPoint(np.array((point[0], 0.0, 0.0)), 0.4)

    monkeypatch.setattr(inner_points, "InnerPointFinder", Finder)
    return asked


def test_a_joint_is_placed_and_pinned(rig, axis, capfd):
    rig.location = (0, 0, 3)
    bpy.context.view_layer.update()
    assert call("place_joint", joints="C.tail", location=(3.5, 0, 0.4), depth=0.5) == {"FINISHED"}
    np.testing.assert_allclose(world_ends(rig)["C.tail"], (3.5, 0, 0), atol=1e-6)
    np.testing.assert_allclose(world_ends(rig)["C.head"], (2, 0, 3), atol=1e-6)
    assert pinned_ends(rig) == ["C.tail"]
    assert axis[0][1] == pytest.approx(0.5)
    assert "C.tail is pinned 40 cm behind the surface" in capfd.readouterr().out
    assert rig_graph(rig).graph.lengths == pytest.approx([1, 1, 1])


def test_control_bones_keep_their_lengths_where_a_joint_is_placed(axis):
    bones = [
        ("Target", (3, 0, 0), (3, 0, 1), None, False),
        ("Arm", (0, 0, 0), (3, 0, 0), None, False),
        ("Root", (0, 0, -1), (0, 0, 0), None, False),
    ]
    rig = armature(bones)
    for name in ("Target", "Root"):
        rig.data.bones[name].use_deform = False
    choose(tube(), rig)
    call("place_joint", joints="Target.head", location=(3.5, 0, 0.4))
    call("place_joint", joints="Arm.head", location=(0.5, 0, 0.4))
    found = world_ends(rig)
    wanted = {
        "Target": ((3.5, 0, 0), (3.5, 0, 1)),
        "Arm": ((0.5, 0, 0), (3.5, 0, 0)),
        "Root": ((0.5, 0, -1), (0.5, 0, 0)),
    }
    for name, ends in wanted.items():
        np.testing.assert_allclose([found[f"{name}.head"], found[f"{name}.tail"]], ends, atol=1e-6)
    call("place_joint", joints="Target.tail", location=(3.5, 0, 0.4))
    np.testing.assert_allclose(world_ends(rig)["Target.head"], (3.5, 0, 0), atol=1e-6)
    assert rig_graph(rig).graph.pinned.all()


def test_placing_is_one_undo_step(rig, axis):
    bpy.ops.ed.undo_push(message="before")
    call("place_joint", joints="C.tail", location=(3.5, 0, 0.4))
    bpy.ops.ed.undo_push(message="placed")
    bpy.ops.ed.undo()
    rig = bpy.data.objects["Rig"]
    assert pinned_ends(rig) == []
    np.testing.assert_allclose(world_ends(rig)["C.tail"], (3, 0, 0), atol=1e-6)


def test_pins_that_cannot_be_placed(rig, monkeypatch):
    with pytest.raises(RuntimeError, match="One surface point cannot place 2 joints"):
        call("place_joint", joints="A.head, C.tail", location=(0, 0, 0))
    with pytest.raises(RuntimeError, match="No joint of Rig is selected"):
        call("place_joint", location=(0, 0, 0))

    def refuse(*_arguments):
        raise InputError("The body encloses nothing.")

    monkeypatch.setattr(inner_points, "InnerPointFinder", refuse)
    with pytest.raises(RuntimeError, match="The body encloses nothing"):
        call("place_joint", joints="C.tail", location=(0, 0, 0))
    assert pinned_ends(rig) == []
    own().body = None
    with pytest.raises(RuntimeError, match="Choose a body, the mesh to fit the armature into"):
        call("place_joint", joints="C.tail", location=(0, 0, 0))


@pytest.fixture
def clicking(rig, axis, monkeypatch):
    """A window that looks down the Z axis: its pixels are hundredths of a unit."""
    context = window_context()
    context.mode = "EDIT_ARMATURE"
    region = SimpleNamespace(type="WINDOW", x=0, y=0, width=2000, height=2000, data=None)
    context.window.screen.areas = [SimpleNamespace(type="VIEW_3D", regions=[region], tag_redraw=lambda: None)]
    said = []
    context.workspace.status_text_set = said.append
    ops = SimpleNamespace(ed=bpy.ops.ed)
    monkeypatch.setattr(
        armature_place, "bpy", SimpleNamespace(app=SimpleNamespace(background=False), ops=ops, types=bpy.types)
    )
    monkeypatch.setattr(
        picking,
        "region_2d_to_origin_3d",
        lambda region, view, place: Vector((place[0] / 100, place[1] / 100 - 2, 10)),
    )
    monkeypatch.setattr(picking, "region_2d_to_vector_3d", lambda region, view, place: Vector((0, 0, -1)))
    context.said = said
    return context


def click(context, pressed, x, y):
    return pressed.modal(context, SimpleNamespace(type="LEFTMOUSE", value="PRESS", mouse_x=x, mouse_y=y))


def place_operator():
    return Pressed(CONVWASS_OT_place_joint, properties=SimpleNamespace(is_property_set=lambda name: False))


def test_one_click_for_each_selected_joint(rig, clicking, axis):
    in_edit_mode(rig, "A.head", "C.tail")
    pressed = place_operator()
    assert pressed.invoke(clicking, None) == {"RUNNING_MODAL"}
    assert "where A.head belongs (2 left)" in clicking.said[-1]
    assert pressed.modal(clicking, TIMER) == {"PASS_THROUGH"}
    assert click(clicking, pressed, 1500, 1500) == {"RUNNING_MODAL"}
    assert "This is not on the body" in pressed.reports[-1][1]
    assert click(clicking, pressed, 50, 200) == {"RUNNING_MODAL"}
    assert "where C.tail belongs (1 left)" in clicking.said[-1]
    assert click(clicking, pressed, 350, 210) == {"CANCELLED"}
    assert clicking.said[-1] is None
    assert pinned_ends(rig) == ["A.head", "C.tail"]
    bpy.ops.object.mode_set(mode="OBJECT")
    np.testing.assert_allclose(world_ends(rig)["A.head"], (0.5, 0, 0), atol=1e-5)
    np.testing.assert_allclose(world_ends(rig)["C.tail"], (3.5, 0, 0), atol=1e-5)
    # The clicks were on top of the tube.
    assert axis[0][0] == pytest.approx((0.5, 0, 0.4), abs=0.06)


def test_escape_keeps_placed_pins(rig, clicking):
    in_edit_mode(rig, "A.head", "C.tail")
    pressed = place_operator()
    pressed.invoke(clicking, None)
    click(clicking, pressed, 50, 200)
    assert pressed.modal(clicking, ESCAPE) == {"CANCELLED"}
    assert pinned_ends(rig) == ["A.head"]


def test_nothing_selected_or_a_deleted_body(rig, clicking):
    pressed = place_operator()
    assert pressed.invoke(clicking, None) == {"CANCELLED"}
    assert "No joint of Rig is selected" in pressed.reports[-1][1]
    in_edit_mode(rig, "A.head")
    pressed.invoke(clicking, None)
    own().body = None
    assert pressed.modal(clicking, TIMER) == {"CANCELLED"}


def test_a_body_that_cannot_be_used_ends_it(rig, clicking, monkeypatch):
    def refuse(*_arguments):
        raise InputError("The body encloses nothing.")

    in_edit_mode(rig, "A.head")
    pressed = place_operator()
    pressed.invoke(clicking, None)
    monkeypatch.setattr(inner_points.InnerPointFinder, "find", refuse)
    assert click(clicking, pressed, 50, 200) == {"CANCELLED"}
    assert pressed.reports[-1] == ("ERROR", "The body encloses nothing.")
    monkeypatch.setattr(inner_points, "InnerPointFinder", refuse)
    assert pressed.invoke(clicking, None) == {"CANCELLED"}
