# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A pad after its morph was baked again."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.bridge.morphs.fields.mixed_frames import DETAIL
from convwass_addon.bridge.morphs.players.pad_inputs import HANDLE, PAD, pad_part
from convwass_addon.bridge.morphs.players.rebuilt_pad import rebuild_pad
from convwass_addon.bridge.morphs.stand_ins import SHOWS_KEY, frames_modifier, shown_morph
from convwass_addon.bridge.morphs.stored import frame_objects, stored_inputs
from convwass_addon.bridge.nodes.node_inputs import node_input
from convwass_addon.errors import InputError


def triangle_pad(between="NEAREST"):
    for x in (0.0, 3.0, 6.0):
        bpy.ops.mesh.primitive_cube_add(location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    options = {"layout": "TRIANGLE", "steps": 2, "output": "PLAYER", "between": between}
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", resolution=16, **options)
    return bpy.context.object


def test_a_handle_stays_at_its_blend_when_the_shapes_grow(empty_scene):
    handle = triangle_pad()
    morph, corner = shown_morph(handle), handle.parent.data.vertices[1].co.copy()
    for frame, place in ((1, (0.0, 0.0, 0.0)), (9, corner)):
        handle.location = place
        handle.keyframe_insert("location", frame=frame)
    handle.parent.location.x += 10.0
    for obj in stored_inputs(morph):
        obj.scale *= 2.0
    before = handle.parent.location.copy()
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    bpy.context.scene.frame_set(9)
    again = bpy.context.object
    assert again.location[:] == pytest.approx(again.parent.data.vertices[1].co)
    assert again.location[:] == pytest.approx(2.0 * corner, rel=0.1)
    # Twice as large, the pad is made farther away from the shapes.
    assert again.parent.location.x - 10.0 == pytest.approx(2.0 * (before.x - 10.0), rel=0.1)


def test_what_is_no_sheet_leaves_the_pad(empty_scene):
    handle = triangle_pad()
    morph = shown_morph(handle)
    bpy.data.objects.remove(frame_objects(morph)[-1])
    with pytest.raises(InputError, match="not a complete sheet"):
        rebuild_pad(morph)
    assert shown_morph(handle) == morph


def blend_of(handle):
    """Return the object that shows the blend; the corners have a parent."""
    there = [obj for obj in bpy.context.scene.objects if shown_morph(obj) == shown_morph(handle)]
    return next(obj for obj in there if frames_modifier(obj) and obj.parent is None)


def grow_shapes(handle):
    for obj in stored_inputs(shown_morph(handle)):
        obj.scale *= 2.0


def width(obj):
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).dimensions.x


@pytest.mark.parametrize("between", ["NEAREST", "INTERPOLATED"])
def test_what_was_added_to_a_pad_remains(empty_scene, between):
    handle = triangle_pad(between)
    blend, before = blend_of(handle), width(blend_of(handle))
    follower = bpy.data.objects.new("Follower", None)
    empty_scene.collection.objects.link(follower)
    for target, kind in ((blend, "COPY_LOCATION"), (handle, "COPY_ROTATION")):
        follower.constraints.new(kind).target = target
    blend.location.y, blend["mine"] = 7.0, "yes"
    blend.modifiers.new("Sharp", "EDGE_SPLIT").use_edge_angle = False
    blend.constraints.new("LIMIT_SCALE")
    blend.keyframe_insert("rotation_euler", frame=1)
    handle.driver_add("location", 0).driver.expression = "frame / 1000"
    if between == "INTERPOLATED":
        node_input(frames_modifier(blend), DETAIL).set(False)
    names = sorted(block.name for block in (*bpy.data.objects, *bpy.data.meshes, *bpy.data.node_groups))
    grow_shapes(handle)
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert bpy.context.object == handle and blend_of(handle) == blend
    assert [own.target for own in follower.constraints] == [blend, handle]
    assert (blend.location.y, blend["mine"]) == (7.0, "yes")
    assert [own.type for own in blend.modifiers] == ["NODES", "EDGE_SPLIT"]
    assert not blend.modifiers["Sharp"].use_edge_angle
    assert [own.type for own in blend.constraints] == ["LIMIT_SCALE"]
    assert blend.animation_data.action and [own.data_path for own in handle.animation_data.drivers] == ["location"]
    assert between == "NEAREST" or not node_input(frames_modifier(blend), DETAIL).get()
    assert width(blend) == pytest.approx(2.0 * before, rel=0.1)
    assert sorted(block.name for block in (*bpy.data.objects, *bpy.data.meshes, *bpy.data.node_groups)) == names


def test_the_strips_of_a_handle_and_duplicates_remain(empty_scene):
    handle = triangle_pad()
    corner = handle.parent.data.vertices[1].co.copy()
    for frame, place in ((1, (0.0, 0.0, 0.0)), (9, corner)):
        handle.location = place
        handle.keyframe_insert("location", frame=frame)
    strip = handle.animation_data.nla_tracks.new().strips.new("Strip", 11, handle.animation_data.action)
    handle.animation_data.action = None
    bpy.ops.object.select_all(action="DESELECT")
    blend_of(handle).select_set(True)
    bpy.ops.object.duplicate()
    (copy,), before = bpy.context.selected_objects, width(blend_of(handle))
    bpy.ops.object.select_all(action="DESELECT")
    handle.select_set(True)
    bpy.ops.object.duplicate()
    (second,) = bpy.context.selected_objects
    grow_shapes(handle)
    bpy.context.view_layer.objects.active = handle
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert [own.name for own in handle.animation_data.nla_tracks[0].strips] == [strip.name]
    bpy.context.scene.frame_set(19)
    # Both handles share the action of the strip.
    assert handle.location[:] == second.location[:] == pytest.approx(handle.parent.data.vertices[1].co)
    assert width(copy) == pytest.approx(2.0 * before, rel=0.2)


@pytest.mark.parametrize("between", ["NEAREST", "INTERPOLATED"])
def test_a_duplicated_pad_keeps_its_own_handle(empty_scene, between):
    handle = triangle_pad(between)
    before = [handle.parent, handle, blend_of(handle)]
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in before)
    bpy.ops.object.duplicate()
    pads = [before, sorted(bpy.context.selected_objects, key=lambda obj: (obj.type == "EMPTY", len(obj.modifiers)))]
    pads[1] = [pads[1][0], pads[1][2], pads[1][1]]
    bpy.context.view_layer.objects.active = handle
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    for pad, own, blend in pads:
        modifier = frames_modifier(blend)
        assert (pad_part(modifier, PAD), pad_part(modifier, HANDLE)) == (pad, own)


def test_a_blend_without_its_modifier_gives_way_to_a_new_one(empty_scene):
    handle = triangle_pad()
    morph, blend, before = shown_morph(handle), blend_of(handle), width(blend_of(handle))
    blend.modifiers.clear()
    grow_shapes(handle)
    bpy.context.view_layer.objects.active = handle
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert bpy.context.object == handle and len(frame_objects(morph)) == 3
    assert width(blend_of(handle)) == pytest.approx(2.0 * before, rel=0.1)


def test_deleted_parts_of_a_pad_are_made_again(empty_scene):
    handle = triangle_pad()
    home, morph, blend = handle.users_collection[0], shown_morph(handle), blend_of(handle)
    label = next(obj for obj in home.objects if obj.type == "FONT")
    count = len(home.objects)
    bpy.data.batch_remove([handle, label])
    assert bpy.ops.convwass.rebake_morph(morphs=morph.name) == {"FINISHED"}
    assert blend_of(bpy.context.object) == blend and bpy.context.object.type == "EMPTY"
    assert len(home.objects) == count
    assert [own for own in bpy.data.collections if own.get(SHOWS_KEY) == morph] == [home]
    assert len([obj for obj in bpy.data.objects if obj.type == "FONT"]) == 3
