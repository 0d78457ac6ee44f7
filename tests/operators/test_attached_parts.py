# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that follow a mesh with shape keys."""

from __future__ import annotations

import threading

import bpy
import numpy as np
import pytest

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.bridge.one_mesh.records import RECORD_KEY
from convwass_addon.bridge.one_mesh.replaced_keys import delete_keys, replace_keys
from convwass_addon.bridge.one_mesh.shape_keys import drive_key, object_with_keys
from convwass_addon.geometry.deformation.attachment import Attachment
from convwass_addon.operators.attached_parts import CONVWASS_OT_attach_parts
from tests.operators.running import ESCAPE, Pressed, started, until, wait_for_the_thread, window_context
from tests.scene import select_only, world

pytestmark = pytest.mark.usefixtures("empty_scene")

SHIFT = np.array([0.0, 0.0, 2.0])


@pytest.fixture
def body():
    """A ball that grows to twice its size with its first key, and also rises with its second."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    source = bpy.context.object
    rest = world(source)
    path = KeyPath("Up", (0.5, 1.0), np.stack([2.0 * rest, 2.0 * rest + SHIFT]), 0.9, 0.0, 0.0, 0.0, 0)
    obj = object_with_keys(source, source.data.copy(), [path], bpy.context.scene)
    bpy.data.objects.remove(source)
    return obj


@pytest.fixture
def hat():
    """A turned and scaled cube, above the ball, that shares its mesh and has a key of its own."""
    bpy.ops.mesh.primitive_cube_add(size=0.3, location=(0.2, 0.1, 1.2), rotation=(0.3, 0.2, 0.1), scale=(1, 2, 0.5))
    hat = bpy.context.object
    hat.name = "Hat"
    hat.shape_key_add(name="Basis")
    hat.shape_key_add(name="Dent")
    twin = hat.copy()
    twin.name = "Twin"
    bpy.context.scene.collection.objects.link(twin)
    return hat


def select(*objects):
    select_only(*objects)
    bpy.context.view_layer.objects.active = objects[-1]


@pytest.mark.parametrize("rigid", [False, True])
def test_a_part_follows_the_slider_of_the_body(body, hat, rigid, capfd):
    before = world(hat)
    select(hat, body)
    for _ in range(2):
        assert bpy.ops.convwass.attach_parts(rigid=rigid) == {"FINISHED"}
    assert "Hat: attached to Icosphere Morph\n" in capfd.readouterr().out
    assert [key.name for key in hat.data.shape_keys.key_blocks] == ["Basis", "Dent", "Up 1", "Up 2"]
    assert hat.data != bpy.data.objects["Twin"].data
    for value, expected in (
        (0.0, before),
        (0.25, 1.5 * before),
        (0.5, 2.0 * before),
        (0.75, 2.0 * before + SHIFT / 2),
        (1.0, 2.0 * before + SHIFT),
    ):
        body["Up"] = value
        body.update_tag()
        np.testing.assert_allclose(world(hat), expected, atol=1e-5)


def test_parts_that_cannot_follow_are_refused(body, hat):
    bpy.ops.object.empty_add()
    select(bpy.context.object, hat, body)
    with pytest.raises(RuntimeError, match="is not a mesh"):
        bpy.ops.convwass.attach_parts()
    hat.data.shape_keys.use_relative = False
    select(hat, body)
    with pytest.raises(RuntimeError, match="Hat has absolute shape keys"):
        bpy.ops.convwass.attach_parts()
    assert len(hat.data.shape_keys.key_blocks) == 2
    select(body)
    assert not bpy.ops.convwass.attach_parts.poll()


def test_a_part_with_coordinates_that_are_not_numbers_is_refused_before_others_are_changed(body, hat):
    bpy.ops.mesh.primitive_cube_add(location=(2.0, 0.0, 0.0))
    broken = bpy.context.object
    broken.name = "Broken"
    broken.data.vertices[3].co.y = np.nan
    select(hat, broken, body)
    with pytest.raises(RuntimeError, match="Broken: 1 of 8 vertices"):
        bpy.ops.convwass.attach_parts()
    assert broken.data.shape_keys is None
    assert len(hat.data.shape_keys.key_blocks) == 2


def test_parts_that_follow_again_lose_keys_that_the_body_no_longer_has(body, hat):
    before = world(hat)
    select(hat, body)
    bpy.ops.convwass.attach_parts()
    rest = world(body)
    source = bpy.data.objects.new("Source", body.data.copy())
    source.shape_key_clear()
    new = object_with_keys(
        source, source.data.copy(), [KeyPath("Up", (1.0,), 3.0 * rest[None], 0.9, 0.0, 0.0, 0.0, 0)], bpy.context.scene
    )
    replace_keys(body, [new])
    bpy.ops.convwass.attach_parts()
    assert [key.name for key in hat.data.shape_keys.key_blocks] == ["Basis", "Dent", "Up"]
    body["Up"] = 1.0
    body.update_tag()
    np.testing.assert_allclose(world(hat), 3.0 * before, atol=1e-5)


def test_keys_of_the_user_stay_although_the_slider_drives_them(body, hat):
    """Also one that has the name of a key of the body."""
    for name in ("Dent", "Up 1"):
        key = hat.data.shape_keys.key_blocks.get(name) or hat.shape_key_add(name=name, from_mix=False)
        drive_key(body, key, "Up", "v * v")
        key.data[0].co.x += 1.0
    before = [point.co[:] for name in ("Dent", "Up 1") for point in hat.data.shape_keys.key_blocks[name].data]
    select(hat, body)
    for _ in range(2):
        bpy.ops.convwass.attach_parts()
    keys = hat.data.shape_keys.key_blocks
    assert sorted(key.name for key in keys) == ["Basis", "Dent", "Up 1", "Up 1.001", "Up 2"]
    assert [point.co[:] for name in ("Dent", "Up 1") for point in keys[name].data] == before


def test_a_mesh_that_keeps_its_form_has_nothing_to_follow(body, hat):
    """One of two meshes that replace each other."""
    still = object_with_keys(body, body.data.copy(), [], bpy.context.scene)
    still["convwass_shape_keys"] = "[]"
    select(hat, still)
    with pytest.raises(RuntimeError, match="keeps its form, so there are no keys to follow"):
        bpy.ops.convwass.attach_parts()
    assert len(hat.data.shape_keys.key_blocks) == 2


@pytest.fixture
def mine(body):
    """A copy of the body in its place, with a key of its own that has a copy of the driver of the body's first key."""
    obj = bpy.data.objects.new("Mine", body.data.copy())
    bpy.context.scene.collection.objects.link(obj)
    obj.shape_key_clear()
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Sculpted", from_mix=False)
    drive_key(body, key, "Up", body.data.shape_keys.animation_data.drivers[0].driver.expression)
    return obj


def test_deleting_a_body_removes_keys_of_attached_parts_only(body, hat, mine):
    """Also with another key that has a pasted driver on the attached part, under the name of a key of the body."""
    expression = body.data.shape_keys.animation_data.drivers[0].driver.expression
    drive_key(body, hat.shape_key_add(name="Sculpted", from_mix=False), "Up", expression)
    select(hat, body)
    bpy.ops.convwass.attach_parts()
    drive_key(body, hat.shape_key_add(name="Up 1", from_mix=False), "Up", expression)
    delete_keys(body)
    assert [key.name for key in mine.data.shape_keys.key_blocks] == ["Basis", "Sculpted"]
    assert [key.name for key in hat.data.shape_keys.key_blocks] == ["Basis", "Dent", "Sculpted", "Up 1.001"]


def test_parts_that_an_earlier_version_attached_are_recognized_by_the_names_of_the_body(body, hat, mine):
    select(hat, body)
    bpy.ops.convwass.attach_parts()
    del hat.data.shape_keys["convwass_attached_keys"]
    delete_keys(body)
    assert [key.name for key in hat.data.shape_keys.key_blocks] == ["Basis", "Dent"]
    assert [key.name for key in mine.data.shape_keys.key_blocks] == ["Basis", "Sculpted"]


def test_damaged_names_of_keys_are_those_of_the_body(body, hat):
    select(hat, body)
    bpy.ops.convwass.attach_parts()
    hat.data.shape_keys["convwass_attached_keys"] = "[" * 100_000
    delete_keys(body)
    assert [key.name for key in hat.data.shape_keys.key_blocks] == ["Basis", "Dent"]


def test_a_part_keeps_what_an_earlier_version_attached_to_another_body(body, hat):
    other = object_with_keys(
        bpy.data.objects.new("Other", body.data.copy()),
        bpy.data.meshes.new_from_object(body),
        [KeyPath("Down", (1.0,), world(body)[None], 0.9, 0.0, 0.0, 0.0, 0)],
        bpy.context.scene,
    )
    for each in (other, body):
        select(hat, each)
        bpy.ops.convwass.attach_parts()
        if each == other:
            del hat.data.shape_keys["convwass_attached_keys"]
    assert [key.name for key in hat.data.shape_keys.key_blocks] == ["Basis", "Dent", "Down", "Up 1", "Up 2"]
    delete_keys(other)
    delete_keys(body)
    assert [key.name for key in hat.data.shape_keys.key_blocks] == ["Basis", "Dent"]


def attaching(body, hat):
    """Start to attach the hat in the background."""
    select(hat, body)
    context = window_context()
    context.selected_objects = [hat, body]
    pressed = Pressed(CONVWASS_OT_attach_parts)
    assert started(pressed, context)
    return pressed, context


def key_names(obj):
    return [key.name for key in obj.data.shape_keys.key_blocks]


def test_parts_are_attached_in_the_background(body, hat):
    pressed, context = attaching(body, hat)
    assert key_names(hat) == ["Basis", "Dent"]
    assert until(pressed, context) == {"FINISHED"}
    assert key_names(hat) == ["Basis", "Dent", "Up 1", "Up 2"]
    assert pressed.reports[0][1].startswith("Hat: attached to Icosphere Morph")


def test_attaching_can_be_stopped(body, hat, monkeypatch):
    attaching_now = threading.Event()

    def endless(self, vertices):
        attaching_now.set()
        stopped.wait(10.0)
        return vertices

    stopped = threading.Event()
    monkeypatch.setattr(Attachment, "followed", endless)
    pressed, context = attaching(body, hat)
    assert attaching_now.wait(10.0)
    stopped.set()
    until(pressed, context, event=ESCAPE)
    assert key_names(hat) == ["Basis", "Dent"]
    assert hat.data == bpy.data.objects["Twin"].data
    assert pressed.reports == [("INFO", "Stopped; nothing was changed")]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda body, hat: bpy.data.objects.remove(body), "Icosphere Morph was deleted"),
        (lambda body, hat: bpy.data.objects.remove(hat), "Hat was deleted"),
        (lambda body, hat: setattr(hat, "data", body.data.copy()), "The vertices of Hat have changed"),
        (lambda body, hat: body.__setitem__(RECORD_KEY, '[{"name": "Down", "times": [1.0]}]'), "The keys of Icosphere"),
    ],
)
def test_parts_that_change_meanwhile_are_refused(body, hat, change, message):
    pressed, context = attaching(body, hat)
    wait_for_the_thread()
    change(body, hat)
    assert until(pressed, context) == {"CANCELLED"}
    assert pressed.reports[0][0] == "ERROR"
    assert pressed.reports[0][1].startswith(message)
    assert key_names(bpy.data.objects["Twin"]) == ["Basis", "Dent"]
