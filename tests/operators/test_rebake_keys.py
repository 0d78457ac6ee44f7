# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking shape keys again, and deleting them."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.applications.one_mesh.swapped_meshes import SwappedMeshes
from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.morphs.changes import changed_inputs
from convwass_addon.bridge.morphs.stored import frame_objects, stored_morph
from convwass_addon.bridge.one_mesh import shape_key_job, swap_job
from convwass_addon.bridge.one_mesh.baked_keys import SWAP_KEY, baked_keys, shared_slider
from convwass_addon.bridge.one_mesh.records import key_records, objects_of
from convwass_addon.bridge.one_mesh.shape_keys import drive_key
from convwass_addon.progress import Progress
from convwass_addon.sentence import Sentence
from tests.attached import attach_parts
from tests.operators.morphs import PressedBake, census
from tests.operators.running import started, until, window_context
from tests.panels.fake_layout import FakeLayout
from tests.rigs import chain

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture(autouse=True)
def known_paths(monkeypatch):
    """Vertices go straight to those of the other shape; two meshes are swapped halfway, which `at` changes."""
    swap = SimpleNamespace(at=0.5)

    def straight(shapes, names, demands, settings, guides, control):
        yield Progress(0.5, Sentence("Half"))
        return [
            KeyPath(name, (1.0,), shape.vertices[None], 0.95, 0.001, 0.0, 0.0, 0)
            for name, shape in zip(names[1:], shapes[1:], strict=True)
        ]

    def swapped(inputs, error, settings, control, how):
        yield Progress(0.5, Sentence("Half"))
        paths = [
            KeyPath(name, (1.0,), shape.vertices[None] + np.array([0.0, 0.0, 1.0]), None, 0.0, 0.0, 0.001, 0)
            for name, shape in zip(inputs.names[::-1], inputs.shapes, strict=True)
        ]
        return SwappedMeshes(paths[0], paths[1] if swap.at < 1.0 else None, swap.at, 0.001)

    monkeypatch.setattr(shape_key_job, "key_paths", straight)
    monkeypatch.setattr(swap_job, "swapped_meshes", swapped)
    return swap


@pytest.fixture
def shapes():
    """Cubes A, B and C, of heights 2, 4 and 6."""
    made = []
    for name, height in zip("ABC", (1.0, 2.0, 3.0), strict=True):
        bpy.ops.mesh.primitive_cube_add(scale=(1, 1, height))
        bpy.context.object.name = name
        made.append(bpy.context.object)
    return made


def bake(inputs="A,B,C", **options):
    assert bpy.ops.convwass.bake_morph(inputs=inputs, output="SHAPE_KEYS", frames=10, **options) == {"FINISHED"}
    return bpy.data.objects["A Morph"]


def height(obj, **sliders):
    for name, value in sliders.items():
        obj[name] = value
    obj.update_tag()
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return np.ptp([vertex.co.z for vertex in mesh.vertices])


def rigged(body):
    """Bind a cube to an armature of one bone."""
    bpy.ops.object.armature_add()
    rig = bpy.context.object
    body.parent = rig
    body.vertex_groups.new(name="Bone").add(range(8), 1.0, "REPLACE")
    body.modifiers.new("Armature", "ARMATURE").object = rig
    return rig


def test_the_object_stays_and_gets_the_changed_shapes(shapes):
    obj = bake()
    before = census()
    assert changed_inputs(obj) == []
    shapes[1].scale.z = 5.0
    bpy.context.view_layer.update()
    assert changed_inputs(obj) == ["B"]
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert census() == before
    assert bpy.context.object == obj == bpy.data.objects["A Morph"]
    obj.animation_data.action = None
    assert height(obj, B=0.0, C=0.0) == pytest.approx(2.0)
    assert height(obj, B=1.0, C=0.0) == pytest.approx(20.0)
    assert height(obj, B=0.0, C=0.5) == pytest.approx(4.0)
    assert changed_inputs(obj) == []
    assert all(shape.hide_get() and shape.hide_render for shape in shapes)


def test_keys_materials_modifiers_and_place_are_kept(shapes):
    obj = bake()
    obj["B"] = 0.75
    obj.keyframe_insert('["B"]', frame=40)
    obj.location.x, obj["Own"] = 7.0, "text"
    obj.modifiers.new("Wires", "WIREFRAME")
    obj.data.materials[0] = bpy.data.materials.new("Skin")
    bpy.context.scene.collection.objects.unlink(obj)
    home = bpy.data.collections.new("Home")
    bpy.context.scene.collection.children.link(home)
    home.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    curves = {curve.data_path: [point.co[:] for point in curve.keyframe_points] for curve in curves_of(obj)}
    bpy.ops.convwass.rebake_morph()
    again = {curve.data_path: [point.co[:] for point in curve.keyframe_points] for curve in curves_of(obj)}
    assert again == curves
    assert (obj.location.x, obj["Own"], obj.users_collection[0]) == (7.0, "text", home)
    assert [modifier.name for modifier in obj.modifiers] == ["Wires"]
    assert [material.name for material in obj.data.materials] == ["Skin"]


def smiling(obj):
    """Give an object a shape key whose value is animated, as an artist does; return the action."""
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Smile")
    for frame, value in ((1, 0.0), (9, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    key.value = 0.0
    action = obj.data.shape_keys.animation_data.action
    action.name = "Smiling"
    return action


def contents(action):
    """Return the slots of an action and the keys in them."""
    curves = [curve for bag in action.layers[0].strips[0].channelbags for curve in bag.fcurves]
    keys = [(curve.data_path, [point.co[:] for point in curve.keyframe_points]) for curve in curves]
    return [slot.identifier for slot in action.slots], keys


def test_keys_of_sliders_stay_out_of_the_animation_of_the_shape(shapes):
    action = smiling(shapes[0])
    before, there = contents(action), census()
    obj = bake()
    keys = obj.data.shape_keys
    assert contents(action) == before
    assert obj.animation_data.action not in (action, keys.animation_data.action)
    assert [curve.data_path for curve in curves_of(keys)] == ['key_blocks["Smile"].value']
    keys.key_blocks["Smile"].keyframe_insert("value", frame=20)
    assert contents(action) == before
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    bpy.context.scene.frame_set(9)
    assert obj.data.shape_keys.key_blocks["Smile"].value == 1.0
    assert contents(action) == before and len(bpy.data.actions) == 3
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
    assert contents(action) == before and census()["actions"] == there["actions"]


def test_a_slider_that_was_missing_is_keyed_in_an_action_of_the_object(shapes):
    smiling(shapes[0])
    obj = bake(inputs="A,B")
    kept = obj.data.shape_keys.animation_data.action
    obj.animation_data_clear()
    del obj["B"]
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert [curve.data_path for curve in curves_of(obj)] == ['["B"]']
    assert obj.animation_data.action not in (kept, obj.data.shape_keys.animation_data.action)


def test_custom_properties_that_the_mesh_got_since_come_along(shapes):
    shapes[0]["early"] = 1.0
    obj = bake()
    shapes[0]["early"], shapes[0]["late"], obj["early"] = 2.0, 3.0, 4.0
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert (obj["early"], obj["late"]) == (4.0, 3.0)


def test_drivers_of_modifiers_and_custom_properties_stay_as_they_are(shapes):
    rigged(shapes[0])
    shapes[0].modifiers.new("Thick", "SOLIDIFY")
    for path in ("own", "late"):
        shapes[0][path] = 1.0
    for path in ('["own"]', 'modifiers["Thick"].thickness'):
        shapes[0].driver_add(path).driver.expression = "2"
    obj = bake()
    for curve in obj.animation_data.drivers:
        curve.driver.expression = "3"
    obj.pop("late")
    shapes[0].driver_add('["late"]').driver.expression = "4"
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert (obj["own"], obj["late"], obj.modifiers["Thick"].thickness) == (3.0, 4.0, 3.0)


def test_shapes_that_stay_in_renders_are_named(shapes, capfd):
    shapes[1].driver_add("hide_render").driver.expression = "0"
    bake()
    assert "Renders may show B beside the morph" in capfd.readouterr().out
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert "Renders may show B beside the morph" in capfd.readouterr().out


def test_linked_duplicates_show_the_new_mesh(shapes, capfd):
    obj = bake("A,B")
    twin = obj.copy()
    bpy.context.scene.collection.objects.link(twin)
    shapes[1].scale.z = 5.0
    bpy.ops.convwass.rebake_morph()
    assert twin.data == obj.data
    assert "Attach" not in capfd.readouterr().out
    obj.animation_data.action = None
    height(obj, B=1.0)
    assert height(twin) == pytest.approx(20.0)


def test_settings_are_those_of_the_bake(shapes):
    obj = bake("A,B", key_error=1.5, layout="TRIANGLE", start="CUSTOM", frame_start=7)
    before = stored_morph(obj)
    assert (before.settings["key_error"], before.settings["layout"], before.first_frame) == (1.5, "PATH", 7)
    bpy.context.scene.convwass_morph.key_error = 0.1
    bpy.ops.convwass.rebake_morph()
    after = stored_morph(obj)
    same = {name: value for name, value in before.settings.items() if name not in ("start", "frame_start")}
    assert {name: after.settings[name] for name in same} == same
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.convwass.select_morph_inputs() == {"FINISHED"}
    assert bpy.context.scene.convwass_morph.output == "SHAPE_KEYS"
    assert bpy.context.scene.convwass_morph.key_error == pytest.approx(1.5)
    assert set(bpy.context.selected_objects) == set(shapes[:2])


def test_a_shape_that_was_added_by_a_script_gets_a_slider_with_keys(shapes):
    obj = bake("A,B")
    bpy.ops.convwass.bake_morph(inputs="A,C", output="SHAPE_KEYS", frames=10, replaces=obj.name)
    assert [record["name"] for record in key_records(obj)] == ["C"]
    assert "B" not in obj and "C" in obj
    (curve,) = (curve for curve in curves_of(obj) if curve.data_path == '["C"]')
    assert [point.co[:] for point in curve.keyframe_points] == [(1.0, 0.0), (11.0, 1.0)]


def test_a_missing_shape_is_named_and_the_object_kept(shapes):
    obj = bake()
    bpy.data.objects.remove(shapes[2])
    bpy.context.view_layer.objects.active = obj
    before = census()
    with pytest.raises(RuntimeError, match="A Morph was baked from C, which no longer exists"):
        bpy.ops.convwass.rebake_morph()
    assert census() == before


def test_all_are_baked_with_the_morphs_of_the_file(shapes):
    obj = bake("A,B")
    bpy.ops.convwass.bake_morph(inputs="A,B", motion="TRANSPORT", frames=2, resolution=32)
    shapes[1].scale.z = 1.5
    bpy.context.view_layer.update()
    assert bpy.ops.convwass.rebake_morph(which="STALE") == {"FINISHED"}
    assert not any(changed_inputs(block) for block in (obj, bpy.data.collections["Morph A to B"]))
    assert bpy.ops.convwass.rebake_morph(which="STALE") == {"CANCELLED"}


@pytest.mark.parametrize(("place", "two_meshes", "is_reported"), [(0, False, True), (1, False, False), (1, True, True)])
def test_a_posed_armature_that_the_keys_do_not_heed_is_reported(shapes, capfd, place, two_meshes, is_reported):
    rigs = [chain(name=name) for name in ("Early", "Late")]
    rigs[1].pose.bones["A"].location.x = 0.5
    for rig in rigs:
        shapes[place].modifiers.new("Smooth", "SMOOTH")
        shapes[place].modifiers.new(rig.name, "ARMATURE").object = rig
    bpy.context.view_layer.update()
    bake("A,B", two_meshes=two_meshes)
    assert ("are made without the pose of Late" in capfd.readouterr().out) == is_reported


def test_attached_parts_are_to_be_attached_again(shapes, capfd):
    obj = bake("A,B")
    bpy.ops.mesh.primitive_cube_add(scale=(1.1, 1.1, 0.5))
    shirt = bpy.context.object
    shirt.name = "Shirt"
    attach_parts(obj, [shirt], rigid=False)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.convwass.rebake_morph()
    assert "Attach Shirt again, since their keys follow the last bake" in capfd.readouterr().out
    # The slider moves it still.
    obj.animation_data.action = None
    assert height(shirt) == pytest.approx(1.0)
    height(obj, B=1.0)
    assert height(shirt) > 1.5


@pytest.mark.parametrize("body", ["A Morph", "B Morph"])
def test_parts_attached_to_one_of_two_meshes_are_to_be_attached_again(shapes, capfd, body):
    first = bake("A,B", two_meshes=True)
    bpy.ops.mesh.primitive_cube_add()
    shirt = bpy.context.object
    shirt.name = "Shirt"
    attach_parts(bpy.data.objects[body], [shirt], rigid=False)
    bpy.context.view_layer.objects.active = first
    bpy.ops.convwass.rebake_morph()
    assert "Attach Shirt again, since their keys follow the last bake" in capfd.readouterr().out


def test_two_meshes_are_baked_again_as_a_pair(shapes, known_paths):
    first = bake("A,B", two_meshes=True)
    (_, second) = objects_of(first)
    first["B"] = 0.25
    first.keyframe_insert('["B"]', frame=40)
    before, points = census(), len(curves_of(first)[0].keyframe_points)
    known_paths.at = 0.3
    bpy.context.view_layer.objects.active = second
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert census() == before
    assert objects_of(first) == [first, second]
    assert shared_slider(first) == shared_slider(second) == (first, "B")
    assert first[SWAP_KEY]["at"] == pytest.approx(0.3)
    assert len(curves_of(first)[0].keyframe_points) == points
    drivers = [*first.animation_data.drivers, *second.animation_data.drivers]
    assert len(drivers) == 5
    assert {target.id for curve in drivers for own in curve.driver.variables for target in own.targets} == {first}
    first.animation_data.action = None
    for value, shown in ((0.2, first), (0.4, second)):
        first["B"] = value
        first.update_tag()
        bpy.context.view_layer.update()
        assert [obj for obj in (first, second) if not obj.hide_render] == [shown]


def test_a_mesh_that_no_longer_moves_loses_its_slider(shapes, known_paths):
    first = bake("A,B", two_meshes=True)
    (_, second) = objects_of(first)
    assert "A" in second
    known_paths.at = 1.0
    bpy.ops.convwass.rebake_morph()
    assert "A" not in second
    assert len(second.animation_data.drivers) == 2


def test_a_second_mesh_that_was_deleted_is_made_again(shapes):
    first = bake("A,B", two_meshes=True)
    bpy.data.objects.remove(objects_of(first)[1])
    bpy.context.view_layer.objects.active = first
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    first, second = objects_of(first)
    assert (first.name, second.name, second.parent) == ("A Morph", "B Morph", first)
    assert shared_slider(second) == (first, "B")


@pytest.mark.parametrize("two_meshes", [False, True])
def test_deleting_them_shows_the_shapes(shapes, two_meshes):
    before = census()
    obj = bake("A,B", two_meshes=two_meshes)
    assert baked_keys(objects_of(obj)[-1]) == obj
    bpy.context.view_layer.objects.active = objects_of(obj)[-1]
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
    assert {**census(), "materials": []} == {**before, "materials": []}
    assert not any(shape.hide_get() or shape.hide_render for shape in shapes)


def fingerprint(obj):
    keys = obj.data.shape_keys
    drivers = keys.animation_data.drivers if keys and keys.animation_data else ()
    names = [key.name for key in keys.key_blocks] if keys else []
    return names, [curve.data_path for curve in drivers], height(obj)


def select_and_delete(obj):
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}


def test_attached_parts_are_as_before_when_the_morph_is_deleted(shapes, capfd):
    """Also one with a key of its own, and one that two objects share."""
    parts = []
    for name in ("Shirt", "Hat"):
        bpy.ops.mesh.primitive_cube_add(scale=(1.1, 1.1, 0.5))
        parts.append(bpy.context.object)
        parts[-1].name = name
    for name in ("Basis", "Dent"):
        parts[1].shape_key_add(name=name, from_mix=False)
    before = [fingerprint(part) for part in parts]
    obj = bake("A,B")
    attach_parts(obj, parts, rigid=False)
    twin = parts[1].copy()
    twin.name = "Twin"
    bpy.context.scene.collection.objects.link(twin)
    obj.animation_data.action = None
    height(obj, B=1.0)
    assert [fingerprint(part) for part in parts] != before
    select_and_delete(obj)
    bpy.context.view_layer.update()
    assert [fingerprint(part) for part in parts] == before
    assert "A Morph: deleted. The shape keys with which Hat, Shirt followed it are removed\n" in capfd.readouterr().out


@pytest.mark.parametrize("body", ["A Morph", "B Morph"])
def test_parts_are_detached_from_both_of_two_meshes(shapes, body):
    first = bake("A,B", two_meshes=True)
    bpy.ops.mesh.primitive_cube_add()
    shirt = bpy.context.object
    attach_parts(bpy.data.objects[body], [shirt], rigid=False)
    select_and_delete(first)
    assert shirt.data.shape_keys is None


def test_drivers_of_the_user_are_named_when_their_slider_is_deleted(shapes, capfd):
    obj = bake("A,B")
    bpy.ops.mesh.primitive_cube_add()
    shirt = bpy.context.object
    shirt.name = "Shirt"
    shirt.shape_key_add(name="Basis")
    drive_key(obj, shirt.shape_key_add(name="Own"), "B", "v * v")
    select_and_delete(obj)
    assert [key.name for key in shirt.data.shape_keys.key_blocks] == ["Basis", "Own"]
    said = capfd.readouterr().out
    assert (
        "Warning: A Morph: deleted. Drivers of shape keys of Shirt read sliders that are deleted; remove thes" in said
    )


def test_a_linked_duplicate_of_the_mesh_keeps_its_keys(shapes):
    obj = bake("A,B")
    twin = obj.copy()
    bpy.context.scene.collection.objects.link(twin)
    select_and_delete(obj)
    assert [key.name for key in twin.data.shape_keys.key_blocks] == ["Basis", "B"]


def test_the_panel_has_the_buttons_of_what_stores_its_bake(shapes):
    obj = bake("A,B")
    bpy.context.view_layer.objects.active = obj
    buttons = ("convwass.rebake_morph", "convwass.select_morph_inputs", "convwass.delete_morph")

    def drawn():
        shown = SimpleNamespace(layout=FakeLayout())
        bpy.types.CONVWASS_PT_one_mesh.draw(shown, bpy.context)
        return [text for _, text in shown.layout.drawn]

    assert set(buttons) <= set(drawn())
    shapes[1].scale.z = 9.0
    bpy.context.view_layer.update()
    assert "Changed since it was baked: B" in " ".join(drawn())
    # As it was made by an earlier version.
    del obj["convwass_morph"]
    assert not set(buttons) & set(drawn())
    with pytest.raises(RuntimeError, match="Select an object of a baked morph"):
        bpy.ops.convwass.select_morph_inputs()


def test_the_panel_of_a_morph_is_not_shown_for_an_object_with_keys(shapes):
    """Its buttons would act on the object."""
    bpy.ops.convwass.bake_morph(inputs="A,C", motion="TRANSPORT", frames=2, resolution=32)
    obj, layer = bake("A,B"), bpy.context.view_layer
    layer.active_layer_collection = layer.layer_collection.children["Morph A to C"]
    layer.objects.active = obj
    assert not bpy.types.CONVWASS_PT_baked_morph.poll(bpy.context)
    layer.objects.active = None
    assert bpy.types.CONVWASS_PT_baked_morph.poll(bpy.context)
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
    assert "A Morph" in bpy.data.objects and "Morph A to C" not in bpy.data.collections


def test_a_morph_of_the_same_name_is_another_bake(shapes):
    bpy.ops.convwass.bake_morph(inputs="A,C", motion="TRANSPORT", frames=2, resolution=32)
    morph = bpy.data.collections["Morph A to C"]
    morph.name = "A Morph"
    obj, kept = bake("A,B"), frame_objects(morph)
    shapes[1].scale.z = 5.0
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert changed_inputs(obj) == []
    assert frame_objects(morph) == kept
    assert bpy.ops.convwass.rebake_morph(session_uids=str(obj.session_uid)) == {"FINISHED"}
    assert frame_objects(morph) == kept


def test_two_meshes_whose_first_one_was_deleted_are_refused_in_words(shapes):
    """Deleted as a user does it: the second one still refers to it."""
    first = bake("A,B", two_meshes=True)
    (_, second) = objects_of(first)
    for collection in first.users_collection:
        collection.objects.unlink(first)
    bake("A,C")
    bpy.context.view_layer.objects.active = second
    with pytest.raises(RuntimeError, match="A Morph, which stores how both meshes were baked, was deleted"):
        bpy.ops.convwass.rebake_morph()
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}


@pytest.mark.parametrize(("edited", "slider"), [("A Morph", 0.0), ("B Morph", 1.0)])
def test_in_edit_mode_the_result_waits(shapes, edited, slider):
    first = bake("A,B", two_meshes=True)
    first.animation_data.action = None
    height(first, B=slider)
    before = [obj.data.session_uid for obj in objects_of(first)]
    settings = bpy.context.scene.convwass_morph
    settings.output, settings.two_meshes, settings.frames = "SHAPE_KEYS", True, 10
    pressed, context = PressedBake(), window_context()
    pressed.replaces = first.name
    assert started(pressed, context)
    bpy.context.view_layer.objects.active = bpy.data.objects[edited]
    bpy.ops.object.mode_set(mode="EDIT")
    progress = context.window_manager.convwass_progress
    assert until(pressed, context, lambda: "leave Edit Mode" in progress.message) == {"PASS_THROUGH"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert until(pressed, context) == {"FINISHED"}
    assert not set(before) & {obj.data.session_uid for obj in objects_of(first)}


def test_a_rigged_mesh_keeps_its_armature_and_groups(shapes):
    rig = rigged(shapes[0])
    obj = bake("A,B")
    obj.modifiers.new("Wires", "WIREFRAME")
    bpy.context.view_layer.objects.active = obj
    bpy.ops.convwass.rebake_morph()
    assert [modifier.name for modifier in obj.modifiers] == ["Armature", "Wires"]
    assert (obj.parent, obj.modifiers["Armature"].object) == (rig, rig)
    assert [group.name for group in obj.vertex_groups] == ["Bone"]
    assert {entry.weight for vertex in obj.data.vertices for entry in vertex.groups} == {1.0}


def test_a_rigged_mesh_that_a_bake_has_hidden_is_shown_by_the_next_one(shapes):
    rigged(shapes[0])
    bake("A,B")
    assert shapes[0].hide_render
    assert bpy.ops.convwass.bake_morph(inputs="A,C", output="SHAPE_KEYS", frames=10) == {"FINISHED"}
    assert not bpy.context.object.hide_render


def test_a_mesh_made_from_one_of_two_rigged_meshes_is_a_bake_of_its_own(shapes):
    rigged(shapes[1])
    first = bake("A,B", two_meshes=True)
    (_, second) = objects_of(first)
    bpy.ops.convwass.bake_morph(inputs="B Morph,C", output="SHAPE_KEYS", frames=10)
    obj = bpy.context.object
    assert baked_keys(obj) == obj
    assert not obj.hide_viewport
    assert [record["name"] for record in key_records(obj)] == ["A", "C"]
    assert objects_of(first) == [first, second]
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
    assert {"A Morph", "B Morph"} < set(bpy.data.objects.keys())
