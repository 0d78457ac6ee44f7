# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes for players and pads that mix blends, whose frames are sampled in the background as in a window."""

from __future__ import annotations

import threading

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.morphs.fields import field_sampling
from convwass_addon.bridge.morphs.fields.stored_fields import FIELD
from convwass_addon.bridge.morphs.players.player_inputs import is_player
from convwass_addon.bridge.morphs.stand_ins import stand_ins
from convwass_addon.bridge.morphs.stored import frame_objects
from tests.operators.morphs import PressedBake, baked_morph, census, two_balls, two_shapes
from tests.operators.running import ESCAPE, is_computing, show_other_scene, started, until, window_context

pytestmark = pytest.mark.usefixtures("empty_scene")

_MIXED = {"motion": "TRANSPORT", "resolution": 24, "output": "PLAYER", "between": "INTERPOLATED"}


@pytest.fixture
def context():
    return window_context()


def choose_settings(**others):
    """Choose the settings of a bake in the current scene, from which a pressed one takes them."""
    for name, value in {**_MIXED, "frames": 3, **others}.items():
        setattr(bpy.context.scene.convwass_morph, name, value)


@pytest.fixture
def press(context):
    """Give a function that starts a bake of the selected shapes, which may replace a morph."""

    def start(replaces=""):
        choose_settings()
        context.selected_objects = bpy.context.selected_objects
        pressed = PressedBake()
        pressed.replaces = replaces
        assert started(pressed, context)
        return pressed

    return start


def stopped(pressed, context, monkeypatch):
    """Press Escape while the frames are sampled, which waits for that; return how the operator ends."""
    began, go_on, sample = threading.Event(), threading.Event(), field_sampling.signed_distances

    def waiting(*args):
        began.set()
        go_on.wait(5.0)
        go_on.set()
        return sample(*args)

    monkeypatch.setattr(field_sampling, "signed_distances", waiting)
    assert until(pressed, context, began.is_set) == {"PASS_THROUGH"}
    assert is_computing()
    threading.Timer(0.05, go_on.set).start()
    result = pressed.modal(context, ESCAPE)
    return until(pressed, context) if result == {"PASS_THROUGH"} else result


def fields_of(morph):
    """Return the signed distances that a morph has stored, one row per blend."""
    (samples,) = [
        mesh for mesh in bpy.data.meshes if mesh.name.startswith(morph.name) and FIELD.format(0) in mesh.attributes
    ]
    count = len(frame_objects(morph))
    return np.array(
        [element_values(samples.attributes[FIELD.format(n)].data, "value", kind=np.int8) for n in range(count)]
    )


def test_stopping_while_frames_are_sampled_keeps_them(press, context, monkeypatch):
    two_shapes()
    pressed = press()
    assert stopped(pressed, context, monkeypatch) == {"FINISHED"}
    assert pressed.reports == ["Stopped; 4 finished frames are kept"]
    assert len(frame_objects(baked_morph())) == 4
    assert not stand_ins(baked_morph())
    assert not bpy.data.node_groups


def test_stopping_while_new_frames_are_sampled_leaves_the_player(press, context, monkeypatch):
    shapes = two_shapes()
    assert bpy.ops.convwass.bake_morph(frames=2, **_MIXED) == {"FINISHED"}
    fields = fields_of(baked_morph())
    for shape in shapes:
        shape.hide_set(False)
        shape.select_set(True)
    before = census()
    pressed = press(replaces=baked_morph().name)
    assert stopped(pressed, context, monkeypatch) == {"CANCELLED"}
    assert pressed.reports == ["Stopped; the morph was not changed"]
    assert census() == before
    np.testing.assert_array_equal(fields_of(baked_morph()), fields)


@pytest.mark.parametrize("goes_away", [False, True])
def test_frames_sampled_during_a_bake_are_those_in_the_scene(press, context, goes_away):
    for obj in two_shapes():
        obj.keyframe_insert("location", frame=1)
        obj.location.z += 3.0
        obj.keyframe_insert("location", frame=9)
    bpy.context.scene.convwass_morph.follow = "FOLLOW"
    scene, pressed = bpy.context.scene, press()
    if goes_away:
        show_other_scene(context)
        choose_settings()
    assert until(pressed, context) == {"FINISHED"}
    bpy.context.window.scene = scene
    morph = baked_morph()
    (player,) = stand_ins(morph)
    assert is_player(player)
    expected = field_sampling.sampled_fields(morph, frame_objects(morph)).steps
    np.testing.assert_array_equal(fields_of(morph), expected)


def test_a_pad_is_sampled_during_its_bake():
    two_balls()
    for x in (6.0, 9.0):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(x, 0, 0))
    # Names of up to 63 characters are kept in all versions of Blender.
    for number, obj in enumerate(bpy.context.scene.objects):
        obj.name = f"Ball {number}"
    bpy.ops.object.select_all(action="SELECT")
    assert bpy.ops.convwass.bake_morph(layout="GRID", steps=2, **_MIXED) == {"FINISHED"}
    morph = baked_morph()
    for _ in range(2):
        expected = field_sampling.sampled_fields(morph, frame_objects(morph)).steps
        np.testing.assert_array_equal(fields_of(morph), expected)
        assert bpy.ops.convwass.rebake_morph(which="ALL") == {"FINISHED"}
