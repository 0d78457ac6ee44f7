# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grading sequences of images and movies by one map, and tables made of them."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon import cli
from convwass_addon.applications.palettes.lookup_table import read_cube
from convwass_addon.bridge.files.image_files import pixel_values
from convwass_addon.bridge.palettes.clip_frames import ClipFrames
from convwass_addon.bridge.studio.video import write_video
from convwass_addon.operators import recolor_clip
from convwass_addon.operators.recolor_clip import CONVWASS_OT_recolor_clip
from convwass_addon.operators.recolor_targets import shown_image
from tests.operators.running import Pressed, call, inventory, started, until, window_context
from tests.pictures import blue_image, image_of, mean_lab, pixels_in, red_image

pytestmark = pytest.mark.usefixtures("empty_scene")

GAINS = (0.6, 0.9, 1.2)


def saved(image, path):
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return path


@pytest.fixture
def files(tmp_path):
    """Frames 7 to 9 of a shot that becomes brighter, and other files among them."""
    red = red_image()
    pixels = pixel_values(red)
    bpy.data.images.remove(red)
    found = []
    for number, gain in enumerate(GAINS, 7):
        changed = pixels.copy()
        changed[..., :3] = np.minimum(changed[..., :3] * gain, 1.0)
        found.append(saved(image_of("Frame", changed), tmp_path / f"shot.{number:04d}.png"))
    for other in ("shot.12.png", "shot.0010.exr", "other.0008.png"):
        (tmp_path / other).write_text("no image")
    return found


@pytest.fixture
def clip(files):
    image = bpy.data.images.load(str(files[1]))
    image.name, image.source = "Shot", "SEQUENCE"
    bpy.context.scene.convwass_recolor.palette = blue_image()
    return image


def recolor_by_command(files, folder):
    palette = saved(image_of("Copy", pixel_values(bpy.data.images["Blue"])), folder / "blue.png")
    assert cli.main(["recolor", *map(str, files), "--palette", str(palette), "--out", str(folder / "command")]) == 0


def test_all_frames_are_graded_by_one_map(clip, files, tmp_path):
    """The command grades the same way: frames are measured together and keep their differences."""
    before = len(bpy.data.textures), {path: path.read_bytes() for path in files}
    assert call("recolor_clip", image="Shot", folder=str(tmp_path / "graded")) == {"FINISHED"}
    results = sorted((tmp_path / "graded").iterdir())
    assert [path.name for path in results] == [path.name for path in files]
    means = np.array([mean_lab(pixels_in(path)) for path in results])
    assert (np.diff(means[:, 0]) > 2.0).all()
    np.testing.assert_allclose(means.mean(axis=0), mean_lab(pixel_values(bpy.data.images["Blue"])), atol=1.0)
    assert before == (len(bpy.data.textures), {path: path.read_bytes() for path in files})
    recolor_by_command(files, tmp_path)
    for path in results:
        np.testing.assert_allclose(pixels_in(path), pixels_in(tmp_path / "command" / path.name), atol=1.1 / 255)


def test_the_result_is_a_sequence_that_is_shown(clip, files, tmp_path):
    editor = SimpleNamespace(type="IMAGE_EDITOR", image=clip, image_user=SimpleNamespace())
    context = window_context()
    context.space_data = editor
    paths = [tmp_path / "graded" / path.name for path in files]
    pressed = Pressed(CONVWASS_OT_recolor_clip, image="Shot", folder=str(tmp_path / "graded"))
    assert started(pressed, context)
    assert until(pressed, context) == {"FINISHED"}
    result = bpy.data.images["Shot recolored"]
    assert result.source == "SEQUENCE" and bpy.path.abspath(result.filepath) == str(paths[0])
    assert editor.image == result and (editor.image_user.frame_duration, editor.image_user.frame_offset) == (3, 6)
    assert shown_image(context) == clip
    known = inventory()
    call("recolor_clip", image="Shot", folder=str(tmp_path / "graded"), strength=0.0)
    assert inventory() == known, "the result is used again"
    np.testing.assert_array_equal(pixels_in(paths[0]), pixels_in(files[0]))
    frames = ClipFrames(clip)
    np.testing.assert_array_equal(frames.read(2).pixels, pixels_in(files[2]))
    frames.close()
    with pytest.raises(RuntimeError, match="Shot has no pixels"):
        call("recolor_image", image="Shot")
    assert bpy.data.images["Shot recolored"].source == "SEQUENCE"


def test_a_table_of_a_clip_comes_from_all_frames(clip, files, tmp_path):
    call("recolor_clip", image="Shot", folder=str(tmp_path / "graded"))
    call("write_cube", image="Shot", filepath=str(tmp_path / "a.cube"), cube_size=33)
    table = read_cube(tmp_path / "a.cube")
    for path in files:
        found = np.moveaxis(table.applied(np.moveaxis(pixels_in(path)[..., :3], -1, 0)), 0, -1)
        assert np.abs(found - pixels_in(tmp_path / "graded" / path.name)[..., :3]).mean() * 255 < 1.0
    call("build_grade_nodes", image="Shot", cube_size=5)
    assert "Grade Blue" in bpy.data.node_groups and not bpy.data.textures


def test_movies(files, tmp_path):
    """Frames that a codec has changed a little: their colors are those of the palette afterwards."""
    write_video(files, tmp_path / "shot.mp4", (60, 40), 24)
    movie = bpy.data.images.load(str(tmp_path / "shot.mp4"))
    assert movie.source == "MOVIE"
    bpy.context.scene.convwass_recolor.palette = blue_image()
    call("recolor_clip", image="shot.mp4", folder=str(tmp_path / "graded"))
    results = sorted((tmp_path / "graded").iterdir())
    assert [path.name for path in results] == [f"shot.{number:04d}.png" for number in (1, 2, 3)]
    means = np.array([mean_lab(pixels_in(path)) for path in results])
    assert (np.diff(means[:, 0]) > 2.0).all()
    np.testing.assert_allclose(means.mean(axis=0), mean_lab(pixel_values(bpy.data.images["Blue"])), atol=1.5)


def test_empty_frames_do_not_count(clip, files, tmp_path):
    """As before an effect begins and after it has ended."""
    empty = np.zeros_like(pixels_in(files[0]))
    saved(image_of("Empty", empty), files[0])
    assert call("recolor_clip", image="Shot", folder=str(tmp_path / "graded")) == {"FINISHED"}
    means = [mean_lab(pixels_in(tmp_path / "graded" / path.name)) for path in files[1:]]
    np.testing.assert_allclose(np.mean(means, axis=0), mean_lab(pixel_values(bpy.data.images["Blue"])), atol=1.0)
    assert not pixels_in(tmp_path / "graded" / files[0].name)[..., 3].any()
    recolor_by_command(files, tmp_path)
    for path in files:
        graded, command = (pixels_in(tmp_path / folder / path.name) for folder in ("graded", "command"))
        np.testing.assert_allclose(graded, command, atol=1.1 / 255)
    for path in files[1:]:
        saved(image_of("Empty", empty), path)
    with pytest.raises(RuntimeError, match="No pixel counts"):
        call("recolor_clip", image="Shot", folder=str(tmp_path / "graded"))


def test_results_of_another_clip_are_not_overwritten(clip, files, tmp_path):
    graded = str(tmp_path / "graded")
    call("recolor_clip", image="Shot", folder=graded)
    before = {path: path.read_bytes() for path in (tmp_path / "graded").iterdir()}
    (tmp_path / "second").mkdir()
    for path in files:
        (tmp_path / "second" / path.name).write_bytes(path.read_bytes())
    other = bpy.data.images.load(str(tmp_path / "second" / files[0].name))
    other.name, other.source = "Second", "SEQUENCE"
    with pytest.raises(RuntimeError, match="The results would overwrite those of Shot; choose another folder"):
        call("recolor_clip", image="Second", folder=graded)
    clip.name = "Renamed"
    with pytest.raises(RuntimeError, match="The results would overwrite those of Renamed; choose another folder"):
        call("recolor_clip", image="Second", folder=graded)
    clip.name = "Shot"
    assert {path: path.read_bytes() for path in (tmp_path / "graded").iterdir()} == before
    assert call("recolor_clip", image="Second", folder=str(tmp_path / "more")) == {"FINISHED"}
    assert call("recolor_clip", image="Shot", folder=graded) == {"FINISHED"}
    # Nobody needs the results of a clip that is gone.
    bpy.data.images.remove(clip)
    assert call("recolor_clip", image="Second", folder=graded) == {"FINISHED"}


def test_a_renamed_copy_of_the_result_is_kept(clip, tmp_path):
    call("recolor_clip", image="Shot", folder=str(tmp_path / "graded"))
    copy = bpy.data.images["Shot recolored"].copy()
    copy.name, shown = "A good one", copy.filepath
    call("recolor_clip", image="Shot", folder=str(tmp_path / "more"))
    assert copy.filepath == shown
    assert bpy.data.images["Shot recolored"].filepath.startswith(str(tmp_path / "more"))


def test_the_result_is_found_where_the_file_was_moved(clip, files, tmp_path):
    (tmp_path / "project").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "project" / "a.blend"))
    call("recolor_clip", image="Shot", folder="//graded")
    bpy.data.images["Shot recolored"].use_fake_user = True
    bpy.ops.wm.save_mainfile()
    (tmp_path / "project").rename(tmp_path / "moved")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "moved" / "a.blend"))
    found = ClipFrames(bpy.data.images["Shot recolored"])
    assert found.path == tmp_path / "moved" / "graded" / files[0].name
    assert len(found.numbers) == len(files)


def test_a_mask_of_another_size_is_refused_by_the_name_of_the_clip(clip, tmp_path):
    bpy.context.scene.convwass_recolor.mask = image_of("Mask", np.ones((4, 4, 4)))
    with pytest.raises(RuntimeError, match="The mask Mask has 4 x 4 pixels, unlike Shot; "):
        call("recolor_clip", image="Shot", folder=str(tmp_path / "graded"))


def test_masks_protect_in_every_frame(clip, files, tmp_path):
    white = np.ones((40, 60, 4))
    white[:, :30, :3] = 0.0
    own = bpy.context.scene.convwass_recolor
    own.mask = image_of("Mask", white)
    call("recolor_clip", image="Shot", folder=str(tmp_path / "graded"))
    for path in files:
        found, before = pixels_in(tmp_path / "graded" / path.name), pixels_in(path)
        np.testing.assert_array_equal(found[:, :30], before[:, :30])
        assert np.abs(found[:, 30:] - before[:, 30:]).mean() > 0.03


@pytest.mark.parametrize("spelling", ["dots", "link"])
def test_the_folder_of_the_frames_is_known_by_any_name(clip, files, tmp_path, spelling):
    folder = tmp_path / ".." / tmp_path.name
    if spelling == "link":
        folder = tmp_path.with_name(f"{tmp_path.name} link")
        folder.symlink_to(tmp_path, target_is_directory=True)
    before = [path.read_bytes() for path in files]
    with pytest.raises(RuntimeError, match="overwrite the frames of Shot"):
        call("recolor_clip", image="Shot", folder=str(folder))
    assert [path.read_bytes() for path in files] == before


def test_invalid_input_is_refused(clip, files, tmp_path):
    (tmp_path / "taken").write_text("x")
    for folder, said in (
        (tmp_path, "overwrite the frames of Shot"),
        (tmp_path / "none" / "deeper", "does not exist"),
        (tmp_path / "taken", "is a file"),
        ("//graded", "Save the file first"),
    ):
        with pytest.raises(RuntimeError, match=said):
            call("recolor_clip", image="Shot", folder=str(folder))
    red_image()
    with pytest.raises(RuntimeError, match="neither a sequence"):
        call("recolor_clip", image="Red", folder=str(tmp_path / "graded"))
    with pytest.raises(RuntimeError, match="frames cannot be changed"):
        call("recolor_image", image="Shot", output="REPLACE")
    clip.filepath = str(tmp_path / "still.png")
    with pytest.raises(RuntimeError, match="no number"):
        call("recolor_clip", image="Shot", folder=str(tmp_path / "graded"))
    clip.filepath = str(tmp_path / "gone.0001.png")
    with pytest.raises(RuntimeError, match="no file"):
        call("recolor_clip", image="Shot", folder=str(tmp_path / "graded"))


def test_a_broken_frame_keeps_existing_files(clip, files, tmp_path):
    folder = tmp_path / "graded"
    call("recolor_clip", image="Shot", folder=str(folder))
    before, known = {path: path.read_bytes() for path in folder.iterdir()}, inventory()
    files[2].write_bytes(b"no longer an image")
    with pytest.raises(RuntimeError, match="Frame 9 of"):
        call("recolor_clip", image="Shot", folder=str(folder), strength=0.3)
    assert {path: path.read_bytes() for path in folder.iterdir()} == before
    assert inventory() == known
    with pytest.raises(RuntimeError, match="Frame 9 of"):
        call("recolor_clip", image="Shot", folder=str(tmp_path / "new"))
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("stops", [None, "Measuring frame 2", "Recoloring frame 2"])
def test_in_the_background(clip, tmp_path, stops, monkeypatch):
    """On its thread; stopped, it leaves neither files nor folders, and nothing in the scene."""
    known, seen = inventory(), []
    context = window_context()
    context.space_data = None
    pressed = Pressed(CONVWASS_OT_recolor_clip, image="Shot", folder=str(tmp_path / "graded"))
    progress = context.window_manager.convwass_progress
    write = recolor_clip.ClipJob.write

    def noted(job, step):
        seen.append(step.message.template.format(**step.message.values))
        progress.stopping = stops is not None and seen[-1].startswith(stops)
        write(job, step)

    monkeypatch.setattr(recolor_clip.ClipJob, "write", noted)
    assert started(pressed, context)
    ends = until(pressed, context)
    if stops is None:
        assert ends == {"FINISHED"} and len(list((tmp_path / "graded").iterdir())) == 3
        assert "Measuring frame 3 of 3" in seen and "Recoloring frame 3 of 3" in seen
    else:
        assert ends == {"CANCELLED"} and not (tmp_path / "graded").exists()
        assert inventory() == known
    assert not progress.running


def test_the_clip_is_found_by_identity_not_by_name(clip, tmp_path):
    """Renamed while the job runs, with another image in its name's place."""
    context = window_context()
    pressed = Pressed(CONVWASS_OT_recolor_clip, image="Shot", folder=str(tmp_path / "graded"))
    context.space_data = SimpleNamespace(type="IMAGE_EDITOR", image=clip, image_user=SimpleNamespace())
    assert started(pressed, context)
    clip.name = "Renamed"
    bpy.data.images.new("Shot", 4, 4)
    assert until(pressed, context) == {"FINISHED"}
    assert context.space_data.image.name == "Renamed recolored"


def test_undoing_does_not_lose_the_frames(clip, tmp_path):
    """What is made for reading may be gone at any step."""
    frames = ClipFrames(clip)
    first = frames.read(0).pixels
    bpy.data.images.remove(frames.image)
    bpy.data.textures.remove(bpy.data.textures[0])
    np.testing.assert_array_equal(frames.read(0).pixels, first)
    frames.close()
    assert not bpy.data.textures and len([own for own in bpy.data.images if own.source == "SEQUENCE"]) == 1
