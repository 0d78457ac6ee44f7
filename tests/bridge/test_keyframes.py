# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyed visibility, as Blender evaluates it, and copies of animation."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.bridge import keyframes
from convwass_addon.bridge.keyframes import FrameRange, curves_of, is_tweaked, key_visibility, take_animation
from convwass_addon.bridge.visibility import shown_at


def visible_frames(obj, frames):
    shown = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        assert obj.hide_render == obj.hide_viewport
        if not obj.hide_render:
            shown.append(frame)
    return shown


@pytest.mark.parametrize(
    ("ranges", "expected"),
    [
        ([], []),
        ([FrameRange(None, None)], range(10)),
        ([FrameRange(4, 4)], [4]),
        ([FrameRange(4, 6)], [4, 5, 6]),
        ([FrameRange(None, 3)], [0, 1, 2, 3]),
        ([FrameRange(8, None)], [8, 9]),
        ([FrameRange(None, 1), FrameRange(3, 3), FrameRange(5, 6), FrameRange(9, None)], [0, 1, 3, 5, 6, 9]),
    ],
)
def test_shown_exactly_there(make_object, ranges, expected):
    obj = make_object("A")
    key_visibility(obj, bpy.data.actions.new("Visibility"), ranges)
    assert visible_frames(obj, range(10)) == list(expected)


def test_holds_between_frames(make_object, bare_scene):
    obj = make_object("A")
    key_visibility(obj, bpy.data.actions.new("Visibility"), [FrameRange(4, 4)])
    hidden = {}
    for subframe in (0.0, 0.25, 0.99):
        for frame in (3, 4, 5):
            bare_scene.frame_set(frame, subframe=subframe)
            hidden[frame, subframe] = obj.hide_render
    assert {key for key, value in hidden.items() if not value} == {(4, 0.0), (4, 0.25), (4, 0.99)}


def test_keying_again_replaces(make_object):
    obj, action = make_object("A"), bpy.data.actions.new("Visibility")
    key_visibility(obj, action, [FrameRange(2, 2)])
    key_visibility(obj, action, [FrameRange(7, None)])
    assert visible_frames(obj, range(10)) == [7, 8, 9]
    assert len(action.slots) == 1


def test_one_action_serves_many_objects(make_object):
    objects, action = [make_object(name) for name in "ABC"], bpy.data.actions.new("Visibility")
    for number, obj in enumerate(objects):
        key_visibility(obj, action, [FrameRange(number, number)])
    assert [visible_frames(obj, range(4)) for obj in objects] == [[0], [1], [2]]
    assert len(action.slots) == 3


def test_the_keys_of_an_object_are_looked_up_once_for_all_times(make_object, monkeypatch):
    objects, action = [make_object(name) for name in "ABC"], bpy.data.actions.new("Visibility")
    for number, obj in enumerate(objects[:2]):
        key_visibility(obj, action, [FrameRange(number, number + 1)])
    objects[2].hide_render = True
    looked_up = []
    monkeypatch.setattr(keyframes, "curves_of", lambda obj, path=None: looked_up.append(obj) or curves_of(obj, path))
    first, second, _ = objects
    assert shown_at(objects, range(4)) == [(first,), (first, second), (second,), ()]
    assert looked_up == objects
    assert shown_at([], range(2)) == [(), ()]


def test_some_animation_is_taken_without_the_rest(make_object, bare_scene):
    source, other, block = map(make_object, "ABC")
    for obj in (source, other):
        obj["own"] = [0.0, 0.0]
    for frame in (1, 5):
        source["own"], source.location.x = [frame, 2.0 * frame], frame
        for path in ('["own"]', "location"):
            source.keyframe_insert(path, frame=frame, group="Group")
    data = other.animation_data_create()
    data.action, data.action_slot = source.animation_data.action, source.animation_data.action.slots.new("OBJECT", "2")
    other.keyframe_insert("scale", frame=1)
    for path in ("rotation_euler", "delta_location"):
        source.driver_add(path, 2).driver.expression = "7"
    before = len(curves_of(source))
    block["own"] = [0.0, 0.0]
    take_animation(block, source, ['["own"]', "delta_"])
    bare_scene.frame_set(5)
    assert list(block["own"]) == [5.0, 10.0] and list(block.location) == [0.0, 0.0, 0.0]
    assert (block.rotation_euler.z, block.delta_location.z) == (0.0, 7.0)
    action = block.animation_data.action
    assert action != source.animation_data.action and len(action.slots) == 1
    assert len(curves_of(block)) == 2 and len(curves_of(source)) == before


@pytest.mark.parametrize("kind", ["none", "other", "tweaked"])
def test_nothing_is_taken_where_nothing_fits(make_object, kind):
    source, block = map(make_object, "AB")
    if kind != "none":
        source.keyframe_insert("location" if kind == "other" else "scale", frame=1)
    if kind == "tweaked":
        data = source.animation_data
        strip = data.nla_tracks.new().strips.new("Strip", 5, data.action)
        strip.action_slot = data.action_slot
        data.action = None
        data.nla_tracks[0].select = strip.select = True
        data.nla_tracks.active = data.nla_tracks[0]
        data.use_tweak_mode = True
        assert is_tweaked(source)
    take_animation(block, source, ["scale"])
    assert block.animation_data is None


def test_few_keys(make_object):
    obj, action = make_object("A"), bpy.data.actions.new("Visibility")
    key_visibility(obj, action, [FrameRange(10, 500)])
    curves = action.layers[0].strips[0].channelbag(obj.animation_data.action_slot).fcurves
    assert [len(curve.keyframe_points) for curve in curves] == [3, 3]
