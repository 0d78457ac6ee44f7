# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A morph in the scene: visibility over time, cleanup, and repetition."""

from __future__ import annotations

import json
from dataclasses import replace

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.layouts import grid_blends, path_blends, single_blend
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.bridge.files.output_paths import save_blend
from convwass_addon.bridge.keyframes import shown_during
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.bridge.morphs.looks.materials import MATERIAL_NAME
from convwass_addon.bridge.morphs.removal import remove_bake
from convwass_addon.bridge.morphs.stored import (
    MORPH_KEY,
    WEIGHTS_KEY,
    frame_objects,
    stored_inputs,
    stored_morph,
    stored_settings,
)
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.errors import ConvwassError, InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh

SETTINGS = {"frames": 4, "resolution": 64, "sharpness": None, "weights": [0.5, 0.5], "level": "volume"}
RECORD = {"iterations": 12, "converged": True, "error": 1e-3, "ratio": float("nan"), "history": [1.0, 2.0]}


@pytest.fixture
def inputs(make_object):
    """Give two objects: one red, apart from the origin and with a material of its own; one blue."""
    a, b = make_object("A"), make_object("B")
    a.location, b.location = (-5, 0, 1), (5, 0, 1)
    material = bpy.data.materials.new("Own")
    material.diffuse_color = (1, 0, 0, 1)
    if material.node_tree:
        material.node_tree.nodes.clear()
    a.data.materials.append(material)
    b.color = (0, 0, 1, 1)
    return [a, b]


@pytest.fixture
def morph_frames(octahedron):
    """Give a function that makes finished frames of blends."""

    def make(blends):
        return [
            MorphFrame(blend, None if blend.source is not None else octahedron.moved((0, 0, index)), RECORD)
            for index, blend in enumerate(blends)
        ]

    return make


@pytest.fixture
def baked(inputs, morph_frames):
    """Give a function that bakes blends, or only the first few of them."""

    def make(blends, count=None, first_frame=10, hide_inputs=True):
        bake = MorphBake.begin(inputs, blends, SETTINGS, first_frame)
        for frame in morph_frames(blends)[:count]:
            bake.add(frame)
        return bake.finish(hide_inputs=hide_inputs)

    return make


def visible(collection):
    return [obj.name for obj in collection.objects if not obj.hide_render and not obj.hide_viewport]


def visible_over_time(scene, collection):
    shown = {}
    for frame in range(5, 21):
        scene.frame_set(frame)
        assert all(obj.hide_render == obj.hide_viewport for obj in collection.objects)
        assert all(obj.hide_render != shown_during(obj, [frame])[0] for obj in collection.objects)
        shown[frame] = visible(collection)
    return shown


def expected_over_time(count):
    return {frame: [f"Morph {min(max(frame - 9, 1), count):04d}"] for frame in range(5, 21)}


def test_each_frame_shows_one_object(bare_scene, baked):
    collection = baked(path_blends(2, 4))
    assert collection.name == "Morph A to B"
    assert collection.name in bare_scene.collection.children
    assert bare_scene.frame_current == 10
    assert visible_over_time(bare_scene, collection) == expected_over_time(5)


def test_stopping_keeps_finished_frames(bare_scene, baked):
    collection = baked(path_blends(2, 4), count=3)
    assert visible_over_time(bare_scene, collection) == expected_over_time(3)
    assert len(stored_morph(collection).records) == 3


def test_a_frame_takes_the_place_of_its_preview(bare_scene, inputs, morph_frames, octahedron):
    blends = path_blends(2, 4)
    bake = MorphBake.begin(inputs, blends, SETTINGS, 10)
    for frame in morph_frames(blends):
        bake.preview(frame)
    collection = bare_scene.collection.children[0]
    assert visible_over_time(bare_scene, collection) == expected_over_time(5)
    previews = [obj.name for obj in frame_objects(collection)]
    bpy.data.objects.remove(frame_objects(collection)[2])
    for frame in morph_frames(blends):
        moved = frame.mesh and replace(frame, mesh=frame.mesh.moved((7, 0, 0)))
        bake.add(moved or frame)
    assert visible_over_time(bare_scene, bake.finish(hide_inputs=True)) == expected_over_time(5)
    assert [obj.name for obj in frame_objects(collection)] == previews
    assert all(obj.data.vertices[0].co.x == 8.0 for obj in frame_objects(collection)[1:-1])


def test_a_frame_that_comes_again_takes_the_place_of_the_one_before(bare_scene, inputs, morph_frames):
    blends = path_blends(2, 4)
    bake = MorphBake.begin(inputs, blends, SETTINGS, 10)
    frames = morph_frames(blends)
    for frame in frames:
        bake.add(frame)
    bake.add(replace(frames[2], mesh=frames[2].mesh.moved((7, 0, 0)), record={**RECORD, "found": {"handles": 3}}))
    collection = bake.finish(hide_inputs=True)
    assert visible_over_time(bare_scene, collection) == expected_over_time(5)
    assert [obj.data.vertices[0].co.x for obj in frame_objects(collection)[1:4]] == [1.0, 8.0, 1.0]
    assert len(stored_morph(collection).records) == 5


def test_previews_do_not_outlive_an_early_stop(bare_scene, inputs, morph_frames, inventory):
    before, blends = inventory(), path_blends(2, 4)
    for count in (0, 3):
        bake = MorphBake.begin(inputs, blends, SETTINGS, 10)
        for frame in morph_frames(blends):
            bake.preview(frame)
        for frame in morph_frames(blends)[:count]:
            bake.add(frame)
        if count:
            collection = bake.finish(hide_inputs=True)
            assert visible_over_time(bare_scene, collection) == expected_over_time(3)
            assert len(bpy.data.actions[0].slots) == 3
        else:
            with pytest.raises(ConvwassError, match="No frame was finished"):
                bake.finish(hide_inputs=True)
            assert inventory() == before


def test_frame_deleted_meanwhile_leaves_no_gap(bare_scene, inputs, morph_frames):
    blends = path_blends(2, 4)
    bake = MorphBake.begin(inputs, blends, SETTINGS, 10)
    objects = [bake.add(frame) for frame in morph_frames(blends)]
    bpy.data.objects.remove(objects[2])
    collection = bake.finish(hide_inputs=True)
    assert {len(names) for names in visible_over_time(bare_scene, collection).values()} == {1}
    bare_scene.frame_set(12)
    assert visible(collection) == ["Morph 0002"]


def test_ends_are_the_inputs_themselves(baked, inputs, depsgraph):
    first, *_, last = frame_objects(baked(path_blends(2, 4)))
    for end, shape in ((first, inputs[0]), (last, inputs[1])):
        mesh, original = triangle_mesh(end, depsgraph), triangle_mesh(shape, depsgraph)
        np.testing.assert_allclose(mesh.vertices, original.vertices, atol=1e-6)
        assert end.data != shape.data
    assert [material.name for material in first.data.materials] == ["Own"]
    assert [material.name for material in last.data.materials] == [MATERIAL_NAME]


def test_ends_are_as_they_were_at_the_beginning(inputs, morph_frames, depsgraph):
    blends = path_blends(2, 4)
    bake = MorphBake.begin(inputs, blends, SETTINGS, 10)
    inputs[0].location = (100, 0, 0)
    bpy.data.objects.remove(inputs[1])
    first, *_, last = [bake.add(frame) for frame in morph_frames(blends)]
    bake.finish(hide_inputs=True)
    assert triangle_mesh(first, depsgraph).bounds.mean(axis=0)[0] == pytest.approx(-5)
    assert triangle_mesh(last, depsgraph).bounds.mean(axis=0)[0] == pytest.approx(5)


def test_frames_have_positions_and_mixed_colors(baked):
    objects = frame_objects(baked(path_blends(2, 4)))
    assert [tuple(obj.location) for obj in objects] == [(0, 0, 0)] * 5
    assert [list(obj[WEIGHTS_KEY]) for obj in objects] == [[1 - t / 4, t / 4] for t in range(5)]
    np.testing.assert_allclose([obj.color for obj in objects], [(1 - t / 4, 0, t / 4, 1) for t in range(5)], atol=1e-6)
    assert {obj.data.materials[0].name for obj in objects[1:]} == {MATERIAL_NAME}
    assert len(bpy.data.actions) == 1


def test_inputs_are_hidden_when_asked(baked, inputs):
    baked(path_blends(2, 4), hide_inputs=False)
    assert not any(obj.hide_render or obj.hide_get() for obj in inputs)
    baked(path_blends(2, 4), hide_inputs=True)
    assert all(obj.hide_render and obj.hide_get() for obj in inputs)


def test_baking_again_from_hidden_inputs(baked, inputs, bare_scene):
    first = baked(path_blends(2, 4))
    inputs[0].hide_viewport = True
    second = baked(path_blends(2, 4))
    assert (first.name, second.name) == ("Morph A to B", "Morph A to B.001")
    assert [len(collection.objects) for collection in (first, second)] == [5, 5]
    assert [material.name for material in bpy.data.materials].count(MATERIAL_NAME) == 1
    assert len(bpy.data.materials) == 2


def test_shape_that_comes_twice_is_copied_once(inputs, morph_frames):
    a, b = inputs
    blends = path_blends(3, 2)
    bake = MorphBake.begin([a, b, a], blends, SETTINGS, 1)
    for frame in morph_frames(blends):
        bake.add(frame)
    assert bake.finish(hide_inputs=True).name == "Morph A to B to A"


def test_sheet_frames_are_arranged_in_a_grid(bare_scene, make_object, morph_frames):
    shapes = [make_object(name) for name in "ABCD"]
    for place, shape in enumerate(shapes):
        shape.location = (-7 * place, place, 0)
    blends = grid_blends(4, 3)
    bare_scene.frame_set(42)
    bake = MorphBake.begin(shapes, blends, SETTINGS, 1)
    frames = [frame for frame in morph_frames(blends) if frame.mesh is None]
    corners = np.array(
        [np.mean([v.co[:] for v in obj.data.vertices], axis=0) + obj.location for obj in map(bake.add, frames)]
    )
    step = 2 * 1.3 * 2
    np.testing.assert_allclose(corners, [[0, 0, 0], [step, 0, 0], [0, 0, -step], [step, 0, -step]], atol=1e-5)
    collection = bake.finish(hide_inputs=True)
    assert collection.name == "Morph A and B and C and D"
    assert len(visible(collection)) == 4
    assert not bpy.data.actions
    assert bare_scene.frame_current == 42


def test_single_blend_stays_in_place(baked):
    (obj,) = baked(single_blend([1, 1], 2)).objects
    assert tuple(obj.location) == (0, 0, 0)
    assert not obj.hide_render


@pytest.mark.parametrize(("faces", "corners"), [("TRIANGLES", [3] * 12), ("QUADS", [4] * 6), (None, [3] * 12)])
def test_frames_are_made_of_the_faces_asked_for(inputs, faces, corners):
    points = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    quads = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    cube = TriangleMesh.from_arrays(points, quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))
    blend = single_blend([0.5, 0.5], 2)[0]
    bake = MorphBake.begin(inputs, [blend], {**SETTINGS, **({"faces": faces} if faces else {})}, 1)
    bake.preview(MorphFrame(blend, cube, {}))
    mesh = bake.add(MorphFrame(blend, cube, RECORD)).data
    assert [len(polygon.vertices) for polygon in mesh.polygons] == corners
    assert not mesh.validate()
    mesh.calc_loop_triangles()
    assert len(mesh.loop_triangles) == 12
    bake.finish(hide_inputs=True)


def test_discard_leaves_nothing_behind(bare_scene, inputs, morph_frames, inventory):
    before, frames = inventory(), (bare_scene.frame_start, bare_scene.frame_end, bare_scene.frame_current)
    blends = path_blends(2, 4)
    for count in (0, 1, 4):
        bake = MorphBake.begin(inputs, blends, SETTINGS, 10)
        for frame in morph_frames(blends)[:count]:
            bake.add(frame)
        bake.discard()
        assert inventory() == before
        assert (bare_scene.frame_start, bare_scene.frame_end, bare_scene.frame_current) == frames
        assert not any(obj.hide_render for obj in inputs)


def test_finish_without_frames(inputs, inventory):
    before = inventory()
    bake = MorphBake.begin(inputs, path_blends(2, 4), SETTINGS, 10)
    with pytest.raises(ConvwassError, match="No frame was finished"):
        bake.finish(hide_inputs=True)
    assert inventory() == before


def test_unused_copies_do_not_stay(baked, inventory):
    before = {entry for entry in inventory() if entry[0] == "MESH"}
    baked(path_blends(2, 4), count=2)
    assert {name for kind, name in inventory() - before if kind == "MESH"} == {"A.001", "Morph 0002"}


@pytest.mark.parametrize("first_frame", [-2_000_000, 2_000_000])
def test_first_frame_out_of_range(inputs, inventory, first_frame):
    before = inventory()
    with pytest.raises(InputError, match="first frame"):
        MorphBake.begin(inputs, path_blends(2, 4), SETTINGS, first_frame)
    assert inventory() == before


def test_a_morph_ends_at_blenders_last_frame_at_the_latest(inputs, inventory):
    before = inventory()
    with pytest.raises(InputError, match=r"would end at frame 1048575, .* start at 1048570 at the latest"):
        MorphBake.begin(inputs, path_blends(2, 4), SETTINGS, 1_048_571)
    assert inventory() == before
    MorphBake.begin(inputs, path_blends(2, 4), SETTINGS, 1_048_570)


def test_input_without_faces_leaves_nothing_behind(inputs, make_object, inventory):
    empty = make_object("Empty", [], faces=[])
    before = inventory()
    with pytest.raises(InputError, match="Empty"):
        MorphBake.begin([*inputs, empty], path_blends(3, 4), SETTINGS, 1)
    assert inventory() == before


def test_collection_deleted_meanwhile(inputs, morph_frames, inventory):
    before = inventory()
    blends = path_blends(2, 4)
    bake = MorphBake.begin(inputs, blends, SETTINGS, 10)
    first, second, *_ = morph_frames(blends)
    bake.add(first)
    bpy.data.collections.remove(bpy.data.collections["Morph A to B"])
    with pytest.raises(ConvwassError, match="undone or deleted"):
        bake.add(second)
    with pytest.raises(ConvwassError, match="undone or deleted"):
        bake.finish(hide_inputs=True)
    bake.discard()
    assert inventory() == before


def test_undone_meanwhile(inputs, morph_frames, inventory):
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="Before")
    before = inventory()
    blends = path_blends(2, 4)
    bake = MorphBake.begin(inputs, blends, SETTINGS, 10)
    bake.add(morph_frames(blends)[0])
    bpy.ops.ed.undo_push(message="Something else")
    bpy.ops.ed.undo()
    with pytest.raises(ConvwassError, match="undone or deleted"):
        bake.add(morph_frames(blends)[1])
    bake.discard()
    assert inventory() == before


def test_undo_of_something_else_does_no_harm(inputs, morph_frames):
    blends = path_blends(2, 4)
    bake = MorphBake.begin(inputs, blends, SETTINGS, 10)
    frames = morph_frames(blends)
    for frame in frames[:3]:
        bake.add(frame)
    bpy.ops.ed.undo_push(message="Half way")
    bpy.context.scene.frame_end = 77
    bpy.ops.ed.undo_push(message="Something else")
    bpy.ops.ed.undo()
    for frame in frames[3:]:
        bake.add(frame)
    collection = bake.finish(hide_inputs=True)
    assert visible_over_time(bpy.context.scene, collection) == expected_over_time(5)
    assert bpy.data.objects["A"].hide_render


def test_survives_saving(baked, tmp_path):
    expected = [
        (obj.name, len(obj.data.vertices), list(obj[WEIGHTS_KEY])) for obj in frame_objects(baked(path_blends(2, 4)))
    ]
    save_blend(tmp_path / "morph.blend")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "morph.blend"))
    collection, scene = bpy.data.collections["Morph A to B"], bpy.context.scene
    objects = frame_objects(collection)
    assert [(obj.name, len(obj.data.vertices), list(obj[WEIGHTS_KEY])) for obj in objects] == expected
    assert visible_over_time(scene, collection) == expected_over_time(5)
    assert stored_settings(collection) == SETTINGS
    assert [obj.name for obj in stored_inputs(collection)] == ["A", "B"]
    assert stored_morph(collection).first_frame == 10


def test_records_are_summaries(baked):
    records = stored_morph(baked(path_blends(2, 4))).records
    assert records[1] == {"weights": [0.75, 0.25], "iterations": 12, "converged": True, "error": 1e-3, "ratio": None}


def damage(key, value):
    def change(data):
        data[key] = value

    return change


@pytest.mark.parametrize(
    "change",
    [
        damage("schema", 99),
        damage("inputs", []),
        damage("inputs", ["A", 3]),
        damage("settings", [1]),
        damage("settings", {"resolution": {"x": 1}}),
        damage("settings", {"sharpness": float("nan")}),
        damage("first_frame", 1.5),
        damage("first_frame", True),
        damage("first_frame", -2_000_000),
        damage("records", [1]),
        damage("per_second", 0.0),
        damage("per_second", "24"),
        lambda data: data.pop("settings"),
    ],
)
def test_damaged_settings(baked, change):
    collection = baked(path_blends(2, 4))
    data = json.loads(collection[MORPH_KEY])
    change(data)
    collection[MORPH_KEY] = json.dumps(data)
    with pytest.raises(InputError, match="Morph A to B are damaged"):
        stored_settings(collection)


@pytest.mark.parametrize("text", ["{", "[]", 7, ""])
def test_settings_that_are_no_settings(baked, text):
    collection = baked(path_blends(2, 4))
    collection[MORPH_KEY] = text
    with pytest.raises(InputError, match="damaged"):
        stored_inputs(collection)


def test_collection_that_is_no_morph():
    with pytest.raises(InputError, match="Props is not a morph"):
        stored_settings(bpy.data.collections.new("Props"))


def test_deleted_input(baked, inputs):
    collection = baked(path_blends(2, 4))
    inputs[1].name = "Renamed"
    with pytest.raises(InputError, match="baked from B"):
        stored_inputs(collection)


def test_remove_bake(bare_scene, baked, make_object, inventory):
    make_object("Mine")
    before = inventory()
    collection = baked(path_blends(2, 4))
    mine = bpy.data.objects["Mine"]
    collection.objects.link(mine)
    bare_scene.collection.objects.unlink(mine)
    child = bpy.data.collections.new("Child")
    collection.children.link(child)
    remove_bake(collection)
    assert inventory() - before == {("COLLECTION", "Child"), ("MATERIAL", MATERIAL_NAME)}
    assert "Mine" in bare_scene.collection.objects
    assert "Child" in bare_scene.collection.children
