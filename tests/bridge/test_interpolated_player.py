# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Players and pads between baked blends, against balls whose every moment is known."""

from __future__ import annotations

import json
import subprocess
import sys

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from skimage.measure import marching_cubes

from convwass_addon.applications.morphs.layouts import path_blends, triangle_blends
from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.morphs.looks.appearance import write_velocity
from convwass_addon.bridge.morphs.players.blend_pad import make_blend_pad
from convwass_addon.bridge.morphs.players.dense_bake import bake_player
from convwass_addon.bridge.morphs.players.pad_inputs import handle_velocity
from convwass_addon.bridge.morphs.players.pad_velocity import key_handle_velocity
from convwass_addon.bridge.morphs.players.player import make_player, refresh_player
from convwass_addon.bridge.morphs.players.player_inputs import detail, interpolation, is_player, morph_value, speed
from convwass_addon.bridge.morphs.stand_ins import remove_stand_ins
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_inputs import node_input
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import drained
from tests.moving_balls import CELLS, FIRST, FRAMES, TRAVEL, bake
from tests.shapes import ball, box, joined

STEPS = 6
"""Frames of the balls that part."""

READ = """
import bpy, numpy as np

def read(obj):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = obj.evaluated_get(depsgraph).data
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    mesh.calc_loop_triangles()
    faces = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", faces)
    return points.reshape(-1, 3).astype(float), faces.reshape(-1, 3)
"""
"""Defines `read`: the vertices and triangles that an object shows."""

exec(READ)


def shown(obj) -> TriangleMesh:
    bpy.context.view_layer.update()
    return TriangleMesh.from_arrays(*read(obj))  # noqa: F821


def attribute(obj, name, size):
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    values = np.empty(size * len(mesh.vertices), np.float32)
    mesh.attributes[name].data.foreach_get("vector" if size == 3 else "color", values)
    return values.reshape(-1, size)


def outside_balls(points, away):
    """Signed distance, positive outside, from two unit balls at -away and away on the X axis."""
    mirrored = np.concatenate([np.abs(points[..., :1]) - away, points[..., 1:]], axis=-1)
    return np.linalg.norm(mirrored, axis=-1) - 1.0


def two_balls(away) -> TriangleMesh:
    axes = [np.arange(-end, end, 0.07) for end in (2.6, 1.2, 1.2)]
    distance = outside_balls(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1), away)
    vertices, faces, _, _ = marching_cubes(distance, 0.0, spacing=(0.07,) * 3)
    return TriangleMesh.from_arrays(vertices + [axis[0] for axis in axes], faces)


def still_player(collection):
    """Make a player whose value has no keys."""
    return still(make_player(collection, between="INTERPOLATED"))


def still(player):
    player.animation_data.action = None
    return player


def test_a_moving_ball_is_at_its_position(player):
    still(player)
    cell = 2.0 / CELLS
    for value in (0.04, 0.5, 0.613):
        morph_value(player).set(value)
        mesh = shown(player)
        off = np.linalg.norm(mesh.vertices - (TRAVEL * value, 0, 0), axis=1) - 1.0
        assert np.abs(off).mean() <= 0.03 * cell
        assert np.abs(off).max() <= 0.08 * cell
        assert np.isclose(mesh.volume, 4.0 / 3.0 * np.pi, rtol=5e-3)
        assert np.allclose(mesh.vertices.mean(axis=0), (TRAVEL * value, 0, 0), atol=0.03 * cell)


def test_balls_of_a_tenth_of_a_millimeter_are_shown(make_object):
    """OpenVDB has no grids with cells as small as those of the fields."""

    def solved(weights):
        return ball(radius=1e-4, center=(1e-4 * weights[1], 0, 0), points=800)

    morph = bake(make_object, [solved((1, 0)), solved((0, 1))], path_blends(2, FRAMES), solved)
    player, cell = still_player(morph), 2e-4 / CELLS
    morph_value(player).set(0.5)
    off = np.linalg.norm(shown(player).vertices - (0.5e-4, 0, 0), axis=1) - 1e-4
    assert np.abs(off).max() <= 0.08 * cell


def test_velocity_is_that_of_the_moment(player):
    morph_value(still(player)).set(0.3)
    shown(player)
    pace = TRAVEL / FRAMES * bpy.context.scene.render.fps
    assert np.allclose(attribute(player, "velocity", 3), (pace, 0, 0), atol=0.02 * pace)
    speed(player).set(0.1)
    shown(player)
    assert np.allclose(attribute(player, "velocity", 3), (0.1 * pace, 0, 0), atol=0.002 * pace)


@pytest.mark.parametrize("between", ["INTERPOLATED", "NEAREST"])
def test_velocity_turns_and_grows_with_the_frames(moving, between):
    """As the velocity of any mesh, it is in local space of what shows the frames, whose own parent does not matter."""
    pace = TRAVEL / FRAMES * bpy.context.scene.render.fps
    for obj in (frames := frame_objects(moving))[1:-1]:
        write_velocity(obj.data, np.tile((pace, 0, 0), (len(obj.data.vertices), 1)))
    matrix = Matrix.Rotation(np.pi / 2, 4, "Z") @ Matrix.Diagonal((2, 1, 1, 1))
    for obj in frames:
        obj.matrix_world = matrix
    player = still(make_player(moving, between=between))
    player.matrix_world = Matrix.Rotation(1.0, 4, "X") @ Matrix.Scale(3, 4)
    value = 2.0 / FRAMES
    morph_value(player).set(value)
    mesh = shown(player)
    np.testing.assert_allclose(mesh.vertices.mean(axis=0), (0, 2 * TRAVEL * value, 0), atol=0.02)
    velocity = attribute(player, "velocity", 3)
    np.testing.assert_allclose(velocity, np.tile((0, 2 * pace, 0), (len(velocity), 1)), atol=0.05 * pace)


def test_a_growing_ball_moves_along_its_normals(bare_scene, make_object):
    def solved(weights):
        return ball(radius=weights[0] + 1.5 * weights[1], points=800)

    player = still_player(bake(make_object, [solved((1, 0)), solved((0, 1))], path_blends(2, FRAMES), solved))
    morph_value(player).set(0.4)
    mesh = shown(player)
    radii = np.linalg.norm(mesh.vertices, axis=1)
    assert np.allclose(radii, 1.2, atol=0.1 * 3.0 / CELLS)
    pace = 0.5 / FRAMES * bare_scene.render.fps
    expected = pace * mesh.vertices / radii[:, None]
    off = np.linalg.norm(attribute(player, "velocity", 3) - expected, axis=1)
    assert off.mean() <= 0.07 * pace
    assert off.max() <= 0.15 * pace


def test_shapes_themselves_and_the_nearest_blends_are_still_seen(player):
    frames = frame_objects(still(player).users_collection[0])
    for value, interpolates, expected in ((0.0, True, 0), (1.0, True, FRAMES), (0.53, False, round(0.53 * FRAMES))):
        morph_value(player).set(value)
        interpolation(player).set(interpolates)
        assert len(shown(player).vertices) == len(frames[expected].data.vertices)


def test_colors_are_mixed(moving):
    """Red is the share of the second shape, and green grows upwards."""
    for number, obj in enumerate(frame_objects(moving)[1:-1], start=1):
        colors = np.ones((len(obj.data.vertices), 4))
        colors[:, 0], colors[:, 1] = number / FRAMES, [0.5 + 0.5 * vertex.co.z for vertex in obj.data.vertices]
        obj.data.attributes.new("Color", "FLOAT_COLOR", "POINT").data.foreach_set("color", colors.ravel())
    player = still_player(moving)
    # Next to a shape, which has no such colors, those of the blend are seen.
    for value, red in ((0.45, 0.45), (0.05, 1.0 / FRAMES)):
        morph_value(player).set(value)
        height = shown(player).vertices[:, 2]
        found = attribute(player, "Color", 4)
        assert np.allclose(found[:, 0], red, atol=1e-3)
        assert np.allclose(found[:, 1], 0.5 + 0.5 * height, atol=0.03)


def flying_place(weights):
    """Where the small ball of `flying_balls` is."""
    return np.array((-1.5 + 3.0 * weights[1], 1.6, 0.0))


@pytest.fixture
def flying_balls(bare_scene, make_object):
    """Bake a small ball that flies past a large one, by five times its diameter per frame; shapes have no velocity."""

    def solved(weights):
        return joined(ball(points=800), ball(0.2, flying_place(weights), points=300))

    blends = path_blends(2, FRAMES)
    collection = bake(make_object, [solved((1, 0)), solved((0, 1))], blends, solved)
    pace = 3.0 / FRAMES * bare_scene.render.fps
    for obj in frame_objects(collection)[1:-1]:
        velocity = [(pace * (vertex.co.y > 1.2), 0.0, 0.0) for vertex in obj.data.vertices]
        obj.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", np.ravel(velocity))
    return collection


def small_ball(player, value):
    """Return the center of the small ball that a player shows at a value."""
    morph_value(player).set(value)
    points = shown(player).vertices
    return points[points[:, 1] > 1.2].mean(axis=0)


# Next to the shapes, the neighboring blend is moved.
FLYING_VALUES = (0.07, 0.5, 0.53, 0.9)


@pytest.mark.parametrize("rate", [24, 60])
def test_parts_that_move_by_more_than_they_are_thick_stay(flying_balls, bare_scene, rate):
    pace = 3.0 / FRAMES * bare_scene.render.fps
    bare_scene.render.fps = rate
    player = still_player(flying_balls)
    for value in FLYING_VALUES:
        assert np.allclose(small_ball(player, value), flying_place((1.0 - value, value)), atol=0.01)
        assert np.isclose(attribute(player, "velocity", 3)[:, 0].max(), pace)


def test_they_stay_between_frames_that_were_baked_at_another_rate(flying_balls):
    times = np.linspace(FIRST, FIRST + FRAMES, 2 * FRAMES + 1)
    player = still_player(drained(bake_player(make_player(flying_balls, between="INTERPOLATED"), times, FIRST)))
    for value in FLYING_VALUES:
        assert np.allclose(small_ball(player, value), flying_place((1.0 - value, value)), atol=0.01)


def test_custom_normals_are_taken_from_the_meshes(moving):
    """The upper half of the ball is shaded as if it were flat."""
    for obj in frame_objects(moving)[1:-1]:
        normals = np.array([vertex.co for vertex in obj.data.vertices]) - (TRAVEL * obj["convwass_weights"][1], 0, 0)
        normals[normals[:, 2] > 0.0] = (0.0, 0.0, 1.0)
        obj.data.attributes.new("custom_normal", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", normals.ravel())
    player = still_player(moving)
    morph_value(player).set(0.5)
    bpy.context.view_layer.update()
    mesh = player.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    for loop, normal in zip(mesh.loops, mesh.corner_normals, strict=True):
        if mesh.vertices[loop.vertex_index].co.z > 0.6:
            assert normal.vector.z > 0.99


def test_faces_have_the_materials_of_the_nearest_blend(moving):
    materials = [bpy.data.materials.new(name) for name in ("Above", "Below")]
    for obj in frame_objects(moving)[1:-1]:
        obj.data.materials.clear()
        for material in materials:
            obj.data.materials.append(material)
        for face in obj.data.polygons:
            face.material_index = int(face.center.z < 0.0)
    player = still_player(moving)
    morph_value(player).set(0.55)
    bpy.context.view_layer.update()
    mesh = player.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    for face in mesh.polygons:
        if abs(face.center.z) > 0.1:
            assert mesh.materials[face.material_index].name == ("Above" if face.center.z > 0 else "Below")


def test_all_that_was_made_is_removed_again(moving, inventory):
    before = inventory()
    make_player(moving, between="INTERPOLATED")
    remove_stand_ins(moving)
    assert inventory() == before


@pytest.mark.parametrize("kind", ["Object", "Collection"])
def test_an_appended_player_is_seen_alone(moving, tmp_path, kind):
    """What its nodes read remains hidden; Blender shows appended objects that are in no collection."""
    player = still_player(moving)
    morph_value(player).set(0.3)
    before = shown(player).vertices
    name = player.name if kind == "Object" else moving.name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "played.blend"))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.wm.append(directory=str(tmp_path / "played.blend" / kind) + "/", filename=name)
    (seen,) = [obj for obj in bpy.context.view_layer.objects if obj.visible_get()]
    assert is_player(seen)
    np.testing.assert_array_equal(shown(seen).vertices, before)


@pytest.mark.usefixtures("player")
def test_another_object_shows_the_moment(make_object):
    """The group of the player is an asset for any modifier stack."""
    (group,) = [tree for tree in bpy.data.node_groups if tree.asset_data is not None]
    other = make_object("Other")
    modifier = other.modifiers.new("Any", "NODES")
    modifier.node_group = group
    node_input(modifier, "Morph").set(0.37)
    assert np.allclose(shown(other).vertices.mean(axis=0), (TRAVEL * 0.37, 0, 0), atol=0.03 * 2.0 / CELLS)


def test_a_player_takes_new_frames(moving, inventory):
    player, before = still_player(moving), inventory()
    for obj in frame_objects(moving)[1:-1]:
        obj.data.transform(Matrix.Translation((0.0, 0.0, 3.0)))
        obj.data.update()
    refresh_player(moving)
    morph_value(player).set(0.5)
    assert np.isclose(shown(player).vertices[:, 2].mean(), 3.0, atol=0.05)
    assert len(inventory()) == len(before)


CHILD = (
    READ
    + """
import json, sys
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
player = next(obj for obj in bpy.data.objects if "Frames" in obj.modifiers and obj.users_scene)
found = []
for frame in map(float, sys.argv[2:]):
    bpy.context.scene.frame_set(int(frame), subframe=frame % 1)
    found.append(read(player)[0].tolist())
print("FOUND" + json.dumps(found) + "FOUND")
"""
)


def test_a_file_plays_elsewhere_where_balls_part(make_object, tmp_path):
    """Two balls come out of one another, in a Blender without the add-on: every moment is that of the balls."""

    def solved(weights):
        return two_balls(0.5 + 0.9 * weights[1])

    blends = path_blends(2, STEPS)
    collection = bake(make_object, [solved((1, 0)), solved((0, 1))], blends, solved)
    make_player(collection, between="INTERPOLATED")
    file = tmp_path / "played.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    moments = [1.4, 3.5, 4.5]
    command = [sys.executable, "-I", "-c", CHILD, str(file), *(str(FIRST + moment) for moment in moments)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    for moment, points in zip(moments, json.loads(done.stdout.split("FOUND")[1]), strict=True):
        away = 0.5 + 0.9 * moment / STEPS
        off = np.abs(outside_balls(np.array(points), away))
        assert off.mean() <= 0.05 * 4.8 / CELLS


def test_a_pad_mixes_three_blends(make_object):
    radii = np.array([1.0, 1.3, 0.7])

    def solved(weights):
        return ball(radius=float(radii @ weights), points=800)

    corners = [solved(row) for row in np.eye(3)]
    collection = bake(make_object, corners, triangle_blends(3, 4), solved)
    pad = make_blend_pad(collection, between="INTERPOLATED")
    points = np.array([vertex.co for vertex in pad.pad.data.vertices])
    last = [obj["convwass_weights"] for obj in frame_objects(collection)]
    ends = [next(i for i, own in enumerate(last) if own[shape] == 1.0) for shape in range(3)]
    for weights in ((0.2, 0.5, 0.3), (0.55, 0.15, 0.3)):
        pad.handle.location = np.asarray(weights) @ points[ends]
        mesh = shown(pad.result)
        middle = mesh.bounds.mean(axis=0)
        radius = float(radii @ weights)
        off = np.linalg.norm(mesh.vertices - middle, axis=1) - radius
        assert np.abs(off).mean() <= 0.05 * 2.6 / CELLS
        assert np.isclose(mesh.bounds[0, 2], 0.0, atol=0.1)


def test_a_moving_handle_gives_a_pad_its_velocity(bare_scene, make_object):
    """Balls that stand on the ground grow as the handle goes from one to the other."""
    radii = np.array([1.0, 1.3, 0.7])

    def solved(weights):
        return ball(radius=float(radii @ weights), points=800)

    collection = bake(make_object, [solved(row) for row in np.eye(3)], triangle_blends(3, 3), solved)
    pad = make_blend_pad(collection, between="INTERPOLATED")
    with pytest.raises(InputError, match="no keyframes"):
        key_handle_velocity(handle_velocity(collection, pad.result))
    points = np.array([vertex.co for vertex in pad.pad.data.vertices])
    rows = [obj["convwass_weights"] for obj in frame_objects(collection)]
    corners = points[[next(i for i, own in enumerate(rows) if own[shape] == 1.0) for shape in range(3)]]
    ends = np.array([(0.3, 0.5, 0.2), (0.2, 0.2, 0.6)])
    for frame, weights in ((1, ends[0]), (25, ends[1])):
        pad.handle.location = weights @ corners
        pad.handle.keyframe_insert("location", frame=frame)
    for curve in curves_of(pad.handle):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    key_handle_velocity(handle_velocity(collection, pad.result))
    bare_scene.frame_set(13)
    mesh = shown(pad.result)
    pace = radii @ (ends[1] - ends[0]) / 24 * bare_scene.render.fps
    radius = radii @ ends.mean(axis=0)
    expected = pace * ((mesh.vertices - (0.0, 0.0, radius)) / radius + (0.0, 0.0, 1.0))
    off = np.linalg.norm(attribute(pad.result, "velocity", 3) - expected, axis=1)
    assert off.mean() <= 0.1 * abs(pace)
    # A handle at rest has no velocity to be stored.
    bare_scene.frame_set(40)
    bpy.context.view_layer.update()
    evaluated = pad.result.evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert "velocity" not in evaluated.data.attributes
    # There and back again.
    bare_scene.frame_end = 80
    for curve in curves_of(pad.handle):
        curve.modifiers.new("CYCLES").mode_after = "MIRROR"
    key_handle_velocity(handle_velocity(collection, pad.result))
    for frame, direction in ((37, -1.0), (61, 1.0)):
        bare_scene.frame_set(frame)
        off = np.linalg.norm(attribute(pad.result, "velocity", 3) - direction * expected, axis=1)
        assert off.mean() <= 0.1 * abs(pace)


def test_moments_enclose_the_volume_of_their_blends(make_object):
    """Thin rods on a coarse grid, where surfaces drawn from mixed fields lose volume."""

    def solved(weights):
        return box((2.0, 0.35, 0.3 + 0.2 * weights[1]))

    blends = path_blends(2, FRAMES)
    player = still_player(bake(make_object, [solved((1, 0)), solved((0, 1))], blends, solved))
    for value, lays in ((0.3, True), (0.5, False)):
        morph_value(player).set(value)
        detail(player).set(lays)
        volume = 2.0 * 0.35 * (0.3 + 0.2 * value)
        assert shown(player).volume == pytest.approx(volume, rel=3e-3)
