# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking a morph again with its stored settings."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.morph import morph as morph_of_meshes
from convwass_addon.bridge.keyframes import curves_of, shown_during
from convwass_addon.bridge.morphs import job
from convwass_addon.bridge.morphs.changes import changed_inputs
from convwass_addon.bridge.morphs.players.seen_frames import shows_as_baked
from convwass_addon.bridge.morphs.showing import main_object
from convwass_addon.bridge.morphs.stand_ins import shown_morph, shows_frames, stand_ins
from convwass_addon.bridge.morphs.stored import frame_objects, shown_frames, stored_morph
from convwass_addon.bridge.object_names import ObjectName, objects_named
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.shape_sources import shape_source
from convwass_addon.errors import ConvwassError
from tests.linked_objects import linked_object
from tests.operators.morphs import PressedBake, guide_coarsely
from tests.operators.running import ESCAPE, TIMER, started, until, wait_for_the_thread, window_context


def bake(**options):
    """Bake two spheres of a new pair; returns the morph."""
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    made = []
    for x in (0.0, 3.0):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(x, 0, 0))
        made.append(bpy.context.object)
    for obj in made:
        obj.select_set(True)
    before = set(bpy.data.collections)
    bpy.ops.convwass.bake_morph(**{"motion": "TRANSPORT", "frames": 3, "resolution": 20, **options})
    return next(collection for collection in bpy.data.collections if collection not in before)


def bake_two():
    return [bake() for _ in range(2)]


def bake_five():
    return [bake() for _ in range(5)]


def baked_morphs():
    return [collection for collection in bpy.data.collections if "convwass_morph" in collection]


@pytest.fixture
def morph(empty_scene, scene_with):
    scene_with(bake)
    return baked_morphs()[0]


@pytest.fixture
def morphs(empty_scene, scene_with):
    scene_with(bake_two)
    return baked_morphs()


@pytest.fixture
def many_morphs(empty_scene, scene_with):
    scene_with(bake_five)
    return baked_morphs()


def middle_width(morph):
    """Width of a frame between the shapes."""
    mesh = triangle_mesh(frame_objects(morph)[1], bpy.context.evaluated_depsgraph_get())
    low, high = mesh.bounds
    return (high - low)[2]


def shapes(morph):
    return [bpy.data.objects[name] for name in stored_morph(morph).inputs]


def test_a_damaged_description_does_not_stop_the_panel(morph):
    morph["convwass_morph"] = "{"
    assert changed_inputs(morph) == []


def test_a_changed_shape_is_noticed_and_baked_again(morph):
    name, width = morph.name, middle_width(morph)
    assert changed_inputs(morph) == []
    for obj in shapes(morph):
        obj.scale.z = 2.0
    bpy.context.view_layer.update()
    assert changed_inputs(morph) == stored_morph(morph).inputs
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    again = bpy.data.collections[name]
    assert sum("convwass_morph" in collection for collection in bpy.data.collections) == 1
    assert len(frame_objects(again)) == 4
    assert middle_width(again) == pytest.approx(2 * width, rel=0.05)
    assert changed_inputs(again) == []


def names_of(morph):
    frames = frame_objects(morph)
    return [[obj.name, obj.data.name, obj.animation_data.action.name] for obj in frames]


def test_frames_keep_their_names(morphs):
    """Those of another morph, which have numbers, too, and those that the user has chosen."""
    morph, other = morphs
    frame_objects(other)[1].name = "Hero"
    frame_objects(other)[1].data.name = "Body"
    names = [names_of(own) for own in (morph, other)]
    assert names[0][1][:2] == ["Morph 0002", "Morph 0002"] and names[1][1][:2] == ["Hero", "Body"]
    for _ in range(2):
        assert bpy.ops.convwass.rebake_morph(which="ALL") == {"FINISHED"}
        assert [names_of(own) for own in (morph, other)] == names


def test_what_a_player_consists_of_keeps_its_names(empty_scene):
    """The collection has a name that ends with a number, too."""
    bake(output="PLAYER")
    kinds = ("objects", "meshes", "node_groups", "actions", "collections")
    names = {kind: sorted(getattr(bpy.data, kind).keys()) for kind in kinds}
    assert any(name.endswith(".001 Fields") for name in names["objects"])
    for _ in range(2):
        assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
        assert {kind: sorted(getattr(bpy.data, kind).keys()) for kind in kinds} == names


@pytest.mark.parametrize("has_player", [False, True])
def test_what_refers_to_a_frame_refers_to_the_new_one(morph, has_player):
    if has_player:
        bpy.ops.convwass.make_player(between="NEAREST")
    mine = bpy.data.collections.new("Mine")
    bpy.context.scene.collection.children.link(mine)
    mine.objects.link(frame_objects(morph)[0])
    follower = bpy.data.objects.new("Follower", None)
    mine.objects.link(follower)
    follower.parent = frame_objects(morph)[1]
    follower.constraints.new("COPY_ROTATION").target = frame_objects(morph)[2]
    before = frame_objects(morph)
    vertices = len(before[1].data.vertices)
    for obj in shapes(morph):
        obj.scale.z = 2.0
    bpy.context.view_layer.update()
    assert bpy.ops.convwass.rebake_morph(morphs=morph.name) == {"FINISHED"}
    frames = frame_objects(morph)
    assert len(frames) == 4 and len(frames[1].data.vertices) != vertices
    assert set(mine.objects) == {follower, frames[0]}
    assert (follower.parent, follower.constraints[0].target) == (frames[1], frames[2])
    assert sorted(obj.name for obj in bpy.data.objects if "Morph 0" in obj.name) == [obj.name for obj in frames]


def move_keys(objects, way):
    """Move the keys of objects in time, as in the Dope Sheet."""
    for curve in (curve for obj in objects for curve in curves_of(obj)):
        for point in curve.keyframe_points:
            point.co_ui.x += way
        curve.update()


def shown_in(morph, frames):
    """Return which frame objects are shown in scene frames."""
    objects = frame_objects(morph)
    shown = [shown_during(obj, frames) for obj in objects]
    return [[index for index, own in enumerate(shown) if own[place]] for place in range(len(frames))]


@pytest.mark.parametrize(("stays", "way"), [(0, 20), (0, -20), (2, 20)])
def test_frames_that_were_moved_in_time_stay_there(morph, stays, way):
    """All frames of the morph are shown at other times, or only the last two."""
    move_keys(frame_objects(morph)[stays:], way)
    shown, start = shown_in(morph, range(-50, 50)), stored_morph(morph).first_frame
    kept = frame_objects(morph)
    bpy.ops.convwass.rebake_morph()
    assert not set(frame_objects(morph)).intersection(kept)
    assert shown_in(morph, range(-50, 50)) == shown
    assert stored_morph(morph).first_frame == start + (way if stays == 0 else 0)


def test_frames_that_last_twice_as_long_are_shown_from_where_the_first_begins(morph):
    """Its only keys are where it ends."""
    start = stored_morph(morph).first_frame
    for place, obj in enumerate(frame_objects(morph)):
        move_keys([obj], max(place, 1))
    assert shown_frames(morph) == range(start, start + 2 * 3 + 1)


def test_a_player_and_files_start_where_frames_were_moved(morph):
    move_keys(frame_objects(morph), 20)
    start = 20 + stored_morph(morph).first_frame
    assert shown_frames(morph) == range(start, start + 4)
    bpy.ops.convwass.make_player(between="NEAREST")
    (curve,) = curves_of(main_object(morph))
    assert [point.co.x for point in curve.keyframe_points] == [start, start + 3]


def armature():
    bpy.ops.object.armature_add(location=(1.0, 0.0, 2.0), rotation=(0.0, 0.5, 0.0))
    return bpy.context.object


def test_a_player_is_as_slow_as_the_frames(morph):
    """Keys are scaled in the Dope Sheet, and one frame is held for longer."""
    frames = frame_objects(morph)
    for curve in (own for obj in frames for own in curves_of(obj)):
        for point in curve.keyframe_points:
            point.co.x = 2 * point.co.x + (30 if point.co.x > 3 else 0)
        curve.update()
    shown = shown_in(morph, range(-5, 60))
    times = [next(time for time, found in zip(range(-5, 60), shown, strict=True) if found == [n]) for n in range(1, 4)]
    bpy.ops.convwass.make_player(between="NEAREST")
    (curve,) = curves_of(main_object(morph))
    weights = [obj["convwass_weights"][1] for obj in frames]
    assert [curve.evaluate(time) for time in times] == pytest.approx(weights[1:])
    assert shows_as_baked(main_object(morph))


def test_frames_keep_their_parents(morph):
    """An Empty with the inverse of its place, a bone, a vertex, and another frame."""
    holder, rig, frames = bpy.data.objects.new("Holder", None), armature(), frame_objects(morph)
    bpy.context.scene.collection.objects.link(holder)
    holder.location, holder.rotation_euler = (2.0, 0.0, 1.0), (0.0, 0.0, 0.7)
    bpy.context.view_layer.update()
    frames[0].parent, frames[0].matrix_parent_inverse = holder, holder.matrix_world.inverted()
    frames[1].parent, frames[1].parent_type, frames[1].parent_bone = rig, "BONE", "Bone"
    frames[2].parent, frames[2].parent_type, frames[2].parent_vertices = shapes(morph)[1], "VERTEX", (3, 0, 0)
    frames[3].parent = frames[0]
    holder.location.x = 7.0
    bpy.context.view_layer.update()
    places = [np.array(obj.matrix_world) for obj in frames]
    assert not np.allclose(places[0], np.eye(4))
    assert bpy.ops.convwass.rebake_morph(morphs=morph.name) == {"FINISHED"}
    bpy.context.view_layer.update()
    again = frame_objects(morph)
    np.testing.assert_allclose([np.array(obj.matrix_world) for obj in again], places, atol=1e-6)
    assert [obj.parent for obj in again] == [holder, rig, shapes(morph)[1], again[0]]


@pytest.mark.parametrize("operator", ["rebake_morph", "delete_morph"])
def test_duplicates_of_frames_are_no_frames_and_stay(morph, operator):
    """As a user makes them for a simulation, with and without the keys of their visibility."""
    frames = frame_objects(morph)
    still, copy = frames[1].copy(), frames[2].copy()
    for obj, name in ((still, "A Still"), (copy, f"{frames[2].name}.001")):
        obj.name, obj.data = name, obj.data.copy()
        morph.objects.link(obj)
    still.animation_data_clear()
    assert frame_objects(morph) == frames
    bpy.context.view_layer.objects.active = frames[0]
    name = morph.name
    assert getattr(bpy.ops.convwass, operator)() == {"FINISHED"}
    assert bpy.data.objects[still.name] == still and bpy.data.objects[copy.name] == copy
    assert not any("convwass_weights" in obj or "convwass_index" in obj for obj in (still, copy))
    if name in bpy.data.collections:
        assert len(frame_objects(bpy.data.collections[name])) == len(frames)
        assert not {still, copy} & set(frame_objects(bpy.data.collections[name]))


@pytest.mark.parametrize("how", ["excluded", "disabled"])
def test_hidden_inputs_have_not_changed_when_the_file_is_opened(morph, tmp_path, how):
    obj = shapes(morph)[0]
    obj.modifiers.new("Array", "ARRAY")
    obj.location.x = 2.0
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    name, shape = next(found.name for found in bpy.data.collections if "convwass_morph" in found), obj.name
    if how == "excluded":
        home = bpy.data.collections.new("Sources")
        bpy.context.scene.collection.children.link(home)
        home.objects.link(obj)
        for other in obj.users_collection[:-1]:
            other.objects.unlink(obj)
        bpy.context.view_layer.layer_collection.children["Sources"].exclude = True
    else:
        obj.hide_viewport = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "hidden.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "hidden.blend"))
    assert changed_inputs(bpy.data.collections[name]) == []
    bpy.data.objects[shape].modifiers.clear()
    assert changed_inputs(bpy.data.collections[name]) == [shape]


@pytest.mark.parametrize(
    "change",
    [
        lambda obj: setattr(obj.location, "x", 0.5),
        lambda obj: obj.modifiers.new("Subdivision", "SUBSURF"),
        lambda obj: setattr(obj.data.vertices[0], "co", (0, 0, 3)),
        lambda obj: bpy.data.objects.remove(obj),
    ],
)
def test_changed_inputs_are_recognized(morph, change):
    obj = shapes(morph)[0]
    name = obj.name
    change(obj)
    if name in bpy.data.objects:
        obj.data.update()
    bpy.context.view_layer.update()
    assert changed_inputs(morph) == [name]


def test_only_outdated_morphs_are_baked(morphs):
    morph, other = morphs
    kept = frame_objects(morph)
    shapes(other)[0].scale.z = 1.5
    bpy.context.view_layer.update()
    bpy.ops.convwass.rebake_morph(which="STALE")
    assert frame_objects(morph) == kept
    assert changed_inputs(other) == []
    assert bpy.ops.convwass.rebake_morph(which="STALE") == {"CANCELLED"}
    assert bpy.ops.convwass.rebake_morph(which="ALL") == {"FINISHED"}
    assert len(frame_objects(morph)) == 4


@pytest.mark.parametrize("which", ["STALE", "ALL"])
@pytest.mark.parametrize("instanced", [False, True])
def test_a_morph_of_a_player_is_baked_after_that(morph, which, instanced):
    """Its name comes first, and its shape only changes with the player."""
    source = shapes(morph)[0]
    bpy.ops.convwass.make_player(between="NEAREST")
    shape = bpy.context.object
    if instanced:
        shape = bpy.data.objects.new("Instance", None)
        shape.instance_type, shape.instance_collection = "COLLECTION", morph
        bpy.context.scene.collection.objects.link(shape)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(3, 0, 0))
    inputs = f"{bpy.context.object.name},{shape.name}"
    bpy.ops.convwass.bake_morph(inputs=inputs, motion="TRANSPORT", frames=3, resolution=20)
    (second,) = (other for other in baked_morphs() if other != morph)
    second.name, morph.name = "A", "B"
    source.scale.z = 1.5
    bpy.context.view_layer.update()
    assert bpy.ops.convwass.rebake_morph(which=which) == {"FINISHED"}
    assert changed_inputs(second) == []
    shown = triangle_mesh(frame_objects(second)[-1], bpy.context.evaluated_depsgraph_get())
    assert np.ptp(shown.bounds[:, 2]) == pytest.approx(3.0)


@pytest.mark.parametrize("how", ["EXEC_DEFAULT", "INVOKE_DEFAULT"])
def test_all_morphs_are_baked_although_some_cannot_be(many_morphs, how):
    morph, *others = many_morphs
    missing = [shapes(other)[0].name for other in (morph, *others[1:3])]
    for name in missing:
        bpy.data.objects.remove(bpy.data.objects[name])
    for other in (others[0], others[3]):
        shapes(other)[0].scale.z = 1.5
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError) as error:
        bpy.ops.convwass.rebake_morph(how, which="ALL")
    if how == "EXEC_DEFAULT":
        assert all(name in str(error.value) for name in missing)
    assert [changed_inputs(other) for other in (others[0], others[3])] == [[], []]
    bpy.context.view_layer.objects.active = frame_objects(morph)[0]
    with pytest.raises(RuntimeError, match=missing[0]):
        bpy.ops.convwass.rebake_morph()


@pytest.fixture
def several(morphs):
    """The first of several bakes, in a window, the morph that it replaces and the morph to bake after it."""
    morph, other = morphs
    shapes(other)[0].scale.z = 1.5
    bpy.context.view_layer.update()
    pressed, context = PressedBake(), window_context()
    pressed.inputs, pressed.replaces = ",".join(stored_morph(morph).inputs), morph.name
    pressed.following = str(other.session_uid)
    settings = bpy.context.scene.convwass_morph
    settings.motion, settings.frames, settings.resolution = "TRANSPORT", 3, 20
    return SimpleNamespace(pressed=pressed, context=context, morph=morph, other=other)


def let_writing_fail(monkeypatch):
    write = job.MorphJob.write

    def failing(own, report):
        monkeypatch.setattr(job.MorphJob, "write", write)
        raise ConvwassError("The disk is full.")

    monkeypatch.setattr(job.MorphJob, "write", failing)


def test_after_a_bake_that_fails_in_the_background_the_next_one_starts(several, monkeypatch):
    let_writing_fail(monkeypatch)
    kept = frame_objects(several.morph)
    assert started(several.pressed, several.context)
    assert until(several.pressed, several.context) == {"CANCELLED"}
    assert several.pressed.reports == ["The disk is full."]
    assert (frame_objects(several.morph), changed_inputs(several.other)) == (kept, [])


def test_escape_while_a_bake_fails_stops_the_following_ones(several, monkeypatch):
    assert started(several.pressed, several.context)
    let_writing_fail(monkeypatch)
    wait_for_the_thread()
    assert several.pressed.modal(several.context, ESCAPE) == {"CANCELLED"}
    assert several.pressed.reports == ["The disk is full."]
    assert changed_inputs(several.other) != []


@pytest.mark.parametrize("stops", [False, True])
def test_escape_after_a_bake_is_computed_keeps_it_and_stops_the_following_ones(several, stops):
    kept = frame_objects(several.morph)
    assert started(several.pressed, several.context)
    wait_for_the_thread()
    assert until(several.pressed, several.context, event=ESCAPE if stops else TIMER) == {"FINISHED"}
    assert frame_objects(several.morph) != kept
    assert bool(changed_inputs(several.other)) == stops


def test_settings_are_those_of_the_morph_and_not_of_the_panel(empty_scene):
    morph = bake(use_custom_blur=True, blur=2.0, sharpness=0.25, use_custom_sharpness=True, frames=2, resolution=24)
    before = stored_morph(morph)
    bpy.context.scene.convwass_morph.resolution = 64
    bpy.context.scene.frame_start = 17
    bpy.ops.convwass.rebake_morph()
    after = stored_morph(morph)
    assert after.first_frame == before.first_frame
    same = {name: value for name, value in before.settings.items() if name not in ("start", "frame_start")}
    assert {name: after.settings[name] for name in same} == same


def test_a_player_keeps_its_keys(morph):
    bpy.ops.convwass.make_player(between="NEAREST")
    player = bpy.context.object
    keys = [key.co[:] for key in _curve(player).keyframe_points]
    shapes(morph)[0].scale.z = 2.0
    bpy.ops.convwass.rebake_morph()
    assert player.name in bpy.data.objects
    assert [key.co[:] for key in _curve(player).keyframe_points] == keys
    bpy.context.scene.frame_set(2)
    shown = triangle_mesh(player, bpy.context.evaluated_depsgraph_get())
    frame = triangle_mesh(frame_objects(morph)[1], bpy.context.evaluated_depsgraph_get())
    assert np.allclose(shown.bounds, frame.bounds, atol=0.01 * np.ptp(frame.bounds))


def _curve(player):
    from bpy_extras.anim_utils import action_get_channelbag_for_slot

    data = player.animation_data
    return action_get_channelbag_for_slot(data.action, data.action_slot).fcurves[0]


def test_a_player_keeps_its_materials_and_modifiers_and_is_active(morph):
    bpy.ops.convwass.make_player(between="NEAREST")
    player = bpy.context.object
    mine, other = bpy.data.materials.new("Mine"), bpy.data.materials.new("Other")
    before = list(player.data.materials)
    player.data.materials[0] = mine
    player.data.materials.append(other)
    player.material_slots[1].link = "OBJECT"
    player.material_slots[1].material = other
    player.modifiers.new("Wires", "WIREFRAME")
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert [(slot.link, slot.material.name) for slot in player.material_slots] == [
        ("DATA", "Mine"),
        ("OBJECT", "Other"),
        ("DATA", "Other"),
    ]
    assert len(before) == 2
    assert [modifier.name for modifier in player.modifiers] == ["Frames", "Wires"]
    assert bpy.context.object == player
    assert bpy.context.selected_objects == [player]


def files_in(folder):
    return [path for path in folder.rglob("*") if path.is_file()]


def shown_height(obj, frame):
    bpy.context.scene.frame_set(frame)
    return np.ptp(triangle_mesh(obj, bpy.context.evaluated_depsgraph_get()).bounds[:, 2])


@pytest.mark.parametrize(
    ("operator", "options"), [("make_volume", {}), ("make_cache", {"kind": "alembic"}), ("make_cache", {"kind": "usd"})]
)
def test_files_are_written_again_and_what_shows_them_is_kept(morph, tmp_path, operator, options):
    getattr(bpy.ops.convwass, operator)(folder=str(tmp_path), **options)
    shown = bpy.context.object
    files, height = {path: path.read_bytes() for path in files_in(tmp_path)}, shown_height(shown, 2)
    shown.data.materials.clear()
    shown.data.materials.append(bpy.data.materials.new("Lava"))
    shown.modifiers.new("Wires", "WIREFRAME")
    shown.modifiers["Wires"].show_viewport = False
    if operator == "make_volume":
        shown.modifiers["Volume to Mesh"].threshold = 0.4
        (volume,) = (obj for obj in bpy.data.objects if obj.type == "VOLUME")
        volume.location.x += 3.0
        place = volume.location.copy()
        volume.hide_set(False)
    modifiers = [modifier.name for modifier in shown.modifiers]
    for obj in shapes(morph):
        obj.scale.z = 2.0
    bpy.context.view_layer.update()
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert bpy.context.object == shown
    assert frame_objects(morph) == []
    # A saved version of the .blend file may show the old ones.
    assert files == {path: path.read_bytes() for path in files}
    assert len(files_in(tmp_path)) == 2 * len(files)
    assert shown_height(shown, 2) == pytest.approx(2 * height, rel=0.1)
    assert [material.name for material in shown.data.materials] == ["Lava"]
    assert [modifier.name for modifier in shown.modifiers] == modifiers
    if operator == "make_volume":
        assert shown.modifiers["Volume to Mesh"].threshold == pytest.approx(0.4)
        assert len(bpy.data.volumes) == 1
        assert volume.visible_get()
        # In Blender 4.5, it is half a cell beside its surface.
        assert (volume.location - place).length < 0.1
    else:
        assert len(bpy.data.cache_files) == 1


def test_a_morph_outside_the_view_layer_is_written_and_no_other_one(morph, tmp_path):
    bpy.ops.convwass.make_volume(folder=str(tmp_path))
    other = bake()
    kept = frame_objects(other)
    bpy.context.view_layer.layer_collection.children[morph.name].exclude = True
    bpy.context.view_layer.objects.active = kept[0]
    assert bpy.ops.convwass.rebake_morph(morphs=morph.name) == {"FINISHED"}
    assert frame_objects(other) == kept
    assert sorted(obj.type for obj in morph.objects) == ["MESH", "VOLUME"]
    assert len({path.parent for path in files_in(tmp_path)}) == 2


def test_where_files_cannot_be_written_again_what_shows_the_old_ones_is_kept(morph, tmp_path, monkeypatch, capfd):
    bpy.ops.convwass.make_volume(folder=str(tmp_path))
    shown = bpy.context.object
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "openvdb", None)
        assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    printed = capfd.readouterr().out
    assert "this Blender lacks" in printed
    assert f"{shown.name} still shows the last bake, beside the new meshes" in printed
    assert bpy.context.object == shown
    assert len(frame_objects(morph)) == 4
    assert bpy.ops.convwass.make_volume(folder=str(tmp_path)) == {"FINISHED"}
    assert bpy.context.object == shown
    assert frame_objects(morph) == []


def test_a_folder_that_is_missing_is_noticed_before_the_bake(morph, tmp_path):
    folder = tmp_path / "drive"
    bpy.ops.convwass.make_volume(folder=str(folder))
    folder.rename(tmp_path / "elsewhere")
    folder.write_text("")
    known = [*morph.objects]
    with pytest.raises(RuntimeError, match=f"cannot be written again, since {folder} is missing"):
        bpy.ops.convwass.rebake_morph()
    assert [*morph.objects] == known


@pytest.mark.parametrize("between", ["NEAREST", "INTERPOLATED"])
def test_a_pad_keeps_the_place_and_the_keys_of_its_handle(empty_scene, between):
    for x in (0.0, 3.0, 6.0):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    options = {"layout": "TRIANGLE", "steps": 2, "output": "PLAYER", "between": between}
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", resolution=16, **options)
    handle = bpy.context.object
    name = handle.name
    handle.location.x = 0.25
    for frame, height in ((1, 0.0), (9, 0.5)):
        handle.location.z = height
        handle.keyframe_insert("location", frame=frame)
    action = handle.animation_data.action.name
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    again = bpy.context.object
    assert (again.name, again.type) == (name, "EMPTY")
    assert [again.animation_data.action.name] == [action]
    bpy.context.scene.frame_set(9)
    assert again.location[:] == pytest.approx((0.25, 0.0, 0.5))


def test_deleted_shapes_are_named_and_the_morph_is_kept(morph):
    kept, gone = frame_objects(morph), shapes(morph)[0].name
    bpy.data.objects.remove(bpy.data.objects[gone])
    bpy.context.view_layer.objects.active = kept[0]
    with pytest.raises(RuntimeError, match=gone):
        bpy.ops.convwass.rebake_morph()
    assert frame_objects(morph) == kept


def test_shapes_that_only_the_list_refers_to_count_as_deleted(morph):
    """Deleted as a user does it: an object that something refers to remains in the file for a while."""
    bpy.context.view_layer.objects.active = frame_objects(morph)[0]
    gone = shapes(morph)[1]
    item = bpy.context.scene.convwass_morph.inputs.add()
    item.object = gone
    for collection in gone.users_collection:
        collection.objects.unlink(gone)
    assert gone.name in bpy.data.objects
    assert changed_inputs(morph) == [gone.name]
    for operator in (bpy.ops.convwass.rebake_morph, bpy.ops.convwass.select_morph_inputs):
        with pytest.raises(RuntimeError, match=f"was baked from {gone.name}, which no longer exists under that name"):
            operator()
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}


@pytest.fixture
def heroes(empty_scene, tmp_path):
    """A local cube and a linked sphere of the same name, in this order."""
    library = tmp_path / "library.blend"
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
    bpy.context.object.name = "Hero"
    bpy.ops.wm.save_as_mainfile(filepath=str(library))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.mesh.primitive_cube_add(location=(4, 0, 0))
    local = bpy.context.object
    local.name = "Hero"
    linked = linked_object(library, "Hero")
    for obj in (local, linked):
        obj.select_set(True)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=3, resolution=24)
    return local, linked


def test_a_linked_shape_is_told_from_a_local_one_of_its_name(heroes):
    local, linked = heroes
    morph = bpy.context.object.users_collection[0]
    assert (morph.name, stored_morph(morph).objects) == ("Morph Hero to Hero", [local, linked])
    ends = [len(frame_objects(morph)[place].data.vertices) for place in (0, -1)]
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert [len(frame_objects(morph)[place].data.vertices) for place in (0, -1)] == ends == [8, 42]
    assert bpy.ops.convwass.select_morph_inputs() == {"FINISHED"}
    assert set(bpy.context.selected_objects) == {local, linked}
    bpy.context.view_layer.objects.active = frame_objects(morph)[0]
    bpy.ops.convwass.delete_morph()
    assert not (local.hide_get() or linked.hide_get())


def test_a_linked_shape_that_was_made_local_or_moved_is_found(heroes, tmp_path):
    local, linked = heroes
    morph = bpy.context.object.users_collection[0]
    linked.library.filepath = str(tmp_path / "moved.blend")
    assert stored_morph(morph).objects == [local, linked]
    linked.make_local()
    # The local one has taken a number.
    assert stored_morph(morph).objects == [local, None]
    local.name = "Other"
    linked.name = "Hero"
    assert stored_morph(morph).objects == [linked, None]
    assert objects_named([ObjectName("Hero", "//library.blend")]) == [linked]


def test_a_morph_of_an_earlier_version_finds_its_shapes_by_name(morph):
    before = shapes(morph)
    data = json.loads(morph["convwass_morph"])
    del data["libraries"]
    morph["convwass_morph"] = json.dumps(data)
    assert stored_morph(morph).objects == before
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}


@pytest.mark.parametrize("libraries", ["", ["a"], [1, 2], None])
def test_damaged_libraries_are_refused_in_words(morph, libraries):
    data = json.loads(morph["convwass_morph"])
    data["libraries"] = libraries
    morph["convwass_morph"] = json.dumps(data)
    with pytest.raises(RuntimeError, match=r"Error: The settings stored on .* are damaged"):
        bpy.ops.convwass.rebake_morph()


@pytest.fixture
def linked_morph(empty_scene, tmp_path):
    """A linked morph, beside a local one of its name."""
    bake()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    name = bake().name
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.collections = [name]
    bpy.context.scene.collection.children.link(wanted.collections[0])
    return wanted.collections[0]


def test_a_linked_morph_is_not_baked_again(linked_morph):
    local = bpy.data.collections[linked_morph.name, None]
    kept = frame_objects(local)
    bpy.context.view_layer.objects.active = frame_objects(linked_morph)[0]
    with pytest.raises(RuntimeError, match=f"{local.name} is linked from another file; open that file"):
        bpy.ops.convwass.rebake_morph()
    assert frame_objects(local) == kept


def test_all_morphs_are_those_of_the_file(linked_morph):
    bpy.data.collections[linked_morph.name, None].name = "Own"
    kept = frame_objects(linked_morph)
    assert bpy.ops.convwass.rebake_morph(which="ALL") == {"FINISHED"}
    assert frame_objects(linked_morph) == kept


def test_spaces_around_names_belong_to_them(morph):
    first, second = shapes(morph)
    first.name, second.name = " A ", "B, left"
    for obj in (first, second):
        obj.hide_set(False)
    bpy.ops.convwass.bake_morph(inputs=" A \nB, left", motion="TRANSPORT", frames=2, resolution=16)
    again = bpy.context.object.users_collection[0]
    assert stored_morph(again).objects == [first, second]
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert stored_morph(again).objects == [first, second]


def test_one_undo_brings_the_old_frames_back(morph):
    name, width = morph.name, middle_width(morph)
    for obj in shapes(morph):
        obj.scale.z = 2.0
    bpy.ops.ed.undo_push(message="changed")
    bpy.ops.convwass.rebake_morph()
    bpy.ops.ed.undo_push(message="baked again")
    bpy.ops.ed.undo()
    assert middle_width(bpy.data.collections[name]) == pytest.approx(width, rel=1e-6)


def test_a_missing_morph_is_reported(empty_scene):
    with pytest.raises(RuntimeError, match="Bake a morph first"):
        bpy.ops.convwass.rebake_morph()


@pytest.mark.parametrize(
    ("name", "value"),
    [("resolution", "a"), ("blur", "much"), ("layout", "SPIRAL"), ("frames", [1, 2]), ("mend", 10**30)],
)
def test_damaged_settings_are_refused_in_words(morph, name, value):
    """Each is valid JSON, so that only the code using it can detect the error."""
    data = json.loads(morph["convwass_morph"])
    data["settings"][name] = value
    morph["convwass_morph"] = json.dumps(data)
    known = len(bpy.data.objects)
    for operator in (bpy.ops.convwass.rebake_morph, bpy.ops.convwass.select_morph_inputs):
        with pytest.raises(RuntimeError, match=r"Error: The settings stored on .* are damaged"):
            operator()
    assert len(bpy.data.objects) == known


def test_settings_that_an_earlier_version_did_not_have_get_their_defaults(morph):
    data = json.loads(morph["convwass_morph"])
    assert data["settings"].pop("mend") is True
    morph["convwass_morph"] = json.dumps(data)
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    (again,) = (collection for collection in bpy.data.collections if "convwass_morph" in collection)
    assert json.loads(again["convwass_morph"])["settings"]["mend"] is True


def test_damaged_weights_are_refused_in_words(empty_scene):
    morph = bake(layout="BLEND")
    data = json.loads(morph["convwass_morph"])
    del data["records"][0]["weights"]
    data["settings"]["weights"] = [1.0]
    morph["convwass_morph"] = json.dumps(data)
    for operator in (bpy.ops.convwass.rebake_morph, bpy.ops.convwass.select_morph_inputs):
        with pytest.raises(RuntimeError, match=r"Error: The settings stored on .* are damaged"):
            operator()


TOP = [{"name": "top", "points": {"Icosphere": 3, "Icosphere.001": 5}}]


def heard_guides(monkeypatch):
    """Return a list that gets the guides of every bake as the solver is given them; the solver transports."""
    heard = []

    def transporting(inputs, blends, settings, control, **options):
        heard.append(list(inputs.guides))
        return morph_of_meshes(inputs, blends, replace(settings, motion="transport"), control, **options)

    monkeypatch.setattr(job, "morph", transporting)
    return heard


def stored_guides(morph):
    """Return the stored guides, of which all points have places."""
    stored = stored_morph(morph).settings["guides"]
    assert all(guide["places"].keys() == guide["points"].keys() for guide in stored)
    return [{name: guide[name] for name in ("name", "points")} for guide in stored]


def test_guides_of_the_argument_are_stored_and_used_again(empty_scene, monkeypatch):
    heard = heard_guides(monkeypatch)
    morph = bake(guides=json.dumps(TOP), motion="GUIDED")
    name = morph.name
    assert stored_guides(morph) == TOP
    # Those of the scene are for new morphs.
    bpy.ops.convwass.add_morph_guide(points='{"Icosphere": 0, "Icosphere.001": 0}')
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert stored_guides(bpy.data.collections[name]) == TOP
    assert heard == [[{0: 3, 1: 5}]] * 2


def test_guides_of_the_list_are_stored_and_used_again(empty_scene, monkeypatch):
    heard = heard_guides(monkeypatch)
    morph = bake()
    assert stored_guides(morph) == []
    for label, vertices in (("top", (3, 5)), ("", (7, 8))):
        points = dict(zip(stored_morph(morph).inputs, vertices, strict=True))
        bpy.ops.convwass.add_morph_guide(label=label, points=json.dumps(points))
    bpy.ops.convwass.select_morph_inputs()
    bpy.ops.convwass.bake_morph(motion="GUIDED", frames=2, resolution=16)
    guided = next(c for c in bpy.data.collections if "convwass_morph" in c and c != morph)
    name = guided.name
    assert stored_guides(guided) == [*TOP, {"name": "2", "points": {"Icosphere": 7, "Icosphere.001": 8}}]
    bpy.ops.convwass.clear_morph_guides()
    assert bpy.ops.convwass.rebake_morph(morphs=name) == {"FINISHED"}
    assert heard == [[], *[[{0: 3, 1: 5}, {0: 7, 1: 8}]] * 2]
    # Without them, wrong ones could not be removed.
    for _ in range(2):
        bpy.context.view_layer.objects.active = frame_objects(bpy.data.collections[name])[0]
        bpy.ops.convwass.select_morph_inputs()
    found = [dict(guide.points) for guide in bpy.context.scene.convwass_guides.named]
    assert found == [guide["points"] for guide in stored_guides(bpy.data.collections[name])]


def test_morphs_without_a_stored_motion_stay_transported(morph, monkeypatch):
    data = json.loads(morph["convwass_morph"])
    for name in ("motion", "coherence", "guides"):
        del data["settings"][name]
    morph["convwass_morph"] = json.dumps(data)
    bpy.context.scene.convwass_morph.motion = "WARP"
    name = morph.name
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    again = stored_morph(bpy.data.collections[name]).settings
    assert (again["motion"], again["guides"]) == ("transport", [])


def test_a_guide_on_a_missing_vertex_is_refused_and_the_morph_kept(empty_scene, monkeypatch):
    heard_guides(monkeypatch)
    guides = [{"name": "top", "points": {"Icosphere": 40, "Icosphere.001": 5}}]
    morph = bake(guides=json.dumps(guides), motion="GUIDED")
    before = morph["convwass_morph"], [obj.name for obj in frame_objects(morph)]
    name, (first, _) = morph.name, shapes(morph)
    bpy.ops.mesh.primitive_cube_add()
    first.data = bpy.context.object.data
    bpy.context.view_layer.objects.active = frame_objects(morph)[0]
    with pytest.raises(RuntimeError, match="Guide top refers to vertex 40 of Icosphere, which has 8 vertices"):
        bpy.ops.convwass.rebake_morph()
    morph = bpy.data.collections[name]
    assert (morph["convwass_morph"], [obj.name for obj in frame_objects(morph)]) == before


@pytest.mark.parametrize("grouping", ["PARENTS", "COLLECTIONS"])
@pytest.mark.parametrize("output", ["OBJECTS", "PLAYER"])
def test_a_morph_beside_its_shape_is_no_part_of_it(empty_scene, grouping, output):
    home, root = bpy.data.collections.new("Hero"), bpy.data.objects.new("Root", None)
    empty_scene.collection.children.link(home)
    home.objects.link(root)
    morph = bake(grouping=grouping, output=output, between="NEAREST")
    body = shapes(morph)[0]
    body.parent = root
    home.objects.link(body)
    bpy.context.view_layer.update()
    bpy.ops.convwass.rebake_morph()
    width = middle_width(morph)
    for obj in morph.objects:
        obj.parent = root
    empty_scene.collection.children.unlink(morph)
    home.children.link(morph)
    empty_scene.frame_set(4)
    assert changed_inputs(morph) == []
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert middle_width(morph) == pytest.approx(width)
    assert not any(obj.hide_get() for obj in morph.objects)


def test_a_linked_morph_beside_objects_with_the_names_of_its_shapes_is_a_part(morph, tmp_path):
    names, path = stored_morph(morph).inputs, str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    home = bpy.data.collections.new("Hero")
    bpy.context.scene.collection.children.link(home)
    with bpy.data.libraries.load(path, link=True) as (source, loaded):
        loaded.collections = source.collections
    for collection in loaded.collections:
        home.children.link(collection)
    body = bpy.data.objects.new(names[0], bpy.data.meshes.new("Body"))
    home.objects.link(body)
    bpy.context.view_layer.update()
    assert len(shape_source(body, "COLLECTIONS").parts) == 2


def test_shapes_outside_the_view_layer_are_named(morph, capfd):
    first, second = shapes(morph)
    home = bpy.data.collections.new("Sources")
    bpy.context.scene.collection.children.link(home)
    home.objects.link(second)
    bpy.context.scene.collection.objects.unlink(second)
    bpy.context.view_layer.layer_collection.children["Sources"].exclude = True
    assert bpy.ops.convwass.select_morph_inputs() == {"FINISHED"}
    assert bpy.context.selected_objects == [first]
    assert f"Not in this view layer, so not selected: {second.name}" in capfd.readouterr().out


@pytest.mark.parametrize(
    ("how", "options"),
    [("LINK", {}), ("LINK", {"output": "SHAPE_KEYS"}), ("OVERRIDE", {}), ("INSTANCE", {})],
)
def test_shapes_of_a_missing_library_are_named(empty_scene, tmp_path, monkeypatch, how, options):
    guide_coarsely(monkeypatch)
    library, shot = tmp_path / "library.blend", tmp_path / "shot.blend"
    hero = bpy.data.collections.new("Hero")
    empty_scene.collection.children.link(hero)
    bpy.ops.mesh.primitive_cube_add()
    hero.objects.link(bpy.context.object)
    bpy.context.object.name = "Hero"
    bpy.ops.wm.save_as_mainfile(filepath=str(library))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.mesh.primitive_cube_add(location=(3, 0, 0))
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects, wanted.collections = ["Hero"], ["Hero"]
    shape = wanted.objects[0]
    if how == "INSTANCE":
        shape = bpy.data.objects.new("Instance", None)
        shape.instance_type, shape.instance_collection = "COLLECTION", wanted.collections[0]
    bpy.context.scene.collection.objects.link(shape)
    if how == "OVERRIDE":
        shape = shape.override_create(remap_local_usages=True)
    names = f"{shape.name}, {bpy.context.object.name}"
    bpy.ops.convwass.bake_morph(inputs=names, motion="TRANSPORT", frames=2, resolution=16, **options)
    bpy.ops.wm.save_as_mainfile(filepath=str(shot))
    library.rename(tmp_path / "moved.blend")
    bpy.ops.wm.open_mainfile(filepath=str(shot))
    with pytest.raises(RuntimeError, match=r"Error: (Hero|Cube) was not found in .*library\.blend; relocate"):
        bpy.ops.convwass.rebake_morph(which="ALL")
    with pytest.raises(RuntimeError, match=r"Error: (Hero|Cube) was not found in .*library\.blend; relocate"):
        bpy.ops.convwass.bake_morph(inputs=names)


@pytest.mark.parametrize("between", ["NEAREST", "INTERPOLATED"])
def test_a_morph_whose_player_was_deleted_is_kept_and_shown_again(morph, between):
    bpy.ops.convwass.make_player(between=between)
    bpy.ops.object.delete()
    assert bpy.ops.convwass.rebake_morph(morphs=morph.name) == {"FINISHED"}
    frames = frame_objects(morph)
    assert len(frames) == 4 and all(obj in set(morph.objects) for obj in frames)
    assert set(morph.all_objects) == set(frames)


@pytest.mark.parametrize("kind", ["PLAYER", "PAD"])
def test_what_only_an_instance_shows_remains(empty_scene, kind):
    """The collection of the morph is in no scene then, but in a collection that an Empty instances."""
    for x in (0.0, 3.0, 6.0):
        bpy.ops.mesh.primitive_cube_add(location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    options = {"layout": "TRIANGLE", "steps": 2} if kind == "PAD" else {"frames": 2, "between": "NEAREST"}
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", resolution=16, output="PLAYER", **options)
    shown = bpy.context.object
    morph, stage = shown_morph(shown), bpy.data.collections.new("Stage")
    empty_scene.collection.children.unlink(morph)
    stage.children.link(morph)
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", stage
    empty_scene.collection.objects.link(instance)
    there = set(stand_ins(morph)).intersection(morph.all_objects)
    shapes(morph)[0].scale.z = 2.0
    assert bpy.ops.convwass.rebake_morph(morphs=morph.name) == {"FINISHED"}
    assert set(stand_ins(morph)).intersection(morph.all_objects) == there
    assert not shows_frames(morph)


def test_a_player_whose_modifier_was_renamed_is_baked_again(morph):
    bpy.ops.convwass.make_player(between="NEAREST")
    player = bpy.context.object
    player.modifiers["Frames"].name = "Horse to Cow"
    for obj in shapes(morph):
        obj.scale.z = 2.0
    bpy.context.view_layer.update()
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert bpy.context.object == player
    assert bpy.ops.convwass.retime_player(style="LINEAR", frames=2) == {"FINISHED"}
    bpy.context.scene.frame_set(1)
    assert player.evaluated_get(bpy.context.evaluated_depsgraph_get()).dimensions.z == pytest.approx(4.0, rel=0.05)


def test_a_player_without_its_modifier_gives_way_to_the_frames(morph):
    bpy.ops.convwass.make_player(between="NEAREST")
    bpy.context.object.modifiers.clear()
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert set(morph.all_objects) == set(frame_objects(morph))
