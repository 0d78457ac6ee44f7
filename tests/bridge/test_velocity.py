# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur at a known speed, although every frame is another object with another topology."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import grid_blends, path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs.disk.exports import export_frames
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.looks.carrying import rates_of
from convwass_addon.bridge.morphs.players.player import make_player
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_trees import own_tree
from tests.pictures import pixels_in
from tests.shapes import ball

DISTANCE, STEPS, SHUTTER, RADIUS = 4.0, 4, 0.8, 0.5
PIXELS, WIDTH = 128, 8.0


def bake_a_moving_ball(scene, make_object, fps, fps_base=1.0, places=(-DISTANCE / 2, DISTANCE / 2), **settings):

    scene.render.fps, scene.render.fps_base = fps, fps_base
    inputs = []
    for number, place in enumerate(places):
        mesh = ball(RADIUS, (place, 0, 0), 400)
        inputs.append(make_object(f"Ball {number}", mesh.vertices, (), mesh.faces))
    job = MorphJob(
        inputs,
        path_blends(len(places), STEPS),
        MorphSettings(motion="transport", resolution=32, **settings),
        {},
        1,
    )
    for step in job.steps(computation=Computation(workers=1)):
        job.write(step)
    return job.finish(hide_inputs=True)


def velocity_of(mesh):
    values = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["velocity"].data.foreach_get("vector", values)
    return values.reshape(-1, 3)


def length_of_trace(scene, path):
    """Render black on white from above, and return over how many units of X anything is seen, about."""
    import bpy

    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", WIDTH
    camera.location.z = 10
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("White")
    own_tree(scene.world).nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    black = bpy.data.materials.new("Black")
    emission = own_tree(black).nodes.new("ShaderNodeEmission")
    emission.inputs["Strength"].default_value = 0
    output = next(node for node in black.node_tree.nodes if node.type == "OUTPUT_MATERIAL")
    black.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    scene.view_layers[0].material_override = black
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 64, False
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, SHUTTER
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = PIXELS, 16, 100
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "PNG", "16"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    seen = 1.0 - pixels_in(path, as_data=True)[7:9, :, 0].mean(axis=0)
    # Along the middle the ball is as wide as its diameter: the trace is a trapezoid of that area, and its variance is
    # that of the two boxes together.
    places = (np.arange(PIXELS) + 0.5) * WIDTH / PIXELS
    middle = np.average(places, weights=seen)
    variance = np.average((places - middle) ** 2, weights=seen)
    return np.sqrt(max(12 * variance - (2 * RADIUS) ** 2, 0.0))


@pytest.mark.parametrize(("fps", "fps_base"), [(24, 1.0), (48, 1.0), (30, 1.001)])
def test_velocity_is_in_units_per_second(bare_scene, make_object, fps, fps_base):
    frames = frame_objects(bake_a_moving_ball(bare_scene, make_object, fps, fps_base))
    expected = DISTANCE / STEPS * fps / fps_base
    for obj in frames[1:-1]:
        np.testing.assert_allclose(
            velocity_of(obj.data), np.tile([expected, 0, 0], (len(obj.data.vertices), 1)), atol=0.02 * expected
        )
    # At the ends it stands still.
    assert "velocity" not in frames[0].data.attributes
    assert "velocity" not in frames[-1].data.attributes


@pytest.mark.parametrize(("places", "speed"), [((-4, 0, 4), 1.0), ((-4, 0, -4), 0.0), ((-2, 0, 4), 0.75)])
def test_an_intermediate_shape_has_the_velocity_of_its_neighbors(bare_scene, make_object, places, speed):
    frames = frame_objects(bake_a_moving_ball(bare_scene, make_object, 24, places=places))
    np.testing.assert_allclose(velocity_of(frames[STEPS].data)[:, 0], 24 * speed, atol=0.5)
    np.testing.assert_allclose(velocity_of(frames[STEPS].data)[:, 1:], 0, atol=0.5)


@pytest.mark.parametrize("fps", [24, 48])
def test_cycles_blurs_a_moving_ball_by_its_way_in_the_shutter_time(bare_scene, make_object, tmp_path, fps):
    bake_a_moving_ball(bare_scene, make_object, fps)
    bare_scene.frame_set(1 + STEPS // 2)
    assert length_of_trace(bare_scene, tmp_path / "blur.png") == pytest.approx(SHUTTER * DISTANCE / STEPS, rel=0.05)


@pytest.mark.parametrize("turned", ["frames", "frames of a player", "player"])
def test_blur_turns_with_a_parent(bare_scene, make_object, tmp_path, turned):
    """Seen from above, the ball moves by half of its way."""
    import bpy

    collection = bake_a_moving_ball(bare_scene, make_object, 24)
    shown = frame_objects(collection)
    player = make_player(collection) if turned != "frames" else None
    parent = make_object("Parent")
    parent.hide_render = True
    parent.rotation_euler.y = np.pi / 3
    for obj in [player] if turned == "player" else shown:
        obj.parent = parent
    bpy.context.view_layer.update()
    bare_scene.frame_set(1 + STEPS // 2)
    trace = length_of_trace(bare_scene, tmp_path / "blur.png")
    assert trace == pytest.approx(0.5 * SHUTTER * DISTANCE / STEPS, rel=0.05)


def test_without_carrying_there_is_no_blur(bare_scene, make_object, tmp_path):
    bake_a_moving_ball(bare_scene, make_object, 24, carry=False)
    bare_scene.frame_set(1 + STEPS // 2)
    assert length_of_trace(bare_scene, tmp_path / "still.png") < 0.2


def exported(collection, path, kind):
    """Export a morph, and return the object that reads the file in a scene with 24 frames per second."""
    import bpy

    (file,) = export_frames(collection, path, kind)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    if kind == "alembic":
        bpy.ops.wm.alembic_import(filepath=str(file), as_background_job=False)
    else:
        bpy.ops.wm.usd_import(filepath=str(file))
    bpy.context.scene.render.fps = 24
    (obj,) = (obj for obj in bpy.data.objects if obj.type == "MESH")
    return obj


@pytest.mark.parametrize("kind", ["alembic", "usd"])
def test_files_carry_the_velocity(bare_scene, make_object, tmp_path, kind):
    import bpy

    obj = exported(bake_a_moving_ball(bare_scene, make_object, 24), tmp_path / "moving", kind)
    for frame, speed in ((1, 0.0), (1 + STEPS // 2, DISTANCE / STEPS * 24), (1 + STEPS, 0.0)):
        bpy.context.scene.frame_set(frame)
        mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        np.testing.assert_allclose(np.linalg.norm(velocity_of(mesh), axis=1), speed, rtol=0.02)


@pytest.mark.parametrize("kind", ["alembic", "usd"])
def test_the_velocity_in_files_turns_and_grows_with_the_frames(bare_scene, make_object, tmp_path, kind):
    import bpy

    collection = bake_a_moving_ball(bare_scene, make_object, 24)
    for frame in frame_objects(collection):
        frame.rotation_euler.y, frame.scale = -np.pi / 2.0, (3.0, 1.0, 1.0)
    obj = exported(collection, tmp_path / "moving", kind)
    bpy.context.scene.frame_set(1 + STEPS // 2)
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    velocity = velocity_of(mesh).mean(axis=0)
    np.testing.assert_allclose(velocity, [0.0, 0.0, 3.0 * DISTANCE / STEPS * 24], atol=0.5)


def test_rates_are_differences_over_the_frames_between():
    path = path_blends(3, 4)
    rates = rates_of(path)
    np.testing.assert_allclose(rates[path[1]], [-0.25, 0.25, 0])
    np.testing.assert_allclose(rates[path[4]], [-0.125, 0, 0.125])
    assert path[0] not in rates
    assert path[-1] not in rates
    assert not rates_of(grid_blends(4, 3))
