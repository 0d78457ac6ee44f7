# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files contain what a player shows, and a player that was changed is kept."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.morphs.players.player_inputs import MATERIAL, OVERRIDE, is_player, morph_value
from convwass_addon.bridge.morphs.players.seen_frames import seen_frames, shows_as_baked
from convwass_addon.bridge.morphs.stand_ins import shown_morph
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_inputs import node_input
from convwass_addon.bridge.sequence import MODIFIER
from convwass_addon.errors import InputError
from convwass_addon.progress import drained
from tests.scene import height_at

pytestmark = pytest.mark.usefixtures("empty_scene")

WRITERS = [("make_volume", {}), ("make_cache", {"kind": "alembic"}), ("make_cache", {"kind": "usd"})]


def bake(**options):
    for name, height in (("A", 1.0), ("B", 2.0)):
        bpy.ops.mesh.primitive_cube_add(scale=(1, 1, height))
        bpy.context.object.name = name
    settings = {"motion": "TRANSPORT", "frames": 4, "resolution": 20, "start": "CUSTOM", "frame_start": 5}
    bpy.ops.convwass.bake_morph(**{"inputs": "A,B", **settings, **options})
    return bpy.context.object.users_collection[0]


def bake_player():
    bake(output="PLAYER")


@pytest.fixture
def player(empty_scene, scene_with):
    scene_with(bake_player)
    return bpy.context.object


@pytest.mark.parametrize(("operator", "options"), WRITERS)
def test_a_retimed_player_is_written_as_it_plays_and_kept(player, tmp_path, operator, options):
    bpy.ops.convwass.retime_player(style="HOLD", frames=4, hold=2)
    expected = [height_at(player, frame) for frame in range(5, 14)]
    keys = [point.co[:] for curve in curves_of(player) for point in curve.keyframe_points]
    assert getattr(bpy.ops.convwass, operator)(folder=str(tmp_path), **options) == {"FINISHED"}
    shown = bpy.context.object
    assert [height_at(shown, frame) for frame in range(5, 14)] == pytest.approx(expected, abs=0.3)
    assert height_at(shown, 7) == pytest.approx(height_at(shown, 5))
    assert height_at(shown, 13) == pytest.approx(height_at(shown, 11))
    assert is_player(player) and player.hide_viewport and player.hide_render
    assert keys == [point.co[:] for curve in curves_of(player) for point in curve.keyframe_points]


def test_frames_of_a_player_are_all_there_in_stretched_time(player):
    render = bpy.context.scene.render
    render.frame_map_old, render.frame_map_new = 100, 200
    expected = [height_at(player, frame) for frame in (10, 12, 14, 16, 18)]
    assert bpy.ops.convwass.bake_player(rate=24.0) == {"FINISHED"}
    made = frame_objects(bpy.context.object.users_collection[0])
    assert [obj.dimensions.z for obj in made] == pytest.approx(expected, abs=0.01)
    assert expected[-1] == pytest.approx(4.0)


@pytest.mark.parametrize(("operator", "options"), WRITERS)
def test_a_player_that_shows_the_bake_gives_way_to_files(player, tmp_path, operator, options):
    name = player.name
    assert getattr(bpy.ops.convwass, operator)(folder=str(tmp_path), **options) == {"FINISHED"}
    assert name not in bpy.data.objects
    assert not any("convwass_weights" in obj for obj in bpy.data.objects)


def test_what_counts_as_a_change(player):
    assert shows_as_baked(player)
    player.location.x = 1.0
    assert not shows_as_baked(player)
    player.location.x = 0.0
    modifier = player.modifiers.new("Wires", "WIREFRAME")
    assert not shows_as_baked(player)
    player.modifiers.remove(modifier)
    assert shows_as_baked(player)
    override = node_input(player.modifiers[MODIFIER], OVERRIDE)
    override.set(True)
    assert not shows_as_baked(player)
    override.set(False)
    player.material_slots[0].link = "OBJECT"
    assert not shows_as_baked(player)
    player.material_slots[0].link = "DATA"
    assert shows_as_baked(player)
    (curve,) = (own for own in curves_of(player) if own.data_path == morph_value(player).data_path)
    curve.keyframe_points[0].interpolation = "SINE"
    assert not shows_as_baked(player)
    player.animation_data_clear()
    assert not shows_as_baked(player)


def test_held_frames_are_those_of_a_player_without_moments_between_them():
    bake(output="PLAYER", frame_step=2, between="NEAREST")
    assert shows_as_baked(bpy.context.object)
    bpy.ops.convwass.remove_player()
    bpy.ops.convwass.make_player(between="INTERPOLATED")
    assert not shows_as_baked(bpy.context.object)


def test_a_retimed_player_is_exported_as_it_plays(player, tmp_path):
    bpy.ops.convwass.retime_player(style="HOLD", frames=4, hold=2)
    before = {block.name for block in bpy.data.user_map()}
    player.hide_set(True)
    assert bpy.ops.convwass.export_morph(filepath=str(tmp_path / "morph.obj")) == {"FINISHED"}
    assert len(list(tmp_path.glob("*.obj"))) == 9
    assert {block.name for block in bpy.data.user_map()} == before
    assert player.hide_get() and not player.hide_viewport


@pytest.mark.parametrize("place", ["modifier", "slot"])
def test_a_player_is_exported_with_the_material_that_it_shows(player, tmp_path, place):
    gold = bpy.data.materials.new("Gold")
    if place == "modifier":
        node_input(player.modifiers[MODIFIER], OVERRIDE).set(True)
        node_input(player.modifiers[MODIFIER], MATERIAL).set(gold)
    else:
        for slot in player.material_slots:
            slot.link, slot.material = "OBJECT", gold
    assert bpy.ops.convwass.export_morph(filepath=str(tmp_path / "morph.obj")) == {"FINISHED"}
    files = sorted(tmp_path.glob("*.obj"))
    assert len(files) == 5 and all("usemtl Gold" in file.read_text() for file in files)


def test_an_error_leaves_the_player_as_it_was(player, tmp_path, monkeypatch):
    from convwass_addon.bridge.morphs.disk import cache_output

    bpy.ops.convwass.retime_player(style="HOLD", frames=4, hold=2)
    before = {block.name for block in bpy.data.user_map()}
    monkeypatch.setattr(cache_output, "export_frames", lambda _, file, kind: file.write_bytes(b"no archive"))
    with pytest.raises(RuntimeError, match="would contain no animated mesh"):
        bpy.ops.convwass.make_cache(folder=str(tmp_path))
    assert {block.name for block in bpy.data.user_map()} == before
    assert not player.hide_viewport
    assert list(tmp_path.iterdir()) == []


def test_a_player_in_an_excluded_collection_is_named(player, tmp_path):
    bpy.ops.convwass.retime_player(style="HOLD", frames=4, hold=2)
    morph = shown_morph(player)
    bpy.context.view_layer.layer_collection.children[morph.name].exclude = True
    with pytest.raises(InputError, match=rf"{player.name} is not in the view layer ViewLayer.*include its collection"):
        drained(seen_frames(morph, player))
    bpy.context.view_layer.layer_collection.children[morph.name].exclude = False
    assert drained(seen_frames(morph, player)).player == player


def test_without_keys_there_is_nothing_to_write(player, tmp_path):
    player.animation_data_clear()
    with pytest.raises(RuntimeError, match="only one frame between the first key"):
        bpy.ops.convwass.make_volume(folder=str(tmp_path))
    assert is_player(player) and not player.hide_viewport


def test_a_pad_is_not_written(tmp_path):
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name = "C"
    bake(inputs="A,B,C", layout="TRIANGLE", steps=2, output="PLAYER", between="NEAREST")
    handle = bpy.context.object
    with pytest.raises(RuntimeError, match=f"the handle {handle.name}, which files cannot contain"):
        bpy.ops.convwass.make_volume(folder=str(tmp_path))
    assert handle.name in bpy.data.objects
    bpy.ops.convwass.remove_player()
    assert bpy.ops.convwass.make_volume(folder=str(tmp_path)) == {"FINISHED"}
    assert not any("convwass_weights" in obj for obj in bpy.data.objects)


def test_frames_of_a_player_are_not_solved_again(player, tmp_path):
    bpy.ops.convwass.retime_player(style="HOLD", frames=4, hold=2)
    bpy.ops.convwass.make_volume(folder=str(tmp_path))
    shown = bpy.context.object
    (volume,) = (obj for obj in bpy.data.objects if obj.type == "VOLUME")
    for which in ("ALL", "STALE"):
        bpy.ops.convwass.rebake_morph(which=which)
        assert volume.data.frame_duration == 9
    bpy.context.view_layer.objects.active = shown
    with pytest.raises(RuntimeError, match="bake Morph A to B again, then bake or write the frames of its player"):
        bpy.ops.convwass.rebake_morph()
    assert volume.data.frame_duration == 9
