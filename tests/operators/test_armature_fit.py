# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fitting armatures: written and unchanged data, and refused input; the layout is replaced by a stub."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Vector

from convwass_addon.applications.skeletons import skeleton_fit
from convwass_addon.applications.skeletons.skeleton_settings import SkeletonSettings
from convwass_addon.bridge.armatures.auto_weights import bind_with_weights, unweighted
from convwass_addon.bridge.armatures.fit_notices import unweighted_notice
from convwass_addon.bridge.armatures.pins import pinned_ends
from convwass_addon.errors import InputError
from convwass_addon.operators import armature_fit
from convwass_addon.operators.armature_fit import CONVWASS_OT_fit_armature
from convwass_addon.progress import UNINTERRUPTED, Progress
from convwass_addon.properties.armatures import FitProperties
from convwass_addon.sentence import Sentence
from tests.operators.running import ESCAPE, TIMER, Pressed, call, pretend_window, until, window_context
from tests.rigs import armature, chain, choose, harmonic, harmonic_steps, lines, own, tube, world_ends

pytestmark = pytest.mark.usefixtures("empty_scene")

# Ends of a chain of four bones of 0.9 along X.
ENDS = "A.head, D.tail"


@pytest.fixture
def asked(monkeypatch):
    """Record the requests for a fit, and place the joints between the pins."""
    calls = []

    def steps(mesh, graph, settings, control=UNINTERRUPTED):
        calls.append(SimpleNamespace(mesh=mesh, graph=graph, settings=settings))
        return harmonic_steps(mesh, graph, settings, control)

    monkeypatch.setattr(skeleton_fit, "fit_steps", steps)
    return calls


@pytest.fixture
def rig(asked):
    """A chain that is bent out of the tube, with its ends pinned inside."""
    body, rig = tube(), chain(4, 0.9)
    choose(body, rig)
    call("pin_joints", joints=ENDS)
    bend(rig)
    return rig


def bend(rig):
    """Move the middle joint away after lengths have been stored."""
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones["B"].tail = (1.8, 3, 0)
    bpy.ops.object.mode_set(mode="OBJECT")


def is_straight(rig):
    """Whether all bones of the chain are on the X axis with their original lengths."""
    ends = world_ends(rig)
    return all(
        np.allclose(ends[f"{name}.tail"], ((place + 1) * 0.9, 0, 0), atol=1e-5) for place, name in enumerate("ABCD")
    )


def test_free_joints_are_moved_and_pinned_ones_stay(rig, capfd):
    assert not is_straight(rig)
    assert call("fit_armature") == {"FINISHED"}
    assert is_straight(rig)
    assert pinned_ends(rig) == ["A.head", "D.tail"]
    assert "Rig fitted into Tube: 5 of 5 joints are inside" in capfd.readouterr().out
    assert rig.mode == "OBJECT"


def test_in_edit_mode_too(rig):
    bpy.ops.object.mode_set(mode="EDIT")
    assert call("fit_armature") == {"FINISHED"}
    assert rig.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert is_straight(rig)


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT", "POSE"])
def test_it_is_one_undo_step(rig, mode):
    bpy.ops.object.mode_set(mode=mode)
    bpy.ops.ed.undo_push(message="before")
    call("fit_armature", auto_weights=mode != "EDIT")
    bpy.ops.ed.undo_push(message="fitted")
    bpy.ops.ed.undo()
    bpy.ops.object.mode_set(mode="OBJECT")
    rig, body = bpy.data.objects["Rig"], bpy.data.objects["Tube"]
    np.testing.assert_allclose(world_ends(rig)["B.tail"], (1.8, 3, 0), atol=1e-5)
    assert not body.vertex_groups
    assert body.parent is None


def test_arguments_of_the_fit(rig, asked):
    own().body.location = (0, 0, 7)
    call(
        "fit_armature",
        gamma=0.005,
        weights="UNIFORM",
        links=5,
        placement="EXPECTED",
        limit_spread=True,
        slack=2.0,
        outside_pins="MOVE",
        thickness=0.25,
    )
    (given,) = asked
    expected = SkeletonSettings(
        gamma=0.005,
        slack=2.0,
        weights="uniform",
        links=5,
        placement="expected",
        outside_pins="move",
        thickness=0.25,
    ).as_dict()
    assert given.settings.as_dict() == pytest.approx(expected)
    assert given.mesh.vertices[:, 2].mean() == pytest.approx(7, abs=1e-5)
    assert given.graph.names == ("A.head", "A.tail", "B.tail", "C.tail", "D.tail")
    assert given.graph.pinned.tolist() == [True, False, False, False, True]
    # Those from before it was bent.
    np.testing.assert_allclose(given.graph.lengths, [0.9] * 4, rtol=1e-5)


def test_defaults_are_those_of_the_application(rig, asked):
    call("fit_armature")
    assert asked[0].settings.as_dict() == pytest.approx(SkeletonSettings().as_dict())


def test_bones_that_do_not_deform_move_along(asked):
    bones = [
        ("Arm", (0.2, 0, 0), (2, 0, 0), None, False),
        ("Hand", (2, 0, 0), (3.8, 0, 0), "Arm", True),
        ("Target", (3.8, 0, 0), (3.8, 0, 1), None, False),
    ]
    rig = armature(bones)
    rig.data.bones["Target"].use_deform = False
    choose(tube(), rig)
    call("pin_joints", joints="Arm.head, Hand.tail")
    call("fit_armature")
    assert asked[0].graph.names == ("Arm.head", "Arm.tail", "Hand.tail")
    call("pin_joints", joints="Target.tail")
    call("fit_armature", bones="ALL")
    assert "Target.tail" in asked[1].graph.names


def test_a_mesh_of_edges(asked):
    edges = lines([(0.2, 0, 0), (1, 5, 0), (3.8, 0, 0)], [(0, 1), (1, 2)])
    choose(tube(), edges)
    call("pin_joints", joints="0, 2")
    call("fit_armature", weights="UNIFORM")
    np.testing.assert_allclose(edges.data.vertices[1].co, (2, 0, 0), atol=0.3)
    with pytest.raises(RuntimeError, match="Lines is not an armature, so it cannot provide weights"):
        call("fit_armature", auto_weights=True)


def test_a_mesh_of_edges_with_shape_keys(asked):
    edges = lines([(0.2, 0, 0), (1, 5, 0), (3.8, 0, 0)], [(0, 1), (1, 2)])
    choose(tube(), edges)
    call("pin_joints", joints="0, 2")
    edges.shape_key_add(name="Basis")
    with pytest.raises(RuntimeError, match="Lines has shape keys, which hold its joints in place"):
        call("fit_armature")
    assert not asked


def test_automatic_weights(rig, capfd):
    body = own().body
    body.vertex_groups.new(name="Mask").add([0, 1, 2], 0.5, "REPLACE")
    assert call("fit_armature", auto_weights=True) == {"FINISHED"}
    assert (body.parent, [modifier.type for modifier in body.modifiers]) == (rig, ["ARMATURE"])
    assert {"Mask", "A", "B", "C", "D"} == {group.name for group in body.vertex_groups}
    assert body.vertex_groups["Mask"].weight(1) == pytest.approx(0.5)
    assert "without a bone" not in capfd.readouterr().out
    rig.pose.bones["C"].rotation_mode = "XYZ"
    rig.pose.bones["C"].rotation_euler = (0, 0, 1)
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    moved = np.array([vertex.co for vertex in body.evaluated_get(depsgraph).data.vertices])
    rest = np.array([vertex.co for vertex in body.data.vertices])
    shift = np.linalg.norm(moved - rest, axis=1)
    assert shift[rest[:, 0] > 3.5].min() > 0.3
    assert shift[rest[:, 0] < 0.5].max() < 0.05
    # Repeat for the mesh that is now bound and posed.
    assert call("fit_armature", auto_weights=True) == {"FINISHED"}
    assert len(body.modifiers) == 1
    assert "Rig is posed, but the fit applies to its rest position" in capfd.readouterr().out


def test_weights_leave_a_body_with_another_parent_in_place(rig):
    body, root = own().body, bpy.data.objects.new("Root", None)
    bpy.context.collection.objects.link(root)
    root.location, body.location, body.parent = (5, 1, 0), (-5, -1, 0), root
    bpy.context.view_layer.update()
    before = np.array(body.matrix_world)
    assert call("fit_armature", auto_weights=True) == {"FINISHED"}
    assert body.parent == rig
    bpy.context.view_layer.update()
    np.testing.assert_allclose(np.array(body.matrix_world), before, atol=1e-5)


def test_weights_leave_a_sheared_body_in_place(rig):
    """A turned child of an unevenly scaled parent has a matrix that no location, rotation and scale give."""
    body, root = own().body, bpy.data.objects.new("Root", None)
    bpy.context.collection.objects.link(root)
    root.scale.y, body.rotation_euler.z, body.parent = 2.0, 0.2, root
    bpy.context.view_layer.update()
    before = np.array(body.matrix_world)
    for _ in range(2):
        assert call("fit_armature", auto_weights=True) == {"FINISHED"}
        assert body.parent == rig
        bpy.context.view_layer.update()
        np.testing.assert_allclose(np.array(body.matrix_world), before, atol=1e-5)


def test_weights_without_a_solution_are_reported(rig, monkeypatch, capfd):
    monkeypatch.setattr(armature_fit, "bind_with_weights", lambda body, rig: 7)
    call("fit_armature", auto_weights=True)
    assert "Automatic weights left 7 of" in capfd.readouterr().out
    assert unweighted_notice(0, own().body) == []


def test_vertices_that_no_bone_reaches_are_counted(rig):
    body = own().body
    assert bind_with_weights(body, rig) == 0
    for group in body.vertex_groups:
        group.remove([0, 1])
    body.vertex_groups.new(name="Mask").add([0], 1.0, "REPLACE")
    assert unweighted(body, rig) == 2
    for bone in rig.data.bones:
        bone.use_deform = False
    assert unweighted(body, rig) == len(body.data.vertices)


def test_weights_ask_for_object_mode(rig):
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Rig is in Edit Mode; leave it with Tab"):
        call("fit_armature", auto_weights=True)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = own().body
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Tube is in Edit Mode; leave it with Tab"):
        call("fit_armature", auto_weights=True)


def test_impossible_parents_are_reported(rig):
    link = bpy.data.objects.new("Link", None)
    bpy.context.collection.objects.link(link)
    rig.parent, link.parent = link, own().body
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="Rig is a child of Tube and cannot become its parent; clear its own parent"):
        call("fit_armature", auto_weights=True)
    assert world_ends(rig)["B.tail"] == pytest.approx((1.8, 3, 0))


def test_what_blender_does_not_bind_is_reported(rig, monkeypatch):
    monkeypatch.setattr(armature_fit, "require_bindable", lambda body, rig: None)
    rig.parent = own().body
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="Tube could not be bound to Rig"):
        call("fit_armature", auto_weights=True)


def test_rotated_scaled_and_parented(rig):
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    parent.location, parent.rotation_euler, parent.scale = (0, 2, 0), (0.4, 0, 1), (3, 3, 3)
    rig.parent, rig.rotation_euler, rig.scale = parent, (0, 0.3, 0), (0.5, 0.5, 0.5)
    bpy.context.view_layer.update()
    ends = [world_ends(rig)[name] for name in ("A.head", "D.tail")]
    call("fit_armature")
    found = world_ends(rig)
    for place, name in enumerate("ABC", start=1):
        np.testing.assert_allclose(found[f"{name}.tail"], ends[0] + place / 4 * (ends[1] - ends[0]), atol=1e-4)


def test_a_pose_is_reported_and_kept(rig, capfd):
    bone = rig.pose.bones["B"]
    bone.rotation_mode = "XYZ"
    bone.rotation_euler = (0, 0, 0.5)
    bone.keyframe_insert("rotation_euler", frame=1)
    bone.rotation_euler = (0, 0, 1)
    bone.keyframe_insert("rotation_euler", frame=9)
    bpy.context.scene.frame_set(5)
    call("fit_armature")
    assert is_straight(rig)
    assert "Rig is posed, but the fit applies to its rest position, as in Edit Mode" in capfd.readouterr().out
    bpy.context.scene.frame_set(9)
    assert rig.pose.bones["B"].rotation_euler.z == pytest.approx(1)


def test_notices_are_reported(rig, monkeypatch, capfd):
    def steps(mesh, graph, settings, control=UNINTERRUPTED):
        found = harmonic(graph, [Sentence("Pins were moved.")])
        found.positions[2] = found.positions[1]
        yield Progress(1.0, Sentence("Writing"))
        return found

    monkeypatch.setattr(skeleton_fit, "fit_steps", steps)
    call("fit_armature")
    said = capfd.readouterr().out
    assert "Warning" in said
    assert "Pins were moved" in said
    assert "These bones lost their length and are tiny now: B" in said


# What stands in the way.


def test_missing_input_is_reported(asked):
    with pytest.raises(RuntimeError, match="Choose an armature, or make one active"):
        call("fit_armature")
    rig = chain(2)
    with pytest.raises(RuntimeError, match="Choose a body, the mesh to fit the armature into"):
        call("fit_armature")
    body = tube()
    choose(body, rig)
    with pytest.raises(RuntimeError, match="No joint of Rig is pinned"):
        call("fit_armature")
    bpy.context.collection.objects.unlink(body)
    with pytest.raises(RuntimeError, match="The body has been deleted; choose another one"):
        call("fit_armature")
    edges = lines([(0, 0, 0), (1, 0, 0)], [(0, 1)])
    choose(edges, edges)
    with pytest.raises(RuntimeError, match="Body and armature are the same object"):
        call("fit_armature")


def test_invalid_bodies(rig):
    own().body = lines([(0, 0, 0), (1, 0, 0)], [(0, 1)])
    with pytest.raises(RuntimeError, match="Lines has edges but no faces"):
        call("fit_armature")
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.scale = (0, 1, 1)
    own().body = bpy.context.object
    with pytest.raises(RuntimeError, match="scale of zero"):
        call("fit_armature")


def test_bones_without_length(rig):
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("Dot")
    bone.head = bone.tail = (1, 1, 1)
    with pytest.raises(RuntimeError, match="The bone Dot has no length; move its tail away"):
        call("fit_armature")


def test_two_pins_in_one_place(rig):
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones["D"].tail = rig.data.edit_bones["A"].head
    with pytest.raises(RuntimeError, match=r"D\.tail and A\.head are pinned in the same place; move or unpin one"):
        call("fit_armature")
    # They are one joint now, so both pins are removed.
    call("unpin_joints", joints="A.head")
    assert pinned_ends(rig) == []


def test_hidden_and_running(rig):
    rig.hide_set(True)
    with pytest.raises(RuntimeError, match="Rig or its collection is hidden"):
        call("fit_armature")
    progress = bpy.context.window_manager.convwass_progress
    progress.running = True
    try:
        with pytest.raises(RuntimeError, match="A job is running"):
            call("fit_armature")
    finally:
        progress.running = False


def test_a_refused_fit_changes_nothing(rig, monkeypatch):
    def steps(mesh, graph, settings, control=UNINTERRUPTED):
        raise InputError("The pin {name} lies outside.", name="A.head")
        yield

    monkeypatch.setattr(skeleton_fit, "fit_steps", steps)
    with pytest.raises(RuntimeError, match=r"The pin A.head lies outside"):
        call("fit_armature")
    np.testing.assert_allclose(world_ends(rig)["B.tail"], (1.8, 3, 0), atol=1e-5)


# For real.


def test_a_ring_goes_around_the_hole_of_a_torus(capfd):
    """Three joints of eight are pinned on the tube's circle; the others are far away, and the rig is scaled."""
    bpy.ops.mesh.primitive_torus_add(major_radius=2, minor_radius=0.5, major_segments=36)
    body = bpy.context.object
    angles = np.linspace(0, 2 * np.pi, 9)
    places = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1) * 4
    places[8] = places[0]
    rig = armature([(f"B{k}", places[k], places[k + 1], f"B{k - 1}" if k else None, k > 0) for k in range(8)])
    rig.scale = (0.5, 0.5, 0.5)
    bpy.context.view_layer.update()
    choose(body, rig)
    call("pin_joints", joints="B0.head, B2.tail, B5.tail")
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name in ("B0", "B1", "B3", "B4", "B6"):
        rig.data.edit_bones[name].tail += Vector((0, 0, 8))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert call("fit_armature", auto_weights=True) == {"FINISHED"}
    assert "8 of 8 joints are inside" in capfd.readouterr().out
    for point in world_ends(rig).values():
        assert np.hypot(np.hypot(point[0], point[1]) - 2, point[2]) < 0.1
    lengths = np.array([bone.length for bone in rig.data.bones])
    assert np.ptp(lengths) < 0.15 * lengths.mean()


# In a window.


@pytest.fixture
def window(rig, monkeypatch):
    context = window_context()
    context.mode, context.object = "OBJECT", rig
    pretend_window(monkeypatch)
    return context


def pressed_fit(**settings):
    pressed = Pressed(CONVWASS_OT_fit_armature, **settings)
    defaults = {name: getattr(pressed, name) for name in vars(FitProperties)["__annotations__"]}
    pressed.arguments = {**defaults, **settings}
    return pressed


def test_it_runs_in_the_background(window, rig):
    pressed = pressed_fit()
    assert pressed.invoke(window, None) == {"RUNNING_MODAL"}
    assert until(pressed, window) == {"FINISHED"}
    assert is_straight(rig)
    assert pressed.reports[-1][0] == "INFO"


def test_escape_leaves_everything_as_it_was(window, rig, monkeypatch):
    def endless(mesh, graph, settings, control=UNINTERRUPTED):
        while True:
            control.check()
            yield Progress(0.5, Sentence("Starting"))

    monkeypatch.setattr(skeleton_fit, "fit_steps", endless)
    pressed = pressed_fit()
    pressed.invoke(window, None)
    pressed.modal(window, TIMER)
    while (result := pressed.modal(window, ESCAPE)) == {"PASS_THROUGH"}:
        pass
    assert result == {"CANCELLED"}
    assert pressed.reports[-1] == ("INFO", "Stopped; nothing was changed")
    np.testing.assert_allclose(world_ends(rig)["B.tail"], (1.8, 3, 0), atol=1e-5)


def test_the_result_waits_for_edit_mode_of_something_else(window, rig):
    pressed = pressed_fit()
    pressed.invoke(window, None)
    bpy.context.view_layer.objects.active = own().body
    bpy.ops.object.mode_set(mode="EDIT")
    window.mode = "EDIT_MESH"
    progress = window.window_manager.convwass_progress
    assert until(pressed, window, lambda: "leave Edit Mode" in progress.message) == {"PASS_THROUGH"}
    bpy.ops.object.mode_set(mode="OBJECT")
    window.mode = "OBJECT"
    assert until(pressed, window) == {"FINISHED"}
    assert is_straight(rig)


def test_the_result_waits_for_a_stroke_and_comes_in_edit_mode(window, rig):
    bpy.ops.object.mode_set(mode="EDIT")
    window.mode = "EDIT_ARMATURE"
    window.window.modal_operators = [SimpleNamespace(bl_idname="TRANSFORM_OT_translate")]
    pressed = pressed_fit()
    pressed.invoke(window, None)
    progress = window.window_manager.convwass_progress
    until(pressed, window, lambda: "after this stroke" in progress.message)
    window.window.modal_operators = []
    assert until(pressed, window) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert is_straight(rig)


@pytest.mark.parametrize("which", ["body", "rig"])
def test_objects_deleted_during_the_fit_are_reported(window, rig, which):
    pressed = pressed_fit()
    pressed.invoke(window, None)
    bpy.data.objects.remove(own().body if which == "body" else rig)
    assert until(pressed, window) == {"CANCELLED"}
    assert "The body or the armature was deleted, or its creation undone" in pressed.reports[-1][1]


def test_bones_added_during_the_fit_are_reported(window, rig):
    pressed = pressed_fit()
    pressed.invoke(window, None)
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones.new("New").tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert until(pressed, window) == {"CANCELLED"}
    assert "The bones of Rig have changed since the start" in pressed.reports[-1][1]
