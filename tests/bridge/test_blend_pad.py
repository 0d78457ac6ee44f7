# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A sheet as a pad: the blend at the empty is seen, wherever it and the pad are moved."""

from __future__ import annotations

import json
import subprocess
import sys
from functools import cache

import bpy
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from convwass_addon.applications.morphs.layouts import grid_blends, path_blends, single_blend, triangle_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.bridge.morphs.looks.frame_colors import COLOR
from convwass_addon.bridge.morphs.players.blend_pad import BlendPad, make_blend_pad
from convwass_addon.bridge.morphs.stand_ins import remove_stand_ins, shown_morph, shows_frames, stand_ins
from convwass_addon.bridge.morphs.stored import frame_objects, hidden_frames
from convwass_addon.bridge.object_names import without_number
from convwass_addon.errors import InputError

SHEETS = {"grid": grid_blends(4, 5), "triangle": triangle_blends(3, 4)}


@pytest.fixture
def bake(make_object, octahedron):
    """Give a function that bakes a sheet of shapes that stand apart, with the weights in the color."""

    def make(blends, count=None):
        shapes = [make_object(f"Shape {letter}") for letter in "ABCD"[: len(blends[0].weights)]]
        for place, shape in enumerate(shapes):
            shape.location = (5 * place, place, 0)
            shape.color = [float(place == channel) for channel in range(4)]
        made = MorphBake.begin(shapes, blends, {"resolution": 32}, 1)
        for blend in blends[:count]:
            middle = np.array(blend.weights) @ np.array([shape.location for shape in shapes])
            made.add(MorphFrame(blend, None if blend.source is not None else octahedron.moved(middle), {}))
        return made.finish(hide_inputs=True)

    return make


@pytest.fixture
def pads(bake):
    """Give a function that makes a pad of a kind, the same one at each call."""
    return cache(lambda kind: make_blend_pad(bake(SHEETS[kind])))


def result_mesh(made):
    bpy.context.view_layer.update()
    return made.result.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


def seen_weights(made):
    """The weights of the visible blend, encoded in its color."""
    return np.array(result_mesh(made).attributes[COLOR].data[0].color)


def place_at(made, point):
    """Put the empty at a point of the pad."""
    made.handle.location = point
    bpy.context.view_layer.update()


def place_on(made, x, z):
    """Put the empty at parts of the pad's side, from its bottom left."""
    points = np.array([vertex.co for vertex in made.pad.data.vertices])
    place_at(made, points.min(axis=0) + np.ptp(points[:, 0]) * np.array([x, 0, z]))


@pytest.mark.parametrize("kind", SHEETS)
def test_every_vertex_of_the_pad_shows_its_blend(bake, kind):
    made = make_blend_pad(bake(SHEETS[kind]))
    assert len(made.pad.data.vertices) == len(SHEETS[kind])
    for blend, vertex in zip(SHEETS[kind], made.pad.data.vertices, strict=True):
        place_at(made, vertex.co)
        np.testing.assert_allclose(seen_weights(made)[: len(blend.weights)], blend.weights, atol=1e-6)


def bilinear(x, z):
    return np.array([(1 - x) * z, x * z, (1 - x) * (1 - z), x * (1 - z)])


def barycentric(x, z):
    top = z / np.sqrt(0.75)
    return np.array([1 - top - (x - top / 2), x - top / 2, top])


@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
@pytest.mark.parametrize("kind", SHEETS)
@given(x=st.floats(0, 1), z=st.floats(0, 1))
def test_the_nearest_blend_is_seen(pads, kind, x, z):
    made = pads(kind)
    place_on(made, x, z)
    exact = (bilinear if kind == "grid" else barycentric)(x, z)
    found = seen_weights(made)[: len(exact)]
    steps = 4 if kind == "grid" else 3
    if exact.min() >= 0:
        # At most half a step along each side, and a corner of the hexagons around the blends of a triangle.
        assert np.abs(found - exact).max() <= (1.0 if kind == "grid" else 2 / 3) / steps + 1e-5
    else:
        assert found.min() <= 1e-6  # on the rim


def test_known_places(bake):
    made = make_blend_pad(bake(SHEETS["grid"]))
    assert made.handle.location.length == 0
    np.testing.assert_allclose(seen_weights(made), [0.25] * 4)
    place_on(made, 0.24, 1)
    np.testing.assert_allclose(seen_weights(made), [0.75, 0.25, 0, 0])
    place_on(made, 0.24, 0.01)
    np.testing.assert_allclose(seen_weights(made), [0, 0, 0.75, 0.25])


def test_known_places_in_the_triangle(bake):
    made = make_blend_pad(bake(SHEETS["triangle"]))
    np.testing.assert_allclose(seen_weights(made)[:3], [1 / 3] * 3, atol=1e-6)
    # The upper corners of its bounds are outside: the nearest blend of the rim is seen.
    for x, weights in ((0, (1 / 3, 0, 2 / 3)), (1, (0, 1 / 3, 2 / 3))):
        place_on(made, x, 1)
        np.testing.assert_allclose(seen_weights(made)[:3], weights, atol=1e-6)
    place_on(made, 0, 0)
    np.testing.assert_allclose(seen_weights(made)[:3], [1, 0, 0], atol=1e-6)


@pytest.mark.parametrize("kind", SHEETS)
def test_the_empty_stays_inside(bake, kind):
    made = make_blend_pad(bake(SHEETS[kind]))
    points = np.array([vertex.co for vertex in made.pad.data.vertices])
    for far in ((100, 5, 100), (-100, -5, -100)):
        place_at(made, far)
        inverse = made.pad.matrix_world.inverted()
        held = inverse @ made.handle.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world.translation
        limits = points.max(axis=0) if far[0] > 0 else points.min(axis=0)
        np.testing.assert_allclose(held, limits, atol=1e-5)


@pytest.mark.parametrize("kind", SHEETS)
def test_the_blend_stands_still_on_its_foot(bake, kind):
    made = make_blend_pad(bake(SHEETS[kind]))
    for vertex in made.pad.data.vertices:
        place_at(made, vertex.co)
        mesh = result_mesh(made)
        points = element_values(mesh.vertices, "co", 3)
        low, high = points.min(axis=0), points.max(axis=0)
        np.testing.assert_allclose([*(low + high)[:2] / 2, low[2]], 0, atol=1e-5)
    np.testing.assert_allclose(made.result.location, (0, 0, -1), atol=1e-6)


def test_pad_and_result_may_be_moved(bake):
    made = make_blend_pad(bake(SHEETS["grid"]))
    place_at(made, made.pad.data.vertices[7].co)
    before = seen_weights(made)
    made.pad.location, made.pad.rotation_euler, made.pad.scale = (3, 2, 1), (0.3, 1, 2), (2, 2, 2)
    made.result.location = (9, 9, 9)
    np.testing.assert_allclose(seen_weights(made), before)


def test_keys_on_the_empty_animate_the_blend(bake, bare_scene):
    made = make_blend_pad(bake(SHEETS["grid"]))
    for frame, vertex in ((1, 0), (9, 4)):
        made.handle.location = made.pad.data.vertices[vertex].co
        made.handle.keyframe_insert("location", frame=frame)
    found = []
    for frame in (1, 5, 9):
        bare_scene.frame_set(frame)
        found.append(seen_weights(made)[:2])
    np.testing.assert_allclose(found, [(1, 0), (0.5, 0.5), (0, 1)], atol=1e-6)


def test_it_names_the_shapes_and_renders_the_blend_alone(bake):
    collection = bake(SHEETS["triangle"])
    made = make_blend_pad(collection)
    assert sorted(obj.data.body for obj in bpy.data.objects if obj.type == "FONT") == ["Shape A", "Shape B", "Shape C"]
    meshes = [obj for obj in stand_ins(collection) if obj.type != "EMPTY" and not obj.hide_render]
    assert meshes == [made.result]
    assert hidden_frames(collection).hide_render
    assert hidden_frames(collection).hide_viewport
    drawn = {i.object.name for i in bpy.context.evaluated_depsgraph_get().object_instances}
    assert not drawn & {obj.name for obj in frame_objects(collection)}


def test_the_way_back(bake, inventory):
    collection = bake(SHEETS["grid"])
    before = inventory()
    shown = [obj.matrix_world.copy() for obj in frame_objects(collection)]
    made = make_blend_pad(collection)
    assert shown_morph(made.result) == collection
    remove_stand_ins(collection)
    # Blender's default font remains until the file is saved.
    assert {block for block in inventory() if block[0] != "FONT"} == before
    assert [obj.matrix_world for obj in frame_objects(collection)] == shown
    assert shows_frames(collection)


def test_other_objects_next_to_the_pad_are_kept(bake, make_object):
    collection = bake(SHEETS["grid"])
    made = make_blend_pad(collection)
    lamp = make_object("Mine")
    made.result.users_collection[0].objects.link(lamp)
    remove_stand_ins(collection)
    assert lamp.name in bpy.data.objects
    assert bpy.data.collections["Blend Pad Shape A and Shape B and Shape C and Shape D"].objects[:] == [lamp]


def test_the_corners_show_the_shapes_in_their_colors(bake):
    """Small, above the upper corners and below the lower ones."""
    made = make_blend_pad(bake(SHEETS["grid"]))
    (corners,) = (obj for obj in made.pad.children if obj.type == "MESH")
    mesh = corners.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    points = element_values(mesh.vertices, "co", 3)
    owner = element_values(mesh.attributes[COLOR].data, "color", 4).argmax(axis=1)
    frame = np.array([made.pad.data.vertices[corner].co for corner in (0, 4, 20, 24)])
    for place, corner in enumerate(frame):
        own = points[owner == place]
        middle = own.mean(axis=0)
        assert middle[0] == pytest.approx(corner[0], abs=1e-5)
        assert abs(own[:, 2]).min() > abs(corner[2])
        assert np.sign(middle[2]) == np.sign(corner[2])
        assert np.ptp(own[:, 0]) == pytest.approx(0.22 * np.ptp(frame[:, 0]), rel=1e-5)


def test_a_deleted_frame_only_leaves_a_gap(bake):
    collection = bake(SHEETS["grid"])
    made = make_blend_pad(collection)
    place = made.pad.data.vertices[7].co.copy()
    bpy.data.objects.remove(frame_objects(collection)[7])
    place_at(made, place)
    assert len(result_mesh(made).polygons) == 0
    place_at(made, made.pad.data.vertices[8].co)
    assert len(result_mesh(made).polygons) == 8


@pytest.mark.parametrize(
    ("blends", "count"),
    [(grid_blends(4, 3), 8), (triangle_blends(3, 3), 4), (path_blends(3, 2), None), (single_blend([1, 2, 1], 3), None)],
    ids=["grid", "triangle", "path", "single"],
)
def test_only_complete_sheets(bake, inventory, blends, count):
    collection = bake(blends, count)
    before = inventory()
    with pytest.raises(InputError, match="not a complete sheet"):
        make_blend_pad(collection)
    assert inventory() == before


def test_a_second_pad_is_refused(bake):
    """What is named is the blend, not one of the labels, whatever their names."""
    collection = bake(SHEETS["grid"])
    result = make_blend_pad(collection).result
    next(obj for obj in stand_ins(collection) if obj.type == "FONT").name = "A Label"
    with pytest.raises(InputError, match=f"already shown by {result.name};"):
        make_blend_pad(collection)


def test_it_works_in_a_blender_without_the_extension(bake, tmp_path):
    made = make_blend_pad(bake(SHEETS["grid"]))
    file, answer = tmp_path / "pad.blend", tmp_path / "found.json"
    places = [tuple(made.pad.data.vertices[place].co) for place in (0, 7, 24)]
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    script = (
        "import bpy, json, os\n"
        f"bpy.ops.wm.open_mainfile(filepath={str(file)!r}, use_scripts=False)\n"
        f"handle, result = bpy.data.objects[{made.handle.name!r}], bpy.data.objects[{made.result.name!r}]\n"
        "found = []\n"
        f"for place in {places}:\n"
        "    handle.location = place\n"
        "    bpy.context.view_layer.update()\n"
        "    mesh = result.evaluated_get(bpy.context.evaluated_depsgraph_get()).data\n"
        f"    found.append(mesh.attributes[{COLOR!r}].data[0].color[:])\n"
        f"open({str(answer)!r}, 'w').write(json.dumps(found))\n"
        "os._exit(0)\n"
    )
    session = subprocess.run([sys.executable, "-I", "-c", script], capture_output=True, text=True, timeout=300)
    assert session.returncode == 0, session.stdout + session.stderr
    expected = [SHEETS["grid"][place].weights for place in (0, 7, 24)]
    np.testing.assert_allclose(json.loads(answer.read_text()), expected, atol=1e-6)


def duplicates_of(objects, linked):
    """Duplicate some objects, as Shift+D and Alt+D do; return the duplicates in the order of the objects."""
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in objects)
    bpy.ops.object.duplicate(linked=linked)
    made = {without_number(new.name): new for new in bpy.context.selected_objects}
    return [made[without_number(obj.name)] for obj in objects]


@pytest.mark.parametrize("linked", [False, True])
def test_a_duplicated_pad_follows_its_own_handle(bake, linked):
    made = make_blend_pad(bake(SHEETS["grid"]))
    other = BlendPad(*duplicates_of([made.pad, made.handle, made.result], linked))
    assert other.handle.parent == other.pad
    place_on(other, 0, 1)
    other.pad.location.x += 50
    np.testing.assert_allclose(seen_weights(other), [1, 0, 0, 0])
    np.testing.assert_allclose(seen_weights(made), [0.25] * 4)


@pytest.mark.parametrize("linked", [False, True])
def test_duplicates_of_the_pad_alone_change_nothing(bake, linked):
    """The blend is that of the first pad, and follows that pad's handle alone."""
    made = make_blend_pad(bake(SHEETS["grid"]))
    pad, handle = duplicates_of([made.pad, made.handle], linked)
    (bare,) = duplicates_of([made.pad], linked)
    handle.location = made.pad.data.vertices[0].co
    pad.location.x = bare.location.x = 50
    np.testing.assert_allclose(seen_weights(made), [0.25] * 4)


def test_a_duplicated_blend_follows_the_same_handle(bake):
    made = make_blend_pad(bake(SHEETS["grid"]))
    (result,) = duplicates_of([made.result], False)
    other = BlendPad(made.pad, made.handle, result)
    place_on(made, 0, 1)
    np.testing.assert_allclose(seen_weights(other), [1, 0, 0, 0])
