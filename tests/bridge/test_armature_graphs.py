# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures as joints, and joints as bones again."""

from __future__ import annotations

import math
from dataclasses import replace

import bpy
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from mathutils import Euler, Matrix, Vector

from convwass_addon.bridge.armatures.armature_graphs import armature_graph
from convwass_addon.bridge.armatures.joint_moves import move_armature_joints
from convwass_addon.bridge.armatures.pins import clear_pins, pin_joints, pinned_ends, unpin_joints, with_pins
from convwass_addon.bridge.armatures.rig_bones import note_rest
from convwass_addon.bridge.armatures.rigs import is_posed, require_movable, resting_body, rig_graph
from convwass_addon.errors import InputError
from tests.linked_objects import linked_to_new_file
from tests.rigs import armature, chain, select_joints, tube, world_ends

pytestmark = pytest.mark.usefixtures("registered_addon")

# A spine, two legs, one of which begins at the spine's head, and a detached child.
CREATURE = [
    ("Spine", (0, 0, 0), (2, 0, 0), None, False),
    ("Leg.L", (0, 0, 0), (0, 1, -1), "Spine", False),
    ("Leg.R", (0.2, -0.5, 0), (0, -1, -1), "Spine", False),
    ("Foot.L", (0, 1, -1), (0, 1, -2), "Leg.L", True),
]


def lines(rig):
    names = rig.graph.names
    return {frozenset((names[a], names[b])) for a, b in rig.graph.edges.tolist()}


def test_a_chain_is_a_path_of_joints():
    rig = armature_graph(chain(3))
    assert rig.graph.names == ("A.head", "A.tail", "B.tail", "C.tail")
    np.testing.assert_allclose(rig.graph.positions, [(place, 0, 0) for place in range(4)], atol=1e-6)
    assert rig.graph.edges.tolist() == [[0, 1], [1, 2], [2, 3]]
    assert rig.ends[1] == ("A.tail", "B.head")
    assert rig.joint("B.head") == 1
    assert not rig.graph.pinned.any()


def test_ends_that_coincide_are_one_joint_and_others_hang_on_their_parent():
    rig = armature_graph(armature(CREATURE))
    assert rig.ends[rig.joint("Leg.L.head")] == ("Spine.head", "Leg.L.head")
    assert lines(rig) == {
        frozenset(("Spine.head", "Spine.tail")),
        frozenset(("Spine.head", "Leg.L.tail")),
        frozenset(("Leg.L.tail", "Foot.L.tail")),
        frozenset(("Spine.head", "Leg.R.head")),
        frozenset(("Leg.R.head", "Leg.R.tail")),
    }


def test_bones_without_relation_that_meet_are_joined_too():
    bones = [
        ("A", (0, 0, 0), (1, 0, 0), None, False),
        ("B", (1, 0, 0), (1, 1, 0), None, False),
        ("C", (1, 1, 0), (0, 0, 0), None, False),
    ]
    rig = armature_graph(armature(bones))
    assert (len(rig.graph.positions), len(rig.graph.edges)) == (3, 3)


def test_parents_that_are_left_out_are_skipped():
    obj = armature(
        [
            ("Root", (0, 0, 0), (0, 0, 1), None, False),
            ("Control", (0, 0, 2), (0, 1, 2), "Root", False),
            ("Arm", (0, 0, 3), (0, 0, 4), "Control", False),
        ]
    )
    obj.data.bones["Control"].use_deform = False
    assert lines(armature_graph(obj)) == {
        frozenset(("Root.head", "Root.tail")),
        frozenset(("Root.tail", "Arm.head")),
        frozenset(("Arm.head", "Arm.tail")),
    }
    assert len(armature_graph(obj, only_deforming=False).graph.positions) == 6
    for bone in obj.data.bones:
        bone.use_deform = False
    assert len(armature_graph(obj).graph.positions) == 6


def test_joints_stand_in_the_world():
    obj, parent = chain(2), bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    parent.location, parent.scale = (1, 2, 3), (2, 1, 1)
    obj.parent, obj.rotation_euler, obj.location = parent, (0.1, 0.2, 0.3), (4, 0, 0)
    bpy.context.view_layer.update()
    rig = armature_graph(obj)
    expected = world_ends(obj)
    for name, position in zip(rig.graph.names, rig.graph.positions, strict=True):
        np.testing.assert_allclose(position, expected[name], atol=1e-5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda obj: setattr(obj, "scale", (1, 0, 1)), "Rig has a scale of zero"),
        (lambda obj: setattr(obj, "location", (np.nan, 0, 0)), "is not a number"),
    ],
)
def test_matrices_that_cannot_be_undone(change, message):
    obj = chain(2)
    change(obj)
    bpy.context.view_layer.update()
    with pytest.raises(InputError, match=message):
        armature_graph(obj)


def test_no_bones_and_bones_without_length():
    obj = armature([])
    with pytest.raises(InputError, match="Rig has no bones; add some"):
        armature_graph(obj)
    obj = chain(2, name="Other")
    bpy.ops.object.mode_set(mode="EDIT")
    obj.data.edit_bones["B"].tail = obj.data.edit_bones["B"].head
    with pytest.raises(InputError, match="The bone B has no length"):
        armature_graph(obj)


def test_a_name_that_is_no_joint():
    rig = armature_graph(chain(2))
    with pytest.raises(InputError, match=r"There is no joint Z.head; joints are named after bones, such as A.head"):
        rig.joint("Z.head")


def moved(obj, change):
    """Move joints by their names, world space; return the graph."""
    rig = rig_graph(obj)
    positions = rig.graph.positions.copy()
    for name, place in change.items():
        positions[rig.joint(name)] = place
    assert move_armature_joints(obj, rig, positions) == []
    return rig


@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_joints_are_placed_correctly(seed, in_edit_mode):
    """Under any transform and in either mode; names, parents and connections are unchanged."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    random = np.random.default_rng(seed)
    obj = armature(CREATURE)
    obj.matrix_world = Matrix.LocRotScale(
        random.normal(size=3), Euler(random.uniform(-3, 3, 3)), random.uniform(0.2, 3, 3)
    )
    bpy.context.view_layer.update()
    if in_edit_mode:
        bpy.ops.object.mode_set(mode="EDIT")
    rig = armature_graph(obj)
    before = [(bone.name, bone.parent and bone.parent.name, bone.use_connect) for bone in obj.data.bones]
    wanted = random.normal(size=(len(rig.graph.positions), 3)) * 3
    move_armature_joints(obj, rig, wanted)
    assert obj.mode == ("EDIT" if in_edit_mode else "OBJECT")
    if in_edit_mode:
        bpy.ops.object.mode_set(mode="OBJECT")
    assert [(bone.name, bone.parent and bone.parent.name, bone.use_connect) for bone in obj.data.bones] == before
    found = world_ends(obj)
    for own, place in zip(rig.ends, wanted, strict=True):
        for end in own:
            np.testing.assert_allclose(found[end], place, atol=1e-4)


def test_moving_no_joints_changes_nothing():
    obj = armature(CREATURE)
    bpy.ops.object.mode_set(mode="EDIT")
    for place, bone in enumerate(obj.data.edit_bones):
        bone.roll = 0.3 * place
    bpy.ops.object.mode_set(mode="OBJECT")
    before = {bone.name: np.array(bone.matrix_local) for bone in obj.data.bones}
    moved(obj, {})
    for name, matrix in before.items():
        np.testing.assert_allclose(np.array(obj.data.bones[name].matrix_local), matrix, atol=1e-5)


def test_the_roll_turns_with_the_bone():
    """A quarter turn about Z leaves an axis that points along Z, and takes one in the plane along."""
    for roll in (0.0, math.pi / 2, 0.7):
        obj = chain(1, name=f"Rig{roll}")
        bpy.ops.object.mode_set(mode="EDIT")
        obj.data.edit_bones["A"].roll = roll
        axis = obj.data.edit_bones["A"].z_axis.copy()
        bpy.ops.object.mode_set(mode="OBJECT")
        moved(obj, {"A.tail": (0, 2, 0)})
        expected = Matrix.Rotation(math.pi / 2, 3, "Z") @ axis
        np.testing.assert_allclose(obj.data.bones["A"].matrix_local.to_3x3().col[2], expected, atol=1e-5)


def test_mirrored_editing_does_not_meddle():
    obj = armature([("A.L", (1, 0, 0), (2, 0, 0), None, False), ("A.R", (-1, 0, 0), (-2, 0, 0), None, False)])
    obj.data.use_mirror_x = True
    moved(obj, {"A.L.tail": (2, 1, 0), "A.R.tail": (-3, 0, 5)})
    found = world_ends(obj)
    np.testing.assert_allclose(found["A.L.tail"], (2, 1, 0), atol=1e-6)
    np.testing.assert_allclose(found["A.R.tail"], (-3, 0, 5), atol=1e-6)
    assert obj.data.use_mirror_x


def test_handles_follow_adjacent_joints():
    obj = armature(
        [
            ("Thigh", (0, 0, 4), (0, 0, 2), None, False),
            ("Shin", (0, 0, 2), (0, 0, 0), "Thigh", True),
            ("Target", (0, 0, 0), (0, 1, 0), None, False),
            ("Pole", (0, -2, 2), (0, -3, 2), None, False),
            ("Tip", (0, -3, 2), (0, -3, 3), "Pole", True),
        ]
    )
    for name in ("Target", "Pole", "Tip"):
        obj.data.bones[name].use_deform = False
    moved(obj, {"Shin.tail": (5, 0, 0), "Thigh.tail": (0, 0.5, 2)})
    found = world_ends(obj)
    np.testing.assert_allclose(found["Target.head"], (5, 0, 0), atol=1e-6)
    np.testing.assert_allclose(found["Target.tail"], (5, 1, 0), atol=1e-6)
    np.testing.assert_allclose(found["Pole.head"], (0, -1.5, 2), atol=1e-6)
    np.testing.assert_allclose(found["Tip.head"], (0, -2.5, 2), atol=1e-6)
    np.testing.assert_allclose(found["Tip.tail"], (0, -2.5, 3), atol=1e-6)


def test_no_bone_vanishes():
    """Blender removes bones without length."""
    obj = chain(3)
    rig = armature_graph(obj)
    positions = rig.graph.positions.copy()
    positions[2] = positions[1]
    assert move_armature_joints(obj, rig, positions) == ["B"]
    assert [bone.name for bone in obj.data.bones] == ["A", "B", "C"]
    assert 1e-5 < obj.data.bones["B"].length < 1e-2
    assert obj.data.bones["C"].use_connect


def test_other_bones_than_before_are_refused():
    obj = chain(3)
    rig = armature_graph(obj)
    obj.data.bones["A"].name = "Spine"
    with pytest.raises(InputError, match="The bones of Rig have changed since the start"):
        move_armature_joints(obj, rig, rig.graph.positions)
    assert obj.mode == "OBJECT"


def test_modes_and_the_active_object_stay():
    obj = chain(2)
    body = tube()
    assert bpy.context.object == body
    moved(obj, {"B.tail": (3, 1, 0)})
    assert (bpy.context.object, obj.mode) == (body, "OBJECT")
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="POSE")
    moved(obj, {"B.tail": (3, 2, 0)})
    assert (bpy.context.object, obj.mode) == (obj, "POSE")


def test_constraints_and_weights_are_left_alone():
    obj, body = chain(3), tube()
    constraint = obj.pose.bones["C"].constraints.new("IK")
    constraint.target, constraint.chain_count, constraint.influence = body, 2, 0.4
    body.vertex_groups.new(name="A").add([0, 1], 0.25, "REPLACE")
    body.modifiers.new("Armature", "ARMATURE").object = obj
    moved(obj, {"A.tail": (1, 0.5, 0)})
    (kept,) = obj.pose.bones["C"].constraints
    assert (kept.type, kept.target, kept.chain_count) == ("IK", body, 2)
    assert body.vertex_groups["A"].weight(1) == pytest.approx(0.25)


# Pins.


def pin(obj, *names):
    rig = rig_graph(obj)
    pin_joints(obj, rig, [rig.joint(name) for name in names])


def test_a_pin_is_of_a_joint_whichever_end_it_is_named_after():
    obj = armature(CREATURE)
    pin(obj, "Leg.L.head", "Foot.L.tail")
    assert pinned_ends(obj) == ["Spine.head", "Foot.L.tail"]
    rig = rig_graph(obj)
    assert [rig.graph.names[joint] for joint in np.flatnonzero(rig.graph.pinned)] == ["Spine.head", "Foot.L.tail"]
    unpin_joints(obj, rig, [rig.joint("Leg.L.head")])
    assert pinned_ends(obj) == ["Foot.L.tail"]
    clear_pins(obj)
    assert pinned_ends(obj) == []


def test_pins_survive_renaming_modes_and_saving(tmp_path):
    obj = chain(2)
    pin(obj, "B.tail")
    obj.data.bones["B"].name = "Tip"
    assert pinned_ends(obj) == ["Tip.tail"]
    bpy.ops.object.mode_set(mode="EDIT")
    assert pinned_ends(obj) == ["Tip.tail"]
    pin(obj, "A.head")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert pinned_ends(obj) == ["A.head", "Tip.tail"]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "pins.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "pins.blend"))
    assert pinned_ends(bpy.data.objects["Rig"]) == ["A.head", "Tip.tail"]


def test_selected_joints():
    obj = chain(3)
    bpy.ops.object.mode_set(mode="EDIT")
    select_joints(obj, "B.head", "C.tail")
    rig = rig_graph(obj)
    assert {rig.graph.names[joint] for joint in np.flatnonzero(rig.selected)} == {"A.tail", "C.tail"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not rig_graph(obj).selected.any()


def test_lengths_are_those_before_joints_were_moved():
    """The last bone is stretched to three times its length and pinned; its original length still counts."""
    obj = chain(3)
    obj.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    bpy.ops.object.mode_set(mode="EDIT")
    obj.data.edit_bones["C"].tail = (5, 0, 0)
    np.testing.assert_allclose(rig_graph(obj).graph.lengths, [2, 2, 6], rtol=1e-5)
    pin(obj, "C.tail")
    rig = rig_graph(obj)
    np.testing.assert_allclose(rig.graph.lengths, [2, 2, 2], rtol=1e-5)
    bpy.ops.object.mode_set(mode="OBJECT")
    pin(obj, "A.head")
    moved(obj, {"A.tail": (5, 0, 0)})
    np.testing.assert_allclose(rig_graph(obj).graph.lengths, [2, 2, 2], rtol=1e-5)
    clear_pins(obj)
    np.testing.assert_allclose(rig_graph(obj).graph.lengths, [5, 1, 6], rtol=1e-4)


def test_the_shape_before_is_kept_too():
    obj = chain(2)
    obj.location = (0, 0, 3)
    bpy.context.view_layer.update()
    pin(obj, "B.tail")
    moved(obj, {"A.tail": (1, 5, 3), "B.tail": (0, 0, 0)})
    rig = rig_graph(obj)
    np.testing.assert_allclose(rig.graph.rest, [(0, 0, 3), (1, 0, 3), (2, 0, 3)], atol=1e-5)
    np.testing.assert_allclose(rig.graph.positions, [(0, 0, 3), (1, 5, 3), (0, 0, 0)], atol=1e-5)
    pin(obj, "A.head")
    np.testing.assert_allclose(rig_graph(obj).graph.rest, rig.graph.rest, atol=1e-5)


def test_new_bones_invalidate_stored_lengths():
    obj = chain(2)
    pin(obj, "A.head")
    moved(obj, {"B.tail": (4, 0, 0)})
    assert rig_graph(obj).graph.lengths == pytest.approx([1, 1])
    bpy.ops.object.mode_set(mode="EDIT")
    bone = obj.data.edit_bones.new("New")
    bone.head, bone.tail, bone.parent = (4, 0, 0), (4, 4, 0), obj.data.edit_bones["B"]
    assert rig_graph(obj).graph.lengths == pytest.approx([1, 3, 4])
    note_rest(obj)
    bone.tail = (4, 9, 0)
    assert rig_graph(obj).graph.lengths == pytest.approx([1, 3, 4])


def test_pins_from_a_command_line():
    rig = rig_graph(chain(2))
    pinned = rig.pinned_at(["A.head"], {"B.tail": np.array((9.0, 0, 0))})
    assert pinned.graph.pinned.tolist() == [True, False, True]
    np.testing.assert_allclose(pinned.graph.positions[2], (9, 0, 0))
    np.testing.assert_allclose(pinned.graph.lengths, (1, 1), atol=1e-6)
    assert not rig.graph.pinned.any()
    assert replace(pinned.graph, positions=rig.graph.positions).lengths == pytest.approx([1, 1])
    part = pinned.graph.part(np.array([False, True, True]))
    assert (part.lengths.tolist(), part.names) == (pytest.approx([1]), ("A.tail", "B.tail"))


def test_bones_have_pins_without_the_add_on_for_a_while(monkeypatch):
    with with_pins():
        assert hasattr(bpy.types.Bone, "convwass_pinned")
    assert hasattr(bpy.types.EditBone, "convwass_rest")
    from convwass_addon.bridge.armatures import pins

    pins.unregister_pins()
    try:
        with with_pins():
            obj = chain(1)
            pin(obj, "A.tail")
        assert not hasattr(bpy.types.Bone, "convwass_pinned")
    finally:
        pins.register_pins()
    assert pinned_ends(obj) == ["A.tail"]


# What stands in the way.


def test_the_body_is_read_without_the_pose(depsgraph):
    body, obj = tube(), chain(2, length=2)
    for name, sign in (("A", -1), ("B", 1)):
        own = [vertex.index for vertex in body.data.vertices if sign * (vertex.co.x - 2) >= 0]
        body.vertex_groups.new(name=name).add(own, 1.0, "REPLACE")
    body.modifiers.new("Armature", "ARMATURE").object = obj
    plain = resting_body(body, obj, depsgraph).vertices
    assert not is_posed(obj)
    obj.pose.bones["B"].rotation_mode = "XYZ"
    obj.pose.bones["B"].rotation_euler = (0, 0, 1.0)
    bpy.context.view_layer.update()
    assert is_posed(obj)
    np.testing.assert_allclose(resting_body(body, obj, depsgraph).vertices, plain, atol=1e-6)
    assert obj.data.pose_position == "POSE"
    obj.data.pose_position = "REST"
    assert not is_posed(obj)


def test_hidden_armatures_are_refused():
    obj = chain(2)
    require_movable(obj)
    obj.hide_set(True)
    with pytest.raises(InputError, match="Rig or its collection is hidden; show it"):
        require_movable(obj)
    obj.hide_set(False)
    bpy.context.collection.objects.unlink(obj)
    with pytest.raises(InputError, match="Rig or its collection is hidden"):
        require_movable(obj)


@pytest.fixture
def library(tmp_path):
    chain(2)
    return linked_to_new_file("Rig", tmp_path)


def test_linked_armatures_are_refused(library):
    with pytest.raises(InputError, match="Rig is linked from another file and cannot be changed here"):
        require_movable(library)


def test_overrides_are_refused(library):
    obj = library.override_create(remap_local_usages=True)
    with pytest.raises(InputError, match="make it local with its data"):
        require_movable(obj)
    data = obj.data.override_create(remap_local_usages=True)
    obj.data = data
    with pytest.raises(InputError, match="Rig is a library override, whose joints cannot be moved"):
        require_movable(obj)


def test_the_matrix_of_a_rig_is_that_of_when_it_was_read():
    obj = chain(1)
    rig = armature_graph(obj)
    obj.location = (10, 0, 0)
    bpy.context.view_layer.update()
    move_armature_joints(obj, rig, rig.graph.positions + np.array((0, 0, 1)))
    np.testing.assert_allclose(obj.data.bones["A"].head_local, Vector((0, 0, 1)), atol=1e-6)
