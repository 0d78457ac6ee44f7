# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Players and pads as the panel and scripts call them, on real bakes."""

from __future__ import annotations

import sys

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.keyframes import curves_of, interpolate
from convwass_addon.bridge.morphs.players.pad_inputs import handle_velocities, handle_velocity
from convwass_addon.bridge.morphs.players.player_inputs import interpolation, is_player, morph_value, speed
from convwass_addon.bridge.morphs.stand_ins import shown_morph, stand_ins
from convwass_addon.bridge.morphs.stored import WEIGHTS_KEY, frame_objects
from convwass_addon.operators import morph_play
from convwass_addon.operators.morph_play import CONVWASS_OT_bake_player
from tests.operators.morphs import add, census
from tests.operators.running import ESCAPE, TIMER, Pressed, started, until, window_context, write_one_at_a_time

pytestmark = pytest.mark.usefixtures("empty_scene")


def add_shapes(count):
    for place, kind in enumerate(("cube", "uv_sphere", "torus", "cone")[:count]):
        add(kind, location=(3 * place, 0, 0))
    for obj in bpy.data.objects:
        obj.select_set(True)


def shown():
    """Names of the objects with faces that a viewport shows."""
    instances = bpy.context.evaluated_depsgraph_get().object_instances
    return [i.object.name for i in instances if i.object.type == "MESH" and i.object.data.polygons]


def bake_path():
    """Bake a path of two shapes."""
    add_shapes(2)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", resolution=20, frames=3)


def bake_sheet():
    """Bake a sheet of three shapes."""
    add_shapes(3)
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", resolution=20, layout="TRIANGLE", steps=3)


def play_path():
    bake_path()
    assert bpy.ops.convwass.make_player() == {"FINISHED"}


def play_sheet():
    bake_sheet()
    assert bpy.ops.convwass.make_blend_pad() == {"FINISHED"}


def the_morph():
    (morph,) = (collection for collection in bpy.data.collections if "convwass_morph" in collection)
    return morph


@pytest.fixture
def path(empty_scene, scene_with):
    scene_with(bake_path)
    return the_morph()


@pytest.fixture
def player(empty_scene, scene_with):
    """A player of that path."""
    scene_with(play_path)
    return bpy.context.object


def test_without_openvdb_a_player_shows_the_nearest_blend(path, monkeypatch, capfd):
    monkeypatch.setitem(sys.modules, "openvdb", None)
    assert bpy.ops.convwass.make_player() == {"FINISHED"}
    assert is_player(bpy.context.object)
    assert "lacks" in capfd.readouterr().out
    # It needs no fields.
    assert not any(mesh.name.endswith("Fields") for mesh in bpy.data.meshes)


@pytest.fixture
def sheet(empty_scene, scene_with):
    scene_with(bake_sheet)
    return the_morph()


@pytest.fixture
def handle(empty_scene, scene_with):
    """The handle of a pad of that sheet."""
    scene_with(play_sheet)
    return bpy.context.object


def test_there_and_back(path):
    before = census()
    assert bpy.ops.convwass.make_player() == {"FINISHED"}
    player = bpy.context.object
    assert is_player(player)
    assert bpy.context.selected_objects == [player]
    for frame in range(-2, 9):
        bpy.context.scene.frame_set(frame)
        assert shown() == [player.name]
    assert bpy.ops.convwass.remove_player() == {"FINISHED"}
    assert census() == before
    assert bpy.context.object == frame_objects(path)[0]
    bpy.context.scene.frame_set(3)
    assert shown() == ["Morph 0003"]


def test_retimed_and_baked_at_another_rate(path):
    assert not bpy.ops.convwass.retime_player.poll()
    bpy.ops.convwass.make_player()
    player = bpy.context.object
    assert bpy.ops.convwass.retime_player(style="HOLD", frames=4, hold=2) == {"FINISHED"}
    assert bpy.ops.convwass.update_player_speed() == {"FINISHED"}
    assert bpy.ops.convwass.bake_player(rate=12.0) == {"FINISHED"}
    frames = frame_objects(bpy.context.object.users_collection[0])
    # Eight frames of 24 a second are four of 12 and the first one.
    assert len(frames) == 5
    assert player.hide_viewport
    weights = [obj["convwass_weights"][1] for obj in frames]
    assert np.allclose(weights, [0.0, 0.0, 0.5, 1.0, 1.0])


def test_by_arguments(path):
    bpy.ops.convwass.make_player(playback="LOOP", easing="SMOOTH", between="NEAREST")
    player = bpy.context.object
    sizes = []
    player.animation_data.action = None
    for value in (1 / 3, 4 / 3):
        morph_value(player).set(value)
        bpy.context.view_layer.update()
        sizes.append(len(player.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices))
    assert sizes[0] == sizes[1] == len(frame_objects(path)[1].data.vertices)


def test_a_player_that_goes_back_has_the_speed_of_the_way_back(path):
    bpy.ops.convwass.make_player(playback="PING_PONG", between="INTERPOLATED")
    found = []
    for frame in (2, 5, 8):
        bpy.context.scene.frame_set(frame)
        found.append(speed(bpy.context.object).get())
    assert np.allclose(found, [1.0, -1.0, 1.0], atol=1e-4)


def test_undo(path):
    bpy.ops.ed.undo_push(message="path")
    before = census()
    bpy.ops.convwass.make_player(between="NEAREST")
    bpy.ops.ed.undo_push(message="player")
    bpy.ops.ed.undo()
    assert census() == before
    bpy.context.scene.frame_set(2)
    assert shown() == ["Morph 0002"]
    bpy.ops.ed.redo()
    player = next(obj for obj in bpy.data.objects if is_player(obj))
    bpy.context.scene.frame_set(2)
    assert shown() == [player.name]


def test_a_pad(sheet):
    before = census()
    assert bpy.ops.convwass.make_blend_pad() == {"FINISHED"}
    assert bpy.context.object.type == "EMPTY"
    result = next(obj for obj in bpy.data.objects if obj.name.endswith("Blend"))
    assert result.name in shown()
    assert not set(shown()) & {obj.name for obj in frame_objects(sheet)}
    counts = set()
    bounds = np.array(bpy.context.object.parent.bound_box)
    for corner in bounds:
        bpy.context.object.location = corner
        bpy.context.view_layer.update()
        counts.add(len(result.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices))
    assert 8 in counts  # the cube itself
    assert bpy.ops.convwass.remove_player() == {"FINISHED"}
    assert census() == before
    assert len(shown()) == 6


def test_a_handle_without_its_limit_is_blurred(handle):
    handle.constraints.clear()
    for frame, x in ((1, 0.0), (5, 1.0)):
        handle.location.x = x
        handle.keyframe_insert("location", frame=frame)
    assert bpy.ops.convwass.update_pad_velocity() == {"FINISHED"}


def constrained(handle):
    """Let a handle take the place of an Empty that moves by 1 from frame 1 to 11."""
    guide = moved_by_keys(bpy.data.objects.new("Guide", None))
    bpy.context.scene.collection.objects.link(guide)
    copied = handle.constraints.new("COPY_LOCATION")
    copied.target, copied.target_space, copied.owner_space = guide, "WORLD", "LOCAL"
    guide.hide_viewport = True


def carried(handle):
    """Let a handle hang at an Empty that moves."""
    handle.parent = moved_by_keys(bpy.data.objects.new("Guide", None))
    bpy.context.scene.collection.objects.link(handle.parent)


def driven(handle):
    curve = handle.driver_add("location", 0)
    curve.driver.expression = "min(max(frame - 1, 0), 10) / 10"


def in_a_strip(handle):
    data = moved_by_keys(handle).animation_data
    data.nla_tracks.new().strips.new("Move", 1, data.action)
    data.action = None


def moved_by_keys(obj):
    for frame, x in ((1, 0.0), (11, 1.0)):
        obj.location.x = x
        obj.keyframe_insert("location", frame=frame)
    interpolate(curves_of(obj))
    return obj


@pytest.mark.parametrize("move", [moved_by_keys, constrained, carried, driven, in_a_strip])
def test_a_handle_is_blurred_however_it_moves(handle, move):
    handle.parent.location, handle.location = (0, 0, 0), (0, 0, 0)
    handle.constraints.clear()
    move(handle)
    bpy.context.scene.frame_end = 12
    assert bpy.ops.convwass.update_pad_velocity() == {"FINISHED"}
    velocity, speeds = handle_velocity(the_morph(), None), []
    for frame in (1, 6, 12):
        bpy.context.scene.frame_set(frame)
        speeds.append(list(velocity.get()))
    expected = bpy.context.scene.render.fps / 10 * np.array([0.5, 1.0, 0.0])
    assert np.allclose(speeds, np.outer(expected, (1, 0, 0)), atol=1e-3)


def test_the_handle_of_a_duplicated_pad_is_blurred(handle):
    (velocity,) = handle_velocities(the_morph())
    pad, blend = handle.parent, velocity.modifier.id_data
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in (pad, handle, blend))
    bpy.ops.object.duplicate(linked=True)
    other = next(obj for obj in bpy.context.selected_objects if obj.type == "EMPTY")
    moved_by_keys(other)
    bpy.context.view_layer.objects.active = other
    assert bpy.ops.convwass.update_pad_velocity() == {"FINISHED"}
    first, second = (handle_velocity(the_morph(), obj) for obj in (handle, other))
    bpy.context.scene.frame_set(6)
    assert not any(first.get())
    assert second.get()[0] == pytest.approx(bpy.context.scene.render.fps / 10, abs=1e-3)


MAKING = [("path", morph_play.CONVWASS_OT_make_player), ("sheet", morph_play.CONVWASS_OT_make_blend_pad)]


@pytest.mark.parametrize(("count", "kind"), [(2, MAKING[0][1]), (3, MAKING[1][1])])
def test_escape_leaves_the_morph_as_it_was(count, kind):
    add_shapes(count)
    # Takes long enough to be stopped.
    bpy.ops.object.modifier_add(type="SUBSURF")
    bpy.context.object.modifiers[0].levels = 4
    layout = "PATH" if count == 2 else "TRIANGLE"
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", resolution=20, frames=3, layout=layout, steps=3)
    before, context = census(), window_context()
    pressed = Pressed(kind, between="INTERPOLATED")
    assert started(pressed, context)
    assert until(pressed, context, event=ESCAPE) == {"CANCELLED"}
    assert pressed.reports == [("INFO", "Stopped; nothing was changed")]
    assert census() == before


@pytest.mark.parametrize(("shown", "kind"), MAKING)
def test_fields_are_sampled_while_the_window_responds(request, shown, kind):
    request.getfixturevalue(shown)
    context = window_context()
    pressed = Pressed(kind, between="INTERPOLATED")
    assert started(pressed, context)
    assert until(pressed, context) == {"FINISHED"}
    assert any(interpolation(obj) for obj in stand_ins(the_morph()) if obj.modifiers)


def test_a_morph_that_is_deleted_meanwhile_gets_no_player(path):
    context, pressed = window_context(), Pressed(morph_play.CONVWASS_OT_make_player, between="INTERPOLATED")
    assert started(pressed, context)
    bpy.data.objects.remove(frame_objects(the_morph())[1])
    before = census()
    assert until(pressed, context) == {"CANCELLED"}
    assert "was deleted or changed during the computation" in pressed.reports[0][1]
    assert census() == before


def test_a_pad_without_its_handle_says_so(handle):
    pad = handle.parent
    bpy.data.objects.remove(handle)
    bpy.context.view_layer.objects.active = pad
    with pytest.raises(RuntimeError, match="has lost its handle; bake it again"):
        bpy.ops.convwass.update_pad_velocity()
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert any(obj.type == "EMPTY" for obj in bpy.data.objects)


def test_keys_are_not_set_in_tweak_mode(player):
    data = player.animation_data
    data.nla_tracks.new().strips.new("Play", 11, data.action)
    data.action, data.use_tweak_mode = None, True
    assert data.use_tweak_mode
    for name in ("retime_player", "update_player_speed"):
        with pytest.raises(RuntimeError, match="Leave tweak mode in the NLA editor first"):
            getattr(bpy.ops.convwass, name)()
    assert bpy.ops.convwass.bake_player() == {"FINISHED"}
    made = frame_objects(bpy.context.object.users_collection[0])
    assert [obj[WEIGHTS_KEY][1] for obj in made] == pytest.approx([0, 1 / 3, 2 / 3, 1])


@pytest.mark.parametrize("ends", ["stopped", "deleted"])
def test_baking_frames_leaves_nothing_if_it_does_not_end(player, ends, monkeypatch):
    bpy.context.scene.frame_set(2)
    context, before, known = window_context(), census(), player.name
    write_one_at_a_time(monkeypatch)
    pressed = Pressed(CONVWASS_OT_bake_player, rate=24.0)
    assert pressed._start(context) == {"RUNNING_MODAL"}
    assert pressed.modal(context, TIMER) == {"PASS_THROUGH"}
    assert census() != before
    if ends == "stopped":
        assert pressed.modal(context, ESCAPE) == {"CANCELLED"}
        assert census() == before
        assert not player.hide_viewport
    else:
        bpy.data.objects.remove(player)
        assert until(pressed, context) == {"CANCELLED"}
        assert set(before["objects"]) - set(census()["objects"]) == {known}
        assert not [mesh for mesh in bpy.data.meshes if mesh.name.startswith("Frame ")]
        assert pressed.reports == [("ERROR", "The player or its frames were deleted or undone meanwhile; start again.")]
    assert bpy.context.scene.frame_current == 2


def test_undo_of_a_pad(sheet):
    bpy.ops.ed.undo_push(message="sheet")
    before = census()
    bpy.ops.convwass.make_blend_pad(between="NEAREST")
    bpy.ops.ed.undo_push(message="pad")
    bpy.ops.ed.undo()
    assert census() == before


def test_each_refuses_the_work_of_the_other(path):
    with pytest.raises(RuntimeError, match="not a complete sheet"):
        bpy.ops.convwass.make_blend_pad()
    bpy.ops.convwass.make_player(between="NEAREST")
    with pytest.raises(RuntimeError, match="already"):
        bpy.ops.convwass.make_player()


def test_a_sheet_has_no_player(sheet):
    with pytest.raises(RuntimeError, match="make a blend pad instead"):
        bpy.ops.convwass.make_player()


def test_a_player_that_was_deleted_leaves_a_way_back(path):
    bpy.ops.convwass.make_player(between="NEAREST")
    bpy.data.objects.remove(bpy.context.object)
    bpy.context.view_layer.objects.active = None
    layer = bpy.context.view_layer.layer_collection.children[path.name]
    bpy.context.view_layer.active_layer_collection = layer
    assert bpy.ops.convwass.remove_player() == {"FINISHED"}
    assert shown() == ["Morph 0001"]


def test_polls_report_missing_input(path):
    with pytest.raises(RuntimeError, match="neither a player nor a blend pad"):
        bpy.ops.convwass.remove_player()
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Object Mode"):
        bpy.ops.convwass.make_player()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = bpy.data.objects["Cube"]
    for name in ("make_player", "make_blend_pad", "remove_player"):
        with pytest.raises(RuntimeError, match="Select an object of a baked morph"):
            getattr(bpy.ops.convwass, name)()


@pytest.mark.parametrize("name", ["make_player", "make_blend_pad", "remove_player"])
def test_everything_explains_itself(name):
    kind = getattr(bpy.ops.convwass, name).get_rna_type()
    texts = [kind.description, *(prop.description for prop in kind.properties if prop.identifier != "rna_type")]
    assert all(text and not text.endswith(".") for text in texts)


def linked(morph, path, how):
    """Save the file, and link a morph to a new one."""
    name = morph.name
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
        wanted.collections = [name]
    collection = wanted.collections[0]
    bpy.context.scene.collection.children.link(collection)
    if how == "overridden":
        collection = collection.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    bpy.context.view_layer.objects.active = next(obj for obj in collection.all_objects if obj.visible_get())
    return collection


def refused(operator, **options):
    """Return what a poll or an error says, after checking that nothing was changed."""
    before = {(block.id_type, block.name_full) for block in bpy.data.user_map()}
    with pytest.raises(RuntimeError) as raised:
        getattr(bpy.ops.convwass, operator)(**options)
    assert {(block.id_type, block.name_full) for block in bpy.data.user_map()} == before
    return str(raised.value)


@pytest.mark.parametrize("how", ["linked", "overridden"])
def test_a_linked_morph_is_not_changed(path, tmp_path, how):
    linked(path, tmp_path / "library.blend", how)
    folder = str(tmp_path / "files")
    for operator in ("make_player", "mark_morph_asset", "delete_morph", "make_volume", "make_cache"):
        options = {"folder": folder} if operator in ("make_volume", "make_cache") else {}
        assert "The morph is linked from another file" in refused(operator, **options)
    assert not (tmp_path / "files").exists()


@pytest.mark.parametrize("how", ["linked", "overridden"])
@pytest.mark.usefixtures("player")
def test_a_linked_player_is_shown_as_it_is(tmp_path, how):
    morph = linked(the_morph(), tmp_path / "library.blend", how)
    player = bpy.context.object
    assert is_player(player)
    for operator in ("remove_player", "delete_morph"):
        assert "The morph is linked from another file" in refused(operator)
    for operator in ("retime_player", "update_player_speed"):
        assert "The keys are linked from another file" in refused(operator)
    assert bpy.ops.convwass.bake_player(rate=24.0) == {"FINISHED"}
    assert bpy.context.object.users_collection[0] != morph
    assert len(frame_objects(bpy.context.object.users_collection[0])) == 4


@pytest.mark.parametrize("how", ["linked", "overridden"])
@pytest.mark.usefixtures("player")
def test_what_a_linked_player_in_a_linked_set_shows_is_baked_to_the_scene(tmp_path, how):
    path, room = the_morph(), bpy.data.collections.new("Set")
    bpy.context.scene.collection.children.link(room)
    room.children.link(path)
    bpy.context.scene.collection.children.unlink(path)
    linked(room, tmp_path / "library.blend", how)
    assert bpy.ops.convwass.bake_player(rate=24.0) == {"FINISHED"}
    assert bpy.context.object.users_collection[0] in list(bpy.context.scene.collection.children)


def test_an_overridden_morph_is_not_baked_again(path, tmp_path):
    collection = linked(path, tmp_path / "library.blend", "overridden")
    assert "linked from another file" in refused("rebake_morph", morphs=collection.name)


@pytest.mark.usefixtures("handle")
def test_an_overridden_pad_with_keys_of_its_own_is_animated(tmp_path):
    pad = linked(the_morph(), tmp_path / "library.blend", "overridden")
    handle = next(obj for obj in pad.all_objects if obj.type == "EMPTY")
    bpy.context.view_layer.objects.active = handle
    for frame, place in ((1, 0.0), (10, 1.0)):
        handle.location.x = place
        handle.keyframe_insert("location", frame=frame)
    assert bpy.ops.convwass.update_pad_velocity() == {"FINISHED"}


@pytest.mark.usefixtures("handle")
def test_each_of_two_overrides_of_a_pad_belongs_to_its_own_morph_in_a_file_that_is_opened(tmp_path):
    name = the_morph().name
    linked(the_morph(), tmp_path / "library.blend", "overridden")
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.collections = [name]
    wanted.collections[0].override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    handles = [obj for obj in bpy.context.scene.objects if obj.type == "EMPTY" and obj.override_library]
    morphs = [next(own for own in bpy.data.collections if own in parents(handle)) for handle in handles]
    assert [shown_morph(handle) for handle in handles] == morphs
    assert len(set(morphs)) == 2
    for handle, morph in zip(handles, morphs, strict=True):
        assert len(stand_ins(morph)) > 4 and set(stand_ins(morph)) < set(morph.all_objects)
        bpy.context.view_layer.objects.active = handle
        for frame, place in ((1, 0.0), (10, 1.0)):
            handle.location.x = place
            handle.keyframe_insert("location", frame=frame)
        assert bpy.ops.convwass.update_pad_velocity() == {"FINISHED"}
        keyed = [obj for obj in bpy.data.objects if obj.animation_data and obj.animation_data.action]
        assert set(keyed) <= set(morph.all_objects)
        for obj in keyed:
            obj.animation_data_clear()


def parents(obj):
    """Return the morphs that contain an object."""
    return [own for own in bpy.data.collections if "convwass_morph" in own and obj in set(own.all_objects)]


@pytest.mark.parametrize("end", ["remove_player", "delete_morph"])
def test_a_mesh_that_a_copy_of_the_player_was_converted_to_is_kept(player, end):
    """As for a simulation."""
    bpy.ops.object.duplicate()
    bpy.ops.object.convert(target="MESH")
    mine = bpy.context.object
    mine.name = "Rigid"
    bpy.context.view_layer.objects.active = player
    assert getattr(bpy.ops.convwass, end)() == {"FINISHED"}
    assert bpy.data.objects.get("Rigid") == mine and len(mine.data.polygons)
    assert not any(is_player(obj) for obj in bpy.data.objects)
