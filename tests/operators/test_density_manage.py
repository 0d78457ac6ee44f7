# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done with an animated density: baked, shown, made again, removed."""

from __future__ import annotations

import json
import os

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.densities.density_attributes import stored_frames
from convwass_addon.bridge.densities.density_player import played_densities
from convwass_addon.bridge.densities.density_store import DENSITIES_KEY, stored_density
from convwass_addon.bridge.vertex_groups import read_group, write_group
from convwass_addon.operators.density_changes import changed_inputs, lost_inputs
from convwass_addon.operators.density_manage import CONVWASS_OT_bake_density
from tests.operators.densities import ball, curve, positions
from tests.operators.running import ESCAPE, Pressed, call, inventory, pretend_window, until, window_context

pytestmark = pytest.mark.usefixtures("empty_scene")

NAMES = ("bake_density", "remove_density", "show_density_material", "rebake_density")


def animate_density():
    ball()
    call(
        "interpolate_density",
        groups="A, B",
        steps=4,
        frames="1, 9",
        entropy_limit="NUMBER",
        entropy_bound=-1.5,
        blur=0.3,
    )


@pytest.fixture
def obj(empty_scene, scene_with):
    """A ball with an animated density of four steps."""
    scene_with(animate_density)
    return bpy.context.object


def test_steps_become_groups(obj):
    assert call("bake_density", output="GROUPS") == {"FINISHED"}
    assert obj.vertex_groups.keys() == ["A", "B", *(f"Density.{step:03d}" for step in range(5))]
    np.testing.assert_allclose(read_group(obj, "Density.002"), stored_frames(obj)[2], atol=1e-6)


def test_steps_become_colors(obj):
    assert call("bake_density", output="COLORS", density="Density") == {"FINISHED"}
    assert len(obj.data.color_attributes) == 5


def test_colors_are_animated(obj):
    assert call("bake_density", output="ANIMATED_COLOR") == {"FINISHED"}
    assert obj.data.color_attributes.active_color_name == "Density color"


def test_steps_become_images(obj, tmp_path):
    folder = tmp_path / "out"
    assert call("bake_density", output="IMAGES", folder=str(folder), size=32, file_format="OPEN_EXR") == {"FINISHED"}
    assert sorted(path.name for path in folder.iterdir()) == [f"Density.{step:04d}.exr" for step in range(5)]
    assert len(stored_density(obj, "Density").outputs["images"]) == 5
    with pytest.raises(RuntimeError, match="Save the file first"):
        call("bake_density", output="IMAGES")
    with pytest.raises(RuntimeError, match="no UV map Nobody"):
        call("bake_density", output="IMAGES", folder=str(folder), uv_map="Nobody")


def bake_images(folder, **arguments):
    return call("bake_density", output="IMAGES", folder=str(folder), size=16, **arguments)


def test_images_of_another_object_are_not_overwritten(obj, tmp_path):
    assert bake_images(tmp_path) == {"FINISHED"}
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    ball(location=(5, 0, 0))
    call("interpolate_density", groups="B, A", steps=4, blur=0.3)
    with pytest.raises(
        RuntimeError, match=r"Density\.0000\.png is an image of a density of Sphere and would be overwr"
    ):
        bake_images(tmp_path)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert bake_images(tmp_path, file_format="OPEN_EXR") == {"FINISHED"}
    bpy.context.view_layer.objects.active = obj
    assert bake_images(tmp_path) == {"FINISHED"}


def test_a_copy_of_the_object_keeps_the_images_of_the_first_one(obj, tmp_path):
    assert bake_images(tmp_path) == {"FINISHED"}
    before = {path: path.stat().st_ino for path in tmp_path.glob("*.png")}
    bpy.ops.object.duplicate()
    assert bake_images(tmp_path) == {"FINISHED"}
    assert {path: path.stat().st_ino for path in before} == before
    assert len(list(tmp_path.glob("Density_001/*.png"))) == len(before) == 5
    bpy.context.view_layer.objects.active = obj
    assert bake_images(tmp_path) == {"FINISHED"}
    assert all(path.stat().st_ino != inode for path, inode in before.items())
    assert len(list(tmp_path.iterdir())) == 6


def test_the_message_names_the_folder_of_images_that_would_have_replaced_unknown_files(obj, tmp_path, capfd):
    (tmp_path / "Density.0000.png").write_text("mine")
    assert bake_images(tmp_path) == {"FINISHED"}
    said = capfd.readouterr().out
    assert f"5 images in {tmp_path / 'Density_001'}" in said
    assert f"{tmp_path} contains other files of these names (1), which are kept" in said
    assert (tmp_path / "Density.0000.png").read_text() == "mine"


def test_images_that_a_shorter_bake_leaves_are_named(obj, tmp_path, capfd):
    bake_images(tmp_path / "elsewhere")
    bake_images(tmp_path)
    assert "earlier" not in capfd.readouterr().out
    call("interpolate_density", groups="A, B", steps=2, blur=0.3)
    bake_images(tmp_path)
    assert "images of an earlier bake: Density.0003.png, Density.0004.png" in capfd.readouterr().out
    assert len(stored_density(obj, "Density").outputs["images"]) == 10


def test_materials_show_it(obj):
    assert call("show_density_material", kind="MOSS", threshold=0.4) == {"FINISHED"}
    assert obj.active_material.name == "Density Moss"
    call("show_density_material")
    assert obj.active_material.name == "Density Heat Map"
    assert len(obj.material_slots) == 1


def test_removing_leaves_the_groups(obj):
    call("bake_density", output="GROUPS")
    groups = obj.vertex_groups.keys()
    bpy.ops.ed.undo_push(message="there")
    before = inventory()
    assert call("remove_density") == {"FINISHED"}
    assert played_densities(obj) == []
    assert obj.vertex_groups.keys() == groups
    assert obj.animation_data is None or obj.animation_data.action is None
    assert not any(name.startswith(".Density") for name in obj.data.attributes.keys())  # noqa: SIM118
    bpy.ops.ed.undo_push(message="gone")
    bpy.ops.ed.undo()
    assert inventory() == before


@pytest.mark.parametrize("name", NAMES)
def test_polls_and_unknown_names(name):
    with pytest.raises(RuntimeError, match="Make a mesh object active"):
        call(name)
    ball()
    with pytest.raises(RuntimeError, match="Interpolate a density first"):
        call(name)
    call("interpolate_density", groups="A, B", steps=1)
    with pytest.raises(RuntimeError, match="Nobody"):
        call(name, density="Nobody")
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Go to Object or Weight Paint Mode first"):
        call(name)


def test_it_is_repeated_with_its_stored_settings(obj, capfd):
    keys, before = curve(obj), stored_density(obj, "Density")
    assert call("rebake_density", only_if_changed=True) == {"CANCELLED"}
    write_group(obj, "B", (positions(obj)[:, 1] < -0.8).astype(float))
    assert call("rebake_density", only_if_changed=True) == {"FINISHED"}
    assert "Changed since it was made: B" in capfd.readouterr().out
    after = stored_density(obj, "Density")
    assert (after.inputs, curve(obj)) == (before.inputs, keys)
    changed = {name for name, value in after.settings.items() if value != before.settings[name]}
    assert changed == {"marks"}
    last = stored_frames(obj)[-1]
    assert (last @ positions(obj) / last.sum())[1] < -0.85


@pytest.mark.parametrize("entropy_limit", ["OFF", "BETWEEN", "MAX", "NUMBER"])
def test_every_bound_comes_back(entropy_limit):
    obj = ball()
    call("interpolate_density", groups="A, B", steps=2, entropy_limit=entropy_limit, easing="SMOOTH", pieces="match")
    before = stored_density(obj, "Density").settings
    assert call("rebake_density") == {"FINISHED"}
    assert stored_density(obj, "Density").settings == before


def test_deleted_parts_are_noticed(obj):
    stored = stored_density(obj, "Density")
    assert lost_inputs(obj, stored) == changed_inputs(obj, stored) == []
    obj.vertex_groups["A"].add([5], 0.125, "REPLACE")
    assert (lost_inputs(obj, stored), changed_inputs(obj, stored)) == ([], ["A"])
    obj.vertex_groups.remove(obj.vertex_groups["B"])
    assert lost_inputs(obj, stored) == ["B"]
    obj.data.vertices.add(1)
    assert lost_inputs(obj, stored) == ["B", "Sphere"]
    with pytest.raises(RuntimeError, match="no vertex group B"):
        call("rebake_density")


@pytest.mark.parametrize(
    ("key", "value"),
    [("steps", "many"), ("entropy_limit", "much"), ("frames", 3), ("frames", ["a"]), ("blur", "x"), ("pieces", "torn")],
)
def test_damaged_settings_are_reported(obj, key, value):
    data = json.loads(obj[DENSITIES_KEY])
    data["densities"]["Density"]["settings"][key] = value
    obj[DENSITIES_KEY] = json.dumps(data)
    with pytest.raises(RuntimeError, match="damaged"):
        call("rebake_density")


def test_missing_frames_are_reported_and_missing_settings_get_defaults(obj):
    data = json.loads(obj[DENSITIES_KEY])
    del data["densities"]["Density"]["settings"]["blend_sharpness"]
    obj[DENSITIES_KEY] = json.dumps(data)
    assert call("rebake_density") == {"FINISHED"}
    data = json.loads(obj[DENSITIES_KEY])
    assert data["densities"]["Density"]["settings"].pop("frames")
    obj[DENSITIES_KEY] = json.dumps(data)
    with pytest.raises(RuntimeError, match="damaged"):
        call("rebake_density")


def test_images_can_be_stopped_and_those_that_are_there_stay(obj, monkeypatch, tmp_path):
    context = window_context()
    pressed = Pressed(CONVWASS_OT_bake_density, output="IMAGES", folder=str(tmp_path), size=1024)
    pretend_window(monkeypatch)
    assert pressed.invoke(context, None) == {"RUNNING_MODAL"}
    until(pressed, context, lambda: any(tmp_path.iterdir()))
    assert pressed.modal(context, ESCAPE) == {"FINISHED"}
    written = sorted(path.name for path in tmp_path.iterdir())
    assert 1 <= len(written) < len(stored_frames(obj, "Density"))
    assert "Stopped" in pressed.reports[-1][1]
    assert len(stored_density(obj, "Density").outputs["images"]) == len(written)


def test_images_written_before_an_error_can_be_replaced(obj, monkeypatch, tmp_path):
    """A full disk, for example."""
    moved, moves = os.replace, []

    def replaced(*paths):
        moves.append(paths)
        if len(moves) > 2:
            raise OSError("disk full")
        moved(*paths)

    monkeypatch.setattr("os.replace", replaced)
    with pytest.raises(RuntimeError, match="could not be written: disk full"):
        bake_images(tmp_path)
    assert len(list(tmp_path.iterdir())) == 2
    monkeypatch.undo()
    assert bake_images(tmp_path) == {"FINISHED"}


def test_images_are_written_in_the_background(obj, monkeypatch, tmp_path):
    context = window_context()
    pressed = Pressed(CONVWASS_OT_bake_density, output="IMAGES", folder=str(tmp_path), size=16)
    pretend_window(monkeypatch)
    assert pressed.invoke(context, None) == {"RUNNING_MODAL"}
    assert until(pressed, context) == {"FINISHED"}
    assert len(list(tmp_path.iterdir())) == len(stored_frames(obj, "Density"))
