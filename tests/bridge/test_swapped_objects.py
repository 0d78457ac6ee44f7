# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two objects with shape keys, one of which replaces the other."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.applications.one_mesh.swapped_meshes import SwappedMeshes
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.one_mesh import swap_job
from convwass_addon.bridge.one_mesh.baked_keys import SWAP_KEY, shared_slider
from convwass_addon.bridge.one_mesh.moving_meshes import sampled_vertices
from convwass_addon.bridge.one_mesh.swapped_objects import with_swap
from convwass_addon.bridge.visibility import shown_objects
from convwass_addon.progress import Progress
from convwass_addon.sentence import Sentence

pytestmark = pytest.mark.usefixtures("empty_scene")

QUICK = {"output": "SHAPE_KEYS", "two_meshes": True, "frames": 10}


@pytest.fixture
def shapes():
    """A cube at (4, 0, 0) and a larger one at the origin."""
    bpy.ops.mesh.primitive_cube_add(location=(4.0, 0.0, 0.0))
    bpy.context.object.name = "Cup"
    bpy.ops.mesh.primitive_cube_add(size=4.0)
    bpy.context.object.name = "Ball"
    return bpy.data.objects["Cup"], bpy.data.objects["Ball"]


def known(time):
    """Meshes that are lifted by 1 until they are swapped."""

    def found(inputs, error, settings, control, how):
        names = inputs.names
        assert (names, error, settings.carry) == (["Cup", "Ball"], pytest.approx(0.005), True)
        yield Progress(0.5, Sentence("Half"))
        lifted = [(shape.vertices + np.array([0.0, 0.0, 1.0]))[None] for shape in inputs.shapes]
        first = KeyPath(names[1], (time,), lifted[0], None, 0.0, 0.0, 0.001, 0) if time > 0.0 else None
        last = KeyPath(names[0], (1.0 - time,), lifted[1], None, 0.0, 0.0, 0.001, 0) if time < 1.0 else None
        return SwappedMeshes(first, last, time, 0.001)

    return found


def bake(monkeypatch, time, **options):
    monkeypatch.setattr(swap_job, "swapped_meshes", known(time))
    assert bpy.ops.convwass.bake_morph(inputs="Cup,Ball", **{**QUICK, **options}) == {"FINISHED"}
    return bpy.data.objects["Cup Morph"], bpy.data.objects["Ball Morph"]


def shown_at(frame):
    """The names of the visible objects, and the mean position of the vertices of the first one."""
    bpy.context.scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    objects = [own.object for own in graph.object_instances if own.object.type == "MESH"]
    points = element_values(objects[0].data.vertices, "co", 3)
    middle = np.array(objects[0].matrix_world) @ np.append(points.mean(axis=0), 1.0)
    return [own.name for own in objects], middle[:3]


@pytest.mark.parametrize(
    ("time", "shown"),
    [
        (0.4, {1: ("Cup", 0.0), 3: ("Cup", 0.5), 6: ("Ball", 5 / 6), 8: ("Ball", 0.5), 11: ("Ball", 0.0)}),
        (1.0, {1: ("Cup", 0.0), 6: ("Cup", 0.5), 10: ("Cup", 0.9), 11: ("Ball", 0.0)}),
        (0.0, {1: ("Cup", 0.0), 2: ("Ball", 0.9), 6: ("Ball", 0.5), 11: ("Ball", 0.0)}),
    ],
)
def test_one_mesh_is_shown_at_a_time_and_both_move(shapes, monkeypatch, time, shown):
    first, second = bake(monkeypatch, time)
    assert first[SWAP_KEY]["at"] == pytest.approx(time) and all(shape.hide_get() for shape in shapes)
    assert shared_slider(first) == shared_slider(second) == (first, "Ball")
    bpy.context.scene.animation_data_create()
    for curve in first.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    for frame, (name, height) in shown.items():
        names, middle = shown_at(frame)
        assert names == [f"{name} Morph"]
        assert middle == pytest.approx([4.0 if name == "Cup" else 0.0, 0.0, height], abs=1e-4)
    drivers = [*first.animation_data.drivers, *second.animation_data.drivers]
    assert len(drivers) == (5 if time < 1.0 else 4) and all(curve.driver.is_simple_expression for curve in drivers)


def test_the_second_mesh_stands_where_the_first_one_becomes_it(shapes, monkeypatch):
    first, second = bake(monkeypatch, 0.4, alignment="CENTERED")
    bpy.context.view_layer.update()
    assert second.parent == first and shown_at(11)[1] == pytest.approx([4.0, 0.0, 0.0], abs=1e-4)
    first.location.x += 2.0
    assert shown_at(11)[1] == pytest.approx([6.0, 0.0, 0.0], abs=1e-4)
    bpy.data.objects.remove(first)
    assert shared_slider(second) is None and shared_slider(shapes[0]) is None


def test_keys_that_the_second_mesh_drives_itself_stay_as_they_are(shapes, monkeypatch):
    _, ball = shapes
    ball.shape_key_add(name="Basis")
    key = ball.shape_key_add(name="Raised")
    for point in key.data:
        point.co.z += 2.0
    ball["raised"] = 0.5
    driver = key.driver_add("value").driver
    variable = driver.variables.new()
    variable.targets[0].id, variable.targets[0].data_path = ball, '["raised"]'
    driver.expression = variable.name
    bpy.context.view_layer.update()
    _, second = bake(monkeypatch, 0.4)
    assert second["raised"] == 0.5 and shown_at(11)[1] == pytest.approx([0.0, 0.0, 1.0], abs=1e-4)


def test_a_hidden_mesh_is_exported_as_it_is_at_the_swap(shapes, monkeypatch):
    _, second = bake(monkeypatch, 0.4)
    with shown_objects([second], bpy.context.scene):
        heights = sampled_vertices(second, range(1, 12)).points[:, :, 2].mean(axis=1)
    assert heights[:4] == pytest.approx(1.0, abs=1e-6) and heights[-1] == pytest.approx(0.0, abs=1e-6)
    assert (np.diff(heights[4:]) < 0.0).all()
    assert shown_at(1)[0] == ["Cup Morph"] and shown_at(11)[0] == ["Ball Morph"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"inputs": "Cup,Ball,Third"}, "needs two shapes; there are 3"),
        ({"symmetric": True}, "Symmetric needs one mesh"),
        ({"alignment": "CENTERED"}, "Ball has an armature and cannot be moved"),
    ],
)
def test_what_two_meshes_cannot_do_is_refused(shapes, options, message):
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name = "Third"
    bpy.ops.object.armature_add()
    rig = bpy.context.object
    shapes[1].modifiers.new("Rig", "ARMATURE").object = rig
    before = len(bpy.data.meshes)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.convwass.bake_morph(**{"inputs": "Cup,Ball", **QUICK, **options})
    assert len(bpy.data.meshes) == before


def test_the_slider_of_a_mesh_that_keeps_its_form_has_a_name_of_its_own(shapes):
    cup, ball = shapes
    cup["Ball"] = "mine"
    assert with_swap(cup, ball, (None, None), "Ball", 0.5) == "Ball.001"
    assert (cup["Ball"], cup["Ball.001"]) == ("mine", 0.0)
