# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A morph as one object: display by value and frame, without the add-on."""

from __future__ import annotations

import json
import subprocess
import sys

import bpy
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from convwass_addon.applications.morphs.layouts import path_blends, single_blend, triangle_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.bridge.morphs.looks.frame_colors import COLOR
from convwass_addon.bridge.morphs.players.player import make_player, pace, refresh_player
from convwass_addon.bridge.morphs.players.player_inputs import (
    MATERIAL,
    OVERRIDE,
    PLAYBACK,
    PLAYBACKS,
    is_player,
    morph_value,
)
from convwass_addon.bridge.morphs.players.retiming import keyed_span
from convwass_addon.bridge.morphs.removal import remove_bake
from convwass_addon.bridge.morphs.stand_ins import remove_stand_ins, show_frames, shown_morph, stand_ins
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_inputs import node_input
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.sequence import MODIFIER
from convwass_addon.errors import InputError

FIRST, STEPS = 10, 4
RISE = 1.0
"""The octahedra of the path rise by so much per blend."""

LOOK = """
import bpy, json, sys
import numpy as np

def seen():
    depsgraph = bpy.context.evaluated_depsgraph_get()
    drawn = []
    for instance in depsgraph.object_instances:
        if instance.object.type == "MESH" and instance.object.data.polygons:
            mesh, matrix = instance.object.data, np.array(instance.matrix_world)
            points = np.empty(3 * len(mesh.vertices), np.float32)
            mesh.vertices.foreach_get("co", points)
            drawn.append((points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3])[:, 2].mean())
    return [round(float(height), 3) for height in drawn]
"""
"""Defines `seen`: the mean height of every mesh with faces that the viewport shows."""

exec(LOOK)


@pytest.fixture
def collection(make_object, octahedron):
    """Bake octahedra that rise from 0 to 8 past three shapes, red, white and blue, from frame 10 to 18."""
    shapes = [make_object(name) for name in "ABC"]
    shapes[0].color, shapes[2].color = (1, 0, 0, 1), (0, 0, 1, 1)
    for height, shape in zip((0, 4, 8), shapes, strict=True):
        shape.location.z = height
    return bake(shapes, path_blends(3, STEPS), octahedron)


def bake(shapes, blends, octahedron, count=None):
    made = MorphBake.begin(shapes, blends, {"resolution": 32}, FIRST)
    for blend in blends[:count]:
        mesh = None if blend.source is not None else octahedron.moved((0, 0, RISE * (blend.frame or 0)))
        made.add(MorphFrame(blend, mesh, {}))
    return made.finish(hide_inputs=True)


def heights(frames):
    """What is seen at scene frames, which need not be whole."""
    found = []
    for frame in frames:
        bpy.context.scene.frame_set(int(np.floor(frame)), subframe=float(frame - np.floor(frame)))
        found.append(seen())  # noqa: F821
    return found


def evaluated(obj):
    bpy.context.view_layer.update()
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get())


def set_value(player, value):
    morph_value(player).set(value)
    player.animation_data.action = None
    bpy.context.view_layer.update()


def test_it_shows_the_same_as_the_objects(collection):
    frames = range(FIRST - 3, FIRST + 2 * STEPS + 4)
    before = heights(frames)
    player = make_player(collection)
    assert heights(frames) == before
    assert before[3:-3] == [[RISE * step] for step in range(2 * STEPS + 1)]
    assert is_player(player)
    assert shown_morph(player) == collection
    assert stand_ins(collection) == [player]


def test_a_player_keeps_the_time_of_frames_that_are_held(make_object, octahedron):
    shapes = [make_object(name) for name in "AB"]
    shapes[1].location.z = 2 * STEPS
    path = bake(shapes, path_blends(2, 2 * STEPS, 2), octahedron)
    frames = range(FIRST - 1, FIRST + 2 * STEPS + 2)
    before = heights(frames)
    player = make_player(path)
    assert keyed_span(player) == (FIRST, FIRST + 2 * STEPS)
    # Where a frame is held, the player may show the next one, which is as near.
    assert heights(frames)[1::2] == before[1::2]
    assert pace(player) == pytest.approx(1.0 / (2 * STEPS))


@pytest.mark.parametrize(("part", "steps"), [(0.0, 2), (0.3, 2), (0.45, 2), (0.55, 3), (0.9, 3)])
def test_between_frames_the_nearer_blend_is_seen(collection, part, steps):
    make_player(collection)
    assert heights([FIRST + 2 + part]) == [[RISE * steps]]


def test_slow_motion_and_time_remapping(collection, bare_scene):
    make_player(collection)
    bare_scene.render.frame_map_old, bare_scene.render.frame_map_new = 100, 200
    assert heights([2 * FIRST, 2 * FIRST + 1.5, 2 * FIRST + 4, 2 * (FIRST + 2 * STEPS)]) == [[0], [1], [2], [8]]


def test_easing(collection):
    make_player(collection, easing="SMOOTH")
    parts = np.arange(0, 2 * STEPS, 0.25)
    found = np.ravel(heights(FIRST + parts))
    legs, rest = np.divmod(parts / STEPS, 1.0)
    place = STEPS * (legs + (1.0 - np.cos(np.pi * rest)) / 2.0)
    assert np.abs(found - place).max() <= 0.501


def expected(playback, value, last=2.0):
    """Bring a value into the range of the shapes, in plain words of Python."""
    if playback == "ONCE" or 0 <= value <= last:
        return min(max(value, 0.0), last)
    if playback == "LOOP":
        return value % last
    return last - abs(value % (2 * last) - last)


@pytest.mark.parametrize("playback", PLAYBACKS)
@pytest.mark.parametrize("value", [-7.3, -2.0, -0.5, 0.0, 0.49, 1.0, 1.75, 2.0, 2.25, 3.3, 4.0, 5.5, 117.25])
def test_playback(collection, playback, value):
    player = make_player(collection, playback=playback)
    set_value(player, value)
    assert seen() == [RISE * round(STEPS * expected(playback, value))]  # noqa: F821


@pytest.mark.parametrize("playback", PLAYBACKS)
def test_the_playback_goes_on_before_and_after_the_keys(collection, playback):
    make_player(collection, playback=playback)
    # At the seam of a loop, either end is right.
    frames = [frame for frame in range(FIRST - 18, FIRST + 30) if playback != "LOOP" or (frame - FIRST) % (2 * STEPS)]
    wanted = [[RISE * round(STEPS * expected(playback, (frame - FIRST) / STEPS))] for frame in frames]
    assert heights(frames) == wanted


def test_easing_goes_on_with_the_playback(collection):
    make_player(collection, playback="LOOP", easing="SMOOTH")
    inside = FIRST + np.arange(1, 2 * STEPS)
    assert heights(inside + 2 * STEPS) == heights(inside - 2 * STEPS) == heights(inside)


@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(value=st.floats(-50, 50, width=32), playback=st.sampled_from(list(PLAYBACKS)))
def test_any_value_shows_one_of_the_nearest_blends(collection, value, playback):
    players = stand_ins(collection)
    player = players[0] if players else make_player(collection)
    node_input(player.modifiers[MODIFIER], PLAYBACK).set_item(tuple(PLAYBACKS.values()), PLAYBACKS[playback])
    set_value(player, value)
    (height,) = seen()  # noqa: F821
    # Single precision may take a place on the seam of a loop for the other end.
    place = STEPS * expected(playback, value)
    assert min(abs(height - place), abs(height - (place + 2 * STEPS)), abs(height - (place - 2 * STEPS))) < 0.501


def test_the_playback_can_be_changed_in_the_modifier(collection):
    player = make_player(collection)
    set_value(player, 2.5)
    assert seen() == [8]  # noqa: F821
    for playback, height in (("LOOP", 2), ("PING_PONG", 6), ("ONCE", 8)):
        node_input(player.modifiers[MODIFIER], PLAYBACK).set_item(tuple(PLAYBACKS.values()), PLAYBACKS[playback])
        bpy.context.view_layer.update()
        assert seen() == [height]  # noqa: F821


def test_it_moves_as_one_object_and_takes_modifiers(collection, bare_scene):
    player = make_player(collection)
    player.location = (0, 0, 100)
    player.modifiers.new("Subdivision", "SUBSURF").levels = 1
    assert heights([FIRST, FIRST + 3]) == [[100], [103]]
    assert len(evaluated(player).data.polygons) == 3 * 8


def test_moved_frame_objects_keep_their_place(collection):
    for obj in frame_objects(collection):
        obj.location.z = 20
    make_player(collection)
    assert heights([FIRST, FIRST + 3]) == [[20], [23]]


@pytest.mark.parametrize("between", ["NEAREST", "INTERPOLATED"])
def test_mirrored_frame_objects_point_outwards(collection, between):
    """Also between two of them."""
    for obj in frame_objects(collection):
        obj.scale.x = -1.0
    player = make_player(collection, between=between)
    for frame, subframe in ((FIRST + 3, 0.0), (FIRST + 3, 0.4)):
        bpy.context.scene.frame_set(frame, subframe=subframe)
        shown = triangle_mesh(player, bpy.context.evaluated_depsgraph_get())
        assert shown.volume == pytest.approx(4.0 / 3.0, rel=0.1)


def test_materials_and_colors_are_kept(collection):
    own = bpy.data.materials.new("Own")
    last = frame_objects(collection)[-1]
    last.data.materials.clear()
    last.data.materials.append(own)
    player = make_player(collection)
    found = {}
    for frame in (FIRST, FIRST + 2, FIRST + 2 * STEPS):
        bpy.context.scene.frame_set(frame)
        mesh = evaluated(player).data
        used = {mesh.materials[polygon.material_index] for polygon in mesh.polygons}
        found[frame] = [material.name for material in used], tuple(mesh.attributes[COLOR].data[0].color)
    assert found[FIRST] == (["Convwass Morph Player"], (1, 0, 0, 1))
    assert found[FIRST + 2] == (["Convwass Morph Player"], (1, 0.5, 0.5, 1))
    assert found[FIRST + 2 * STEPS][0] == ["Own"]
    assert [material.name for material in player.data.materials] == ["Convwass Morph Player", "Own"]
    copy = bpy.data.materials["Convwass Morph Player"]
    shader = next(node for node in copy.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    assert shader.inputs["Base Color"].links[0].from_node.attribute_name == COLOR


def test_one_material_for_all(collection):
    player = make_player(collection)
    gold = bpy.data.materials.new("Gold")
    node_input(player.modifiers[MODIFIER], MATERIAL).set(gold)
    node_input(player.modifiers[MODIFIER], OVERRIDE).set(True)
    mesh = evaluated(player).data
    assert {mesh.materials[polygon.material_index].name for polygon in mesh.polygons} == {"Gold"}


def test_attributes_come_along(collection):
    for obj in frame_objects(collection):
        velocity = obj.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
        velocity.data.foreach_set("vector", np.tile(np.float32([0, 0, 7]), len(obj.data.vertices)))
    mesh = evaluated(make_player(collection)).data
    assert {tuple(item.vector) for item in mesh.attributes["velocity"].data} == {(0, 0, 7)}


@pytest.mark.parametrize("count", [2, 4, 7])
def test_an_early_stop_plays_the_finished_frames(make_object, octahedron, count):
    shapes = [make_object(name) for name in "AB"]
    shapes[1].location.z = 8 * RISE
    collection = bake(shapes, path_blends(2, 8), octahedron, count)
    make_player(collection)
    frames = range(FIRST - 1, FIRST + 12)
    assert heights(frames) == [[RISE * min(max(frame - FIRST, 0), count - 1)] for frame in frames]


def test_missing_frames_are_bridged_by_their_neighbors(collection):
    bpy.data.objects.remove(frame_objects(collection)[3])
    make_player(collection)
    assert heights([FIRST + 2, FIRST + 2.8, FIRST + 3.2, FIRST + 4]) == [[2], [2], [4], [4]]


def test_renders_show_exactly_one_mesh(collection, bare_scene, tmp_path):
    """Octahedra above each other: of the whole column only one square of pixels is covered."""
    player = make_player(collection)
    bare_scene.render.engine = "CYCLES"
    bare_scene.cycles.samples, bare_scene.cycles.use_denoising = 1, False
    bare_scene.render.resolution_x, bare_scene.render.resolution_y = 4, 40
    bare_scene.render.film_transparent = True
    bare_scene.render.image_settings.file_format = "PNG"
    bare_scene.render.image_settings.color_mode = "RGBA"
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 10
    camera.location, camera.rotation_euler = (0, -20, 4), (np.pi / 2, 0, 0)
    bare_scene.collection.objects.link(camera)
    bare_scene.camera = camera
    assert player.name in bare_scene.objects
    for frame, middle in ((FIRST, 0), (FIRST + 5, 5)):
        bare_scene.frame_set(frame)
        bare_scene.render.filepath = str(tmp_path / "frame.png")
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(bare_scene.render.filepath)
        opaque = np.array(picture.pixels).reshape(40, 4, 4)[:, :, 3].max(axis=1) > 0.5
        bpy.data.images.remove(picture)
        rows = np.flatnonzero(opaque)
        # Four rows per unit, from -1 to 9.
        np.testing.assert_allclose((rows[[0, -1]] + [0, 1]) / 4 - 1, [middle - 1, middle + 1], atol=0.3)


@pytest.mark.parametrize("taken", ["removed", "again"])
def test_the_way_back(collection, inventory, taken):
    frames = range(FIRST - 1, FIRST + 10)
    before, shown = inventory(), heights(frames)
    make_player(collection)
    remove_stand_ins(collection)
    if taken == "again":
        make_player(collection)
        remove_stand_ins(collection)
    assert inventory() == before
    assert heights(frames) == shown


def test_the_way_back_with_nested_node_groups(make_object, octahedron, inventory):
    shapes = [make_object(name) for name in "AB"]
    path = bake(shapes, path_blends(2, 40), octahedron)
    before = inventory()
    make_player(path, between="INTERPOLATED")
    assert max(len(tree.nodes) for tree in bpy.data.node_groups if "Frames" in tree.name) < 40
    remove_stand_ins(path)
    assert inventory() == before


def test_the_way_back_after_the_player_was_deleted(collection):
    shown = heights([FIRST + 1])
    bpy.data.objects.remove(make_player(collection))
    assert seen() == []  # noqa: F821
    make_player(collection)
    assert heights([FIRST + 1]) == shown
    remove_stand_ins(collection)
    assert heights([FIRST + 1]) == shown


def test_a_linked_collection_plays_in_another_file(collection, tmp_path):
    make_player(collection)
    name, path = collection.name, str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {collection})
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.collections = [name]
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", wanted.collections[0]
    bpy.context.scene.collection.objects.link(instance)
    assert heights([FIRST, FIRST + 5]) == [[0], [5]]


def test_a_morph_whose_player_an_earlier_version_made_is_shown_again(collection, bare_scene):
    """The player is outside the morph's collection, which is hidden."""
    shown, player = heights([FIRST + 1]), make_player(collection)
    show_frames(collection)
    collection.hide_viewport = collection.hide_render = True
    collection.objects.unlink(player)
    bare_scene.collection.objects.link(player)
    assert heights([FIRST + 1]) == shown
    refresh_player(collection)
    remove_stand_ins(collection)
    assert heights([FIRST + 1]) == shown


def test_copies_play_on_their_own_and_go_with_the_morph(collection, bare_scene):
    player = make_player(collection)
    copy = player.copy()
    copy.location.z = 50
    bare_scene.collection.objects.link(copy)
    assert heights([FIRST + 2]) == [[2, 52]]
    assert set(stand_ins(collection)) == {player, copy}
    remove_stand_ins(collection)
    assert heights([FIRST + 2]) == [[2]]


def test_deleting_the_morph_first_leaves_an_empty_player(collection):
    player = make_player(collection)
    remove_bake(collection)
    # The player is gone with its morph, or else shows nothing.
    assert heights([FIRST, FIRST + 3]) == [[], []]
    assert "Morph A to B to C Player" not in bpy.data.objects or shown_morph(player) is None


def test_refresh_takes_new_objects_and_keeps_the_keys(collection, octahedron):
    player = make_player(collection)
    player.modifiers.new("Subdivision", "SUBSURF").levels = 1
    bpy.data.objects.remove(frame_objects(collection)[3])
    for obj in frame_objects(collection):
        obj.location.z = 30
    refresh_player(collection)
    assert heights([FIRST + 2, FIRST + 2.8, FIRST + 3.2]) == [[32], [32], [34]]
    assert len(player.modifiers) == 2
    assert len([material for material in bpy.data.materials if material.name.endswith("Player")]) == 1


def test_a_second_player_is_refused(collection):
    make_player(collection)
    with pytest.raises(InputError, match="is already shown by Morph A to B to C Player"):
        make_player(collection)


@pytest.mark.parametrize(
    ("blends", "message"),
    [
        (triangle_blends(3, 3), "no morph along a path; for a sheet make a blend pad instead"),
        (single_blend([1, 1, 1], 3), "consists of one mesh, so there is nothing to play; bake an animation"),
    ],
    ids=["sheet", "single"],
)
def test_only_paths_are_played(make_object, octahedron, blends, message, inventory):
    collection = bake([make_object(name) for name in "ABC"], blends, octahedron)
    before = inventory()
    with pytest.raises(InputError, match=message):
        make_player(collection)
    assert inventory() == before
    assert not collection.hide_render


def test_without_frames_there_is_nothing_to_play(collection):
    bpy.data.batch_remove(frame_objects(collection))
    with pytest.raises(InputError, match="contains no frames of a morph"):
        make_player(collection)


def test_unknown_inputs_are_named(collection):
    with pytest.raises(InputError, match="Frames of Morph A to B to C Player has no input Speed"):
        node_input(make_player(collection).modifiers[MODIFIER], "Speed")
    assert not is_player(None)
    assert not is_player(frame_objects(collection)[0])


def test_it_plays_in_a_blender_without_the_extension(collection, tmp_path):
    player = make_player(collection, playback="PING_PONG")
    player.name = 'A "strange" name'
    frames = [FIRST, FIRST + 1, FIRST + 2.6, FIRST + 8, FIRST + 30]
    here = heights(frames)
    file = tmp_path / "plain.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    script = (
        f"{LOOK}\n"
        f"bpy.ops.wm.open_mainfile(filepath={str(file)!r}, use_scripts=False)\n"
        "found = []\n"
        f"for frame in {frames}:\n"
        "    bpy.context.scene.frame_set(int(frame), subframe=frame % 1)\n"
        "    found.append(seen())\n"
        "assert not any(name.startswith('convwass_addon') for name in sys.modules)\n"
        f"open({str(tmp_path / 'found.json')!r}, 'w').write(json.dumps(found))\n"
        "import os; os._exit(0)\n"
    )
    answer = subprocess.run([sys.executable, "-I", "-c", script], capture_output=True, text=True, timeout=300)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert json.loads((tmp_path / "found.json").read_text()) == here
    assert "cycle" not in answer.stdout + answer.stderr
