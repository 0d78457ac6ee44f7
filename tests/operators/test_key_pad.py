# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A pad that drives the sliders of a mesh with shape keys."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Vector

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.one_mesh.moving_meshes import keyed_span
from convwass_addon.bridge.one_mesh.records import key_records
from convwass_addon.bridge.one_mesh.replaced_keys import delete_keys, replace_keys
from convwass_addon.bridge.one_mesh.shape_keys import animate_sliders, object_with_keys
from convwass_addon.errors import InputError
from tests.linked_objects import linked_object
from tests.scene import world

pytestmark = pytest.mark.usefixtures("empty_scene")

SHIFTS = np.eye(3)


def cube_with_targets(count, names="ABC"):
    """A cube that each target moves along another axis."""
    bpy.ops.mesh.primitive_cube_add()
    source = bpy.context.object
    rest = world(source)
    paths = [
        KeyPath(name, (1.0,), (rest + shift)[None], 0.9, 0.0, 0.0, 0.0, 0)
        for name, shift in zip(names[:count], SHIFTS[:count], strict=True)
    ]
    obj = object_with_keys(source, source.data.copy(), paths, bpy.context.scene)
    animate_sliders(obj, names[:count], 1, 10)
    bpy.context.view_layer.objects.active = obj
    return obj, rest


def corners(pad, count):
    return [np.array(vertex.co) for vertex in pad.data.vertices][: count + 1]


@pytest.mark.parametrize("count", [2, 3])
def test_the_handle_drives_the_sliders(count):
    obj, rest = cube_with_targets(count)
    assert bpy.ops.convwass.make_key_pad() == {"FINISHED"}
    handle = bpy.context.object
    places = corners(handle.parent, count)
    shifts = [np.zeros(3), *SHIFTS[:count]]
    for place, shift in zip(places, shifts, strict=True):
        handle.location = place
        np.testing.assert_allclose(world(obj), rest + shift, atol=1e-5)
    handle.location = np.mean(places, axis=0)
    np.testing.assert_allclose(world(obj), rest + np.mean(shifts, axis=0), atol=1e-5)
    with pytest.raises(InputError, match="key Key Handle, which drives it, first"):
        keyed_span(obj)
    for frame, place in ((4, places[0]), (9, places[1])):
        handle.location = place
        handle.keyframe_insert("location", frame=frame)
    assert keyed_span(obj) == range(4, 10)
    handle.animation_data_clear()
    # Beyond a corner it is clamped.
    handle.location = 3.0 * places[1] - 2.0 * places[2]
    found = world(obj)[0] - rest[0]
    assert found.min() >= -1e-5 and found.sum() <= 1.0 + 1e-5
    assert all(curve.driver.is_simple_expression for curve in obj.animation_data.drivers)


def test_drivers_that_a_pad_replaces_are_named(capfd):
    obj, _ = cube_with_targets(2)
    obj.animation_data_clear()
    curve = obj.driver_add('["B"]')
    curve.driver.variables.new().targets[0].id = bpy.data.objects.new("Control", None)
    bpy.ops.convwass.make_key_pad()
    assert "Warning: The pad replaces the drivers of B\n" in capfd.readouterr().out
    bpy.context.view_layer.objects.active = obj
    bpy.ops.convwass.make_key_pad()
    assert "replaces" not in capfd.readouterr().out


def test_another_number_of_targets_is_refused():
    cube_with_targets(1)
    with pytest.raises(RuntimeError, match="two or three"):
        bpy.ops.convwass.make_key_pad()


def test_the_pad_that_there_is_stays_when_the_button_is_pressed_again():
    obj, _ = cube_with_targets(2)
    bpy.ops.convwass.make_key_pad()
    handle = bpy.context.object
    handle.keyframe_insert("location", frame=4)
    before = bpy.data.objects[:]
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.convwass.make_key_pad() == {"FINISHED"}
    assert bpy.context.object == handle
    assert bpy.data.objects[:] == before
    assert keyed_span(obj) == range(4, 5)
    # As after a bake of other shapes.
    obj.driver_remove('["A"]')
    bpy.context.view_layer.objects.active = obj
    bpy.ops.convwass.make_key_pad()
    assert len(bpy.data.objects) == len(before)
    (variable, _) = obj.animation_data.drivers.find('["A"]').driver.variables
    assert variable.targets[0].id == bpy.context.object


@pytest.mark.parametrize("count", [2, 3])
def test_a_new_pad_takes_the_place_of_one_whose_handle_was_deleted(count, capfd):
    obj, _ = cube_with_targets(count)
    without = set(bpy.data.objects) - {obj}
    bpy.ops.convwass.make_key_pad()
    before = len(bpy.data.objects)
    bpy.data.objects.remove(bpy.context.object)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.convwass.make_key_pad()
    assert len(bpy.data.objects) == before
    handle = bpy.context.object
    handle.location = corners(handle.parent, count)[1]
    bpy.context.view_layer.update()
    assert obj.evaluated_get(bpy.context.evaluated_depsgraph_get())["A"] == pytest.approx(1.0)
    assert "replaces" not in capfd.readouterr().out
    bpy.data.objects.remove(handle)
    delete_keys(obj)
    assert set(bpy.data.objects) == without


def test_a_mesh_of_another_file_is_refused(tmp_path):
    """Blender would not save its drivers and images."""
    obj, _ = cube_with_targets(2)
    bpy.data.libraries.write(str(tmp_path / "mesh.blend"), {obj})
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    linked = linked_object(tmp_path / "mesh.blend", "Cube Morph")
    bpy.context.view_layer.objects.active = linked
    for press in (bpy.ops.convwass.make_key_pad, bpy.ops.convwass.bake_textures):
        with pytest.raises(RuntimeError, match="linked from another file"):
            press()
    assert bpy.data.objects[:] == [linked]


def test_targets_can_be_added_to_a_mesh_that_has_some():
    """The copy keeps keys and sliders, and a target with an existing name gets a new one."""
    obj, rest = cube_with_targets(2)
    obj.animation_data_clear()
    obj["A"] = 0.25
    further = KeyPath("A", (1.0,), (rest + SHIFTS[2])[None], 0.9, 0.0, 0.0, 0.0, 0)
    more = object_with_keys(obj, obj.data.copy(), [further], bpy.context.scene)
    assert [record["name"] for record in key_records(more)] == ["A", "B", "A.001"]
    more["B"], more["A.001"] = 0.5, 1.0
    more.update_tag()
    np.testing.assert_allclose(world(more), rest + np.array([0.25, 0.5, 1.0]), atol=1e-5)
    np.testing.assert_allclose(world(obj), rest + np.array([0.25, 0.0, 0.0]), atol=1e-5)


def test_deleting_the_mesh_removes_its_pad():
    obj, _ = cube_with_targets(2)
    before = set(bpy.data.objects) - {obj}
    bpy.ops.convwass.make_key_pad()
    delete_keys(obj)
    assert set(bpy.data.objects) == before
    assert not [curve for curve in bpy.data.curves if curve.users == 0]


def test_a_pad_that_drives_another_mesh_stays():
    obj, _ = cube_with_targets(2)
    bpy.ops.convwass.make_key_pad()
    handle, copy = bpy.context.object, obj.copy()
    bpy.context.scene.collection.objects.link(copy)
    delete_keys(obj)
    assert len(handle.parent.children) == 4
    delete_keys(copy)
    assert "Key Handle" not in bpy.data.objects


def test_a_pad_stays_while_it_drives_a_slider_of_a_new_bake():
    obj, _ = cube_with_targets(2)
    bpy.ops.convwass.make_key_pad()
    for names, stays in (("BC", True), ("DE", False)):
        new, _ = cube_with_targets(2, names)
        replace_keys(obj, [new])
        assert ("Key Handle" in bpy.data.objects) == stays


def test_sliders_that_a_new_bake_lacks_leave_no_keyframes():
    obj, _ = cube_with_targets(2)
    new, _ = cube_with_targets(2, "BC")
    replace_keys(obj, [new])
    assert {curve.data_path for curve in curves_of(obj)} == {'["B"]', '["C"]'}


def test_the_handle_is_read_where_it_is_seen_on_the_pad():
    """It moves with its pad, and may hang at something else."""
    obj, rest = cube_with_targets(3)
    bpy.ops.convwass.make_key_pad()
    handle, pad = bpy.context.object, bpy.context.object.parent
    places = corners(pad, 3)
    handle.location = places[1]
    pad.location, pad.rotation_euler, pad.scale = (5, 1, -3), (0.3, -0.6, 2.0), (2, 2, 2)
    np.testing.assert_allclose(world(obj), rest + SHIFTS[0], atol=1e-5)
    bpy.context.view_layer.update()
    guide = bpy.data.objects.new("Guide", None)
    bpy.context.scene.collection.objects.link(guide)
    handle.constraints.clear()
    handle.parent, handle.location = guide, (0, 0, 0)
    for place, shift in zip(places, [np.zeros(3), *SHIFTS], strict=True):
        guide.location = pad.matrix_world @ Vector(place)
        np.testing.assert_allclose(world(obj), rest + shift, atol=1e-5)


def test_a_duplicated_mesh_follows_its_own_handle():
    obj, rest = cube_with_targets(2)
    bpy.ops.convwass.make_key_pad()
    handle = bpy.context.object
    handle.location = corners(handle.parent, 2)[1]
    bpy.context.view_layer.update()
    for own in bpy.context.view_layer.objects:
        own.select_set(own in (obj, handle, handle.parent))
    bpy.ops.object.duplicate()
    made = bpy.context.selected_objects
    other = next(own for own in made if own.type == "EMPTY")
    copy = next(own for own in made if own.type == "MESH" and own.data.shape_keys)
    assert other.parent in made
    other.location = corners(other.parent, 2)[2]
    np.testing.assert_allclose(world(obj), rest + SHIFTS[0], atol=1e-5)
    np.testing.assert_allclose(world(copy), rest + SHIFTS[1], atol=1e-5)
