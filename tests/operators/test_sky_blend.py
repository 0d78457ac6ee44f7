# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blending skies: files, the world that shows them, refused input, and cleanup after stopping."""

from __future__ import annotations

import time

import bpy
import numpy as np
import pytest

from convwass_addon.applications.skies.sky_settings import SkySettings
from convwass_addon.bridge.skies import world_skies
from convwass_addon.bridge.skies.sky_pixels import read_sky_file, write_sky
from convwass_addon.bridge.skies.world_skies import sequence_world, shown_files, world_sky
from convwass_addon.operators.sky_blend import CONVWASS_OT_blend_skies
from tests.lights import sky
from tests.operators.running import (
    ESCAPE,
    TIMER,
    Pressed,
    inventory,
    show_other_scene,
    started,
    until,
    window_context,
    write_one_at_a_time,
)

pytestmark = pytest.mark.usefixtures("empty_scene")

SUNS = ((1, 0, 0.4), (0, 1, 0.4))


@pytest.fixture
def worlds(empty_scene, tmp_path):
    """Two worlds with a sun each, called by their places in SUNS."""
    for place, sun in enumerate(SUNS):
        write_sky(tmp_path / f"in.{place}.exr", sky(sun))
        world = sequence_world(str(place), [tmp_path / f"in.{place}.exr"], 1)
        world.node_tree.animation_data_clear()
        next(node for node in world.node_tree.nodes if node.type == "TEX_ENVIRONMENT").image.source = "FILE"
    return tmp_path / "out"


def blend(folder, **arguments):
    given = {"worlds": "0, 1", "folder": str(folder), "frame_start": 4, "frame_end": 6, "width": 128} | arguments
    return bpy.ops.convwass.blend_skies(**given)


def test_every_frame_is_a_file_and_the_world_shows_them(worlds):
    assert blend(worlds) == {"FINISHED"}
    assert sorted(path.name for path in worlds.iterdir()) == [f"sky.000{frame}.exr" for frame in (4, 5, 6)]
    for frame, sun in ((4, SUNS[0]), (6, SUNS[1])):
        np.testing.assert_allclose(read_sky_file(worlds / f"sky.000{frame}.exr"), sky(sun), rtol=1e-5)
    world = bpy.context.scene.world
    assert world.name == "Sky 0-1"
    bpy.context.scene.frame_set(5)
    seen = world_sky(world, 64)
    row, column = np.unravel_index(seen.sum(axis=2).argmax(), seen.shape[:2])
    # Longitudes of 0 and 90 degrees: half-way lies 45, in 128 columns.
    assert abs(column + 0.5 - 16) <= 1
    # And higher than both ends, which are at 22 degrees: on the great circle at 30.
    assert 90 - (row + 0.5) * 180 / 64 == pytest.approx(np.degrees(np.arctan2(0.4, np.sqrt(0.5))), abs=2.9)


def test_changes_of_the_world_are_kept(worlds):
    blend(worlds)
    world = bpy.data.worlds["Sky 0-1"]
    copy = world.copy()
    copy.name = "Dusk"
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    strength = background.inputs["Strength"]
    for frame, value in ((1, 0.5), (9, 2.0)):
        strength.default_value = value
        strength.keyframe_insert("default_value", frame=frame)
    blend(worlds, frame_start=11, frame_end=12)
    assert bpy.context.scene.world == world
    seen = []
    for frame in (1, 9, 11, 12):
        bpy.context.scene.frame_set(frame)
        texture = next(node for node in world.node_tree.nodes if node.type == "TEX_ENVIRONMENT")
        seen.append((strength.default_value, texture.image_user.frame_offset))
    assert seen == [(0.5, 10), (2.0, 10), (2.0, 10), (2.0, 11)]
    assert shown_files(world) == {worlds / f"sky.00{frame}.exr" for frame in (11, 12)}
    assert shown_files(copy) == {worlds / f"sky.000{frame}.exr" for frame in (4, 5, 6)}


def test_a_sky_that_was_blended_again_can_be_undone(worlds):
    """Blender crashed where the image had been replaced by another one."""

    def shown():
        world = bpy.context.scene.world
        return next(node for node in world.node_tree.nodes if node.type == "TEX_ENVIRONMENT").image

    blend(worlds)
    bpy.ops.ed.undo_push(message="first")
    before = shown()
    blend(worlds, frame_start=14, frame_end=15)
    assert shown() == before
    bpy.ops.ed.undo_push(message="second")
    bpy.ops.ed.undo()
    assert bpy.path.basename(shown().filepath) == "sky.0004.exr"
    bpy.ops.ed.redo()
    assert bpy.path.basename(shown().filepath) == "sky.0014.exr"


def test_the_world_of_the_scene_stays_in_the_file(worlds, tmp_path):
    bpy.context.scene.world = bpy.data.worlds.new("Studio")
    blend(worlds)
    blend(worlds)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert set(bpy.data.worlds.keys()) == {"Studio", "Sky 0-1"}
    assert not bpy.data.worlds["Sky 0-1"].use_fake_user


def test_a_copy_of_the_scene_gets_a_sky_of_its_own(worlds):
    scene = bpy.context.scene
    blend(worlds)
    bpy.ops.scene.new(type="FULL_COPY")
    copy = bpy.context.scene.world
    for folder in ("second", "third"):
        assert blend(worlds / folder) == {"FINISHED"}
        assert bpy.context.scene.world == copy
        assert {path.parent for path in shown_files(copy)} == {worlds / folder}
        assert {path.parent for path in shown_files(scene.world)} == {worlds}
    bpy.ops.scene.new(type="NEW")
    blend(worlds / "fourth")
    assert bpy.context.scene.world not in (copy, scene.world)
    assert {path.parent for path in shown_files(scene.world)} == {worlds}


def test_the_images_are_found_where_the_file_was_moved(worlds, tmp_path):
    (tmp_path / "project").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "project" / "a.blend"))
    blend("//skies")
    bpy.ops.wm.save_mainfile()
    (tmp_path / "project").rename(tmp_path / "moved")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "moved" / "a.blend"))
    bpy.context.scene.frame_set(4)
    files = shown_files(bpy.data.worlds["Sky 0-1"])
    assert files == {tmp_path / "moved" / "skies" / f"sky.000{frame}.exr" for frame in (4, 5, 6)}
    np.testing.assert_allclose(world_sky(bpy.data.worlds["Sky 0-1"], 64).sum(), sky(SUNS[0]).sum(), rtol=0.1)


def test_the_worlds_of_the_panel_are_the_default(worlds):
    own = bpy.context.scene.convwass_sky
    with pytest.raises(RuntimeError, match="Choose at least two worlds, not 0"):
        blend(worlds, worlds="")
    own.world, own.world_3 = bpy.data.worlds["0"], bpy.data.worlds["1"]
    assert blend(worlds, worlds="", frame_end=5) == {"FINISHED"}


@pytest.mark.parametrize("source", ["FILE", "SEQUENCE"])
def test_the_images_of_the_chosen_worlds_are_not_overwritten(worlds, source):
    blend(worlds)
    if source == "FILE":
        texture = next(node for node in bpy.data.worlds["0"].node_tree.nodes if node.type == "TEX_ENVIRONMENT")
        texture.image.filepath = str(worlds / "sky.0006.exr")
    before = {path: path.read_bytes() for path in worlds.iterdir()}
    chosen = "0, 1" if source == "FILE" else "Sky 0-1, 1"
    with pytest.raises(RuntimeError, match=rf"The images of {chosen.split(',')[0]} in .* would be overwritten"):
        blend(worlds, worlds=chosen, frame_start=6, frame_end=8)
    assert {path: path.read_bytes() for path in worlds.iterdir()} == before
    assert blend(worlds, worlds=chosen, frame_start=7, frame_end=8) == {"FINISHED"}


def test_worlds_whose_images_were_replaced_are_named(worlds, capfd):
    blend(worlds)
    before = inventory()
    blend(worlds)
    assert inventory() == before
    assert "replaced" not in capfd.readouterr().out
    blend(worlds, worlds="1, 0")
    assert "show the new images, too, which have replaced theirs: Sky 0-1" in capfd.readouterr().out


def test_a_sky_without_a_sun_is_reported_if_the_other_one_has_one(worlds, tmp_path, capfd):
    write_sky(tmp_path / "in.1.exr", np.full((64, 128, 3), 0.3, np.float32))
    bpy.data.worlds["1"].node_tree.nodes["Environment Texture"].image.reload()
    assert blend(worlds, frame_end=5) == {"FINISHED"}
    assert "One of the skies has no sun" in capfd.readouterr().out
    assert blend(worlds, frame_end=5, worlds="1, 1") == {"FINISHED"}
    assert "has no sun" not in capfd.readouterr().out


@pytest.mark.parametrize(("value", "problem"), [(0.0, "has no light"), (np.nan, "has pixels that are no numbers")])
def test_a_sky_that_cannot_be_blended_is_named(worlds, tmp_path, value, problem):
    write_sky(tmp_path / "in.1.exr", np.full((64, 128, 3), value, np.float32))
    bpy.data.worlds["1"].node_tree.nodes["Environment Texture"].image.reload()
    with pytest.raises(RuntimeError, match=f"The sky of 1 {problem}"):
        blend(worlds, worlds="0, 0, 1")
    assert not worlds.exists()


def test_angles_are_those_of_the_application_and_frames_have_ends():
    own = bpy.context.scene.convwass_sky
    default = SkySettings()
    assert [own.sky_settings().near, own.sky_settings().far] == pytest.approx([default.near, default.far])
    for name in ("near", "far"):
        assert own.bl_rna.properties[name].subtype == "ANGLE"
    own.far = np.radians(90.0)
    assert own.sky_settings().far == pytest.approx(90.0)
    for settings in (own, bpy.context.scene.convwass_reflectance):
        settings.frame_start, settings.frame_end = -(2**31), 2**31 - 1
        assert (settings.frame_start, settings.frame_end) == (-1_048_574, 1_048_574)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"worlds": "0"}, "Choose at least two worlds, not 1"),
        ({"worlds": "0, 7"}, "There is no world 7"),
        ({"frame_end": 4}, "must come after"),
        ({"near": np.radians(80.0), "far": np.radians(50.0)}, "glow must end"),
    ],
)
def test_invalid_input_is_refused(worlds, arguments, message):
    with pytest.raises(RuntimeError, match=message):
        blend(worlds, **arguments)
    assert not worlds.exists()
    assert bpy.context.scene.world is None


def test_worlds_are_read_one_by_one_while_the_window_answers(worlds, monkeypatch):
    read, shown = [], []

    def slow(world, height):
        read.append(world.name)
        time.sleep(0.01)
        return sky(SUNS[0], rows=height)

    monkeypatch.setattr(world_skies, "world_sky", slow)
    write_one_at_a_time(monkeypatch)
    pressed = Pressed(
        CONVWASS_OT_blend_skies, worlds="0, 1, 0", folder=str(worlds), frame_start=1, frame_end=3, width=128
    )
    window = window_context()
    assert started(pressed, window)
    progress = window.window_manager.convwass_progress
    for done in range(1, 3):
        assert len(read) == done - 1
        until(pressed, window, lambda done=done: len(read) == done)
        shown.append((progress.message, progress.fraction))
    assert read == ["0", "1"]
    assert shown == [("World 1 of 3", pytest.approx(0.2 / 3)), ("World 2 of 3", pytest.approx(0.4 / 3))]
    while (result := pressed.modal(window, ESCAPE)) == {"PASS_THROUGH"}:
        pass
    assert result == {"CANCELLED"}
    # Nor is the third one read after Esc, whether it had been asked for by then or not.
    assert read == ["0", "1"]
    assert not worlds.exists()


def test_a_world_deleted_during_the_work_is_reported(worlds):
    pressed = Pressed(CONVWASS_OT_blend_skies, worlds="0, 1", folder=str(worlds), frame_start=1, frame_end=3, width=128)
    window = window_context()
    assert started(pressed, window)
    bpy.data.worlds.remove(bpy.data.worlds["1"])
    assert until(pressed, window) == {"CANCELLED"}
    assert pressed.reports == [("ERROR", "There is no world 1.")]
    assert not worlds.exists()


@pytest.mark.parametrize("older", [False, True])
def test_escape_keeps_existing_files(worlds, older):
    if older:
        worlds.mkdir()
        (worlds / "sky.0001.exr").write_text("older")
    pressed = Pressed(
        CONVWASS_OT_blend_skies, worlds="0, 1", folder=str(worlds), frame_start=1, frame_end=200, width=128
    )
    window = window_context()
    assert started(pressed, window)
    pressed.modal(window, TIMER)
    while (result := pressed.modal(window, ESCAPE)) == {"PASS_THROUGH"}:
        pass
    assert result == {"CANCELLED"}
    assert worlds.exists() == older
    assert not older or [item.read_text() for item in worlds.iterdir()] == ["older"]
    assert bpy.context.scene.world is None


def test_the_scene_that_it_began_in_gets_the_sky(worlds):
    pressed = Pressed(CONVWASS_OT_blend_skies, worlds="0, 1", folder=str(worlds), frame_start=1, frame_end=2, width=128)
    window, own = window_context(), bpy.context.scene
    assert started(pressed, window)
    other = show_other_scene(window)
    assert until(pressed, window) == {"FINISHED"}
    assert (own.world.name, other.world) == ("Sky 0-1", None)
