# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``recolor``: files and exit codes."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest

from convwass_addon import cli
from convwass_addon.applications.palettes import recolor_job
from convwass_addon.bridge.studio.video import write_video
from convwass_addon.cli import recolor_command
from convwass_addon.errors import ConvwassError
from tests.pictures import blue_image, image_of, mean_lab, pixels_in, red_image

pytestmark = pytest.mark.usefixtures("empty_scene")


def saved(image, path):
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    return path


def run(*arguments):
    return cli.main(["recolor", *map(str, arguments)])


@pytest.fixture
def red(tmp_path):
    return saved(red_image(), tmp_path / "red.png")


@pytest.fixture
def blue(tmp_path):
    return saved(blue_image(), tmp_path / "blue.png")


def test_an_image_and_a_table_are_written(tmp_path, red, blue, capfd):
    out, cube = tmp_path / "out.png", tmp_path / "grade.cube"
    assert run(red, "--palette", blue, "--out", out, "--cube", cube, "--cube-size", 33, "--json") == 0
    record = json.loads(capfd.readouterr().out)
    assert record["written"] == [str(cube), str(out)] and record["marginal_error"] < 1e-2
    np.testing.assert_allclose(mean_lab(pixels_in(out)), mean_lab(pixels_in(blue)), atol=0.6)
    by_table = tmp_path / "by_table.png"
    assert run(red, "--lut", cube, "--out", by_table) == 0
    assert np.abs(pixels_in(by_table) - pixels_in(out)).mean() * 255 < 1.0


def test_tables_are_applied_at_a_strength(tmp_path, red, blue):
    """As the map that the table was made from is."""
    cube = tmp_path / "grade.cube"
    assert run(red, "--palette", blue, "--cube", cube) == 0
    for strength in (0.0, 0.4):
        by_map, by_table = tmp_path / "map.png", tmp_path / "table.png"
        assert run(red, "--palette", blue, "--strength", strength, "--out", by_map) == 0
        assert run(red, "--lut", cube, "--strength", strength, "--out", by_table) == 0
        assert np.abs(pixels_in(by_table) - pixels_in(by_map)).mean() * 255 < (1.0 if strength else 1e-6)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--smoothing", "2", "--keep-lightness"], "leave out --keep-lightness, --smoothing."),
        (["--gamut", "chroma"], "leave out --gamut."),
        (["--slope-limit", "2"], "leave out --slope-limit."),
        (["--edge-radius", "3"], "leave out --edge-radius."),
        (["--cube-size", "17"], "leave out --cube-size."),
        (["--cube", "a.cube", "--steps", "3"], "leave out --cube, --steps."),
        (["--weights", ".5,.5"], "--lut has none; leave out --weights."),
    ],
)
def test_options_of_maps_are_refused_with_a_table(tmp_path, red, capfd, words, message):
    assert run(red, "--lut", tmp_path / "grade.cube", *words, "--out", tmp_path / "a.png") == 3
    assert message in capfd.readouterr().err


def test_frames_of_a_clip_are_graded_alike(tmp_path, red, blue):
    """A dark frame and a bright one: together they have the palette, and the dark one stays darker."""
    pixels = pixels_in(red)
    frames = []
    for number, gain in enumerate((0.7, 1.2)):
        changed = pixels.copy()
        changed[..., :3] = np.minimum(changed[..., :3] * gain, 1.0)
        frames.append(saved(image_of(f"Frame {number}", changed), tmp_path / f"frame.{number}.png"))
    out = tmp_path / "graded"
    assert run(*frames, "--palette", blue, "--out", out) == 0
    means = [mean_lab(pixels_in(out / frame.name)) for frame in frames]
    assert means[0][0] < means[1][0] - 3.0
    np.testing.assert_allclose(np.mean(means, axis=0), mean_lab(pixels_in(blue)), atol=1.0)


def test_movies_become_graded_frames(tmp_path, red, blue, capfd):
    frames = [saved(image_of("Frame", pixels_in(red)), tmp_path / f"frame.{number}.png") for number in (0, 1)]
    movie, out = tmp_path / "shot.mp4", tmp_path / "graded"
    write_video(frames, movie, (60, 40), 24)
    before = len(bpy.data.images), len(bpy.data.textures)
    assert run(movie, "--palette", blue, "--out", out) == 0
    assert before == (len(bpy.data.images), len(bpy.data.textures))
    assert sorted(path.name for path in out.iterdir()) == ["shot.0001.png", "shot.0002.png"]
    for path in out.iterdir():
        np.testing.assert_allclose(mean_lab(pixels_in(path)), mean_lab(pixels_in(blue)), atol=1.0)
    assert run(movie, red, "--palette", blue, "--out", out) == 3
    assert run(movie, "--palette", blue, "--steps", 3, "--out", out) == 3
    assert "A movie must be the only input" in capfd.readouterr().err


@pytest.mark.parametrize("ends", [KeyboardInterrupt(), ConvwassError("The disk is full.")])
def test_existing_files_are_kept_if_the_work_ends_early(tmp_path, red, blue, ends, monkeypatch):
    out, cube = tmp_path / "graded", tmp_path / "grade.cube"
    frames = [saved(image_of("Frame", pixels_in(red)), tmp_path / f"frame.{number}.png") for number in (0, 1)]
    assert run(*frames, "--palette", blue, "--out", out, "--cube", cube, "--cube-size", 5) == 0
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*")}
    save, left = recolor_command.save_pixels, [1]

    def breaks(*arguments):
        if not left:
            raise ends
        left.pop()
        save(*arguments)

    monkeypatch.setattr(recolor_command, "save_pixels", breaks)
    arguments = (*frames, "--palette", blue, "--strength", 0.3, "--out", out, "--cube", cube, "--cube-size", 5)
    try:
        assert run(*arguments) != 0
    except KeyboardInterrupt:
        assert isinstance(ends, KeyboardInterrupt)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.*")} == before


def test_steps_between_an_image_and_a_palette(tmp_path, red, blue, capfd):
    out = tmp_path / "sequence"
    assert run(red, "--palette", blue, "--steps", 3, "--out", out) == 0
    names = ["red.0000.png", "red.0001.png", "red.0002.png"]
    assert sorted(path.name for path in out.iterdir()) == names
    first, middle, last = (pixels_in(out / name) for name in names)
    np.testing.assert_array_equal(first, pixels_in(red))
    np.testing.assert_allclose(mean_lab(middle), (mean_lab(first) + mean_lab(last)) / 2.0, atol=0.5)
    assert run(red, "--palette", blue, "--steps", 2, "--out", out) == 0
    assert "also contains red.0002.png, not written by this run" in capfd.readouterr().err


def test_palettes_have_weights(tmp_path, red, blue):
    out = tmp_path / "out.exr"
    assert run(red, "--palette", blue, red, "--weights", "0,1", "--out", out) == 0
    before = len(bpy.data.images)
    assert run(red, "--palette", blue, red, "--weights", "1,1", "--out", tmp_path / "half.png") == 0
    assert len(bpy.data.images) == before
    wanted = (mean_lab(pixels_in(blue)) + mean_lab(pixels_in(red))) / 2.0
    np.testing.assert_allclose(mean_lab(pixels_in(tmp_path / "half.png")), wanted, atol=0.6)


@pytest.mark.parametrize(
    "arguments",
    [
        ["red.png", "--out", "a.png"],
        ["red.png", "--palette", "blue.png"],
        ["red.png", "--palette", "blue.png", "--lut", "a.cube", "--out", "a.png"],
        ["red.png", "--palette", "none.png", "--out", "a.png"],
        ["red.png", "--palette", "blue.png", "--out", "a.gif"],
        ["red.png", "--palette", "blue.png", "--out", "none/a.png"],
        ["red.png", "--palette", "blue.png", "--weights", "1,2", "--out", "a.png"],
        ["red.png", "--palette", "blue.png", "--strength", "2", "--out", "a.png"],
        ["red.png", "--palette", "blue.png", "--steps", "1", "--out", "a"],
        ["red.png", "--palette", "blue.png", "--depth", "32", "--out", "a.png"],
        ["red.png", "--palette", "blue.png", "--mask", "blue.png", "--out", "a.png"],
        ["red.png", "blue.png", "--palette", "blue.png", "--out", "."],
        ["red.png", "red.png", "--palette", "blue.png", "--out", "a"],
        ["red.png", "--palette", "blue.png", "--cube-size", "17", "--out", "a.png"],
        ["red.png", "--lut", "blue.png", "--out", "a.png"],
        ["red.png", "--lut", "none.cube", "--out", "a.png"],
        ["red.png", "--palette", "blue.png", "--workers", "0", "--out", "a.png"],
        ["red.png", "--palette", "blue.png", "--workers", "-1", "--out", "a.png"],
    ],
)
def test_invalid_input_is_refused(tmp_path, red, blue, arguments, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert run(*arguments) == 3
    assert "convwass:" in capfd.readouterr().err
    assert not [path for path in tmp_path.rglob("*.*") if path not in (red, blue)]


@pytest.mark.parametrize(
    ("out", "words", "message"),
    [
        ("a.exr", ["--depth", "8"], "OpenEXR files have 16, 32 bits a channel, not 8."),
        ("a.jpg", ["--depth", "16"], "JPEG files have 8 bits a channel, not 16."),
        ("a.png", ["--workers", "0"], "There must be at least one worker."),
    ],
)
def test_options_are_checked_before_palettes_are_solved(tmp_path, red, blue, monkeypatch, capfd, out, words, message):
    monkeypatch.setattr(recolor_command, "solved_map", None)
    assert run(red, "--palette", blue, *words, "--out", tmp_path / out) == 3
    assert message in capfd.readouterr().err
    (tmp_path / "folder").mkdir()
    source = tmp_path / out
    red.rename(source)
    assert run(source, "--palette", blue, *words, "--out", tmp_path / "folder") == 3
    assert message in capfd.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "Name a palette with --palette, or a lookup table with --lut."),
        (["--palette", "blue.png", "--lut", "grade.cube"], "--palette and --lut cannot be combined; choose one."),
    ],
)
def test_the_colors_come_from_one_source(tmp_path, red, blue, capfd, words, message):
    assert run(red, *words, "--out", tmp_path / "a.png") == 3
    assert message in capfd.readouterr().err


def test_damaged_images_are_named(tmp_path, red, capfd):
    damaged = tmp_path / "bad.png"
    damaged.write_bytes(b"no pixels")
    for words in ((damaged, "--palette", red), (red, "--palette", damaged)):
        assert run(*words, "--out", tmp_path / "a.png") == 3
        assert "bad.png could not be read; it is damaged" in capfd.readouterr().err


def test_palettes_that_could_not_be_matched_write_nothing(tmp_path, red, blue, capfd, monkeypatch):
    """As the operator does."""
    monkeypatch.setattr(recolor_job, "LARGEST_ERROR", 0.0)
    before = sorted(tmp_path.iterdir())
    code = run(red, "--palette", blue, "--out", tmp_path / "out.png", "--cube", tmp_path / "grade.cube")
    assert code == 3 and "could not be matched" in capfd.readouterr().err
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("spelling", ["dots", "link"])
def test_input_images_are_recognized_by_any_spelling_of_their_path(tmp_path, red, blue, capfd, spelling):
    """Neither the frames nor the palette are replaced, however the folder is written."""
    other = saved(red_image(), tmp_path / "red2.png")
    folder = tmp_path / ".." / tmp_path.name
    if spelling == "link":
        folder = tmp_path.with_name(f"{tmp_path.name} link")
        folder.symlink_to(tmp_path, target_is_directory=True)
    paths = (red, other, blue)
    before = [path.read_bytes() for path in paths]
    for words in ((red, other, "--palette", blue), (red, other, "--palette", red)):
        assert run(*words, "--out", folder) == 3
        assert "would be overwritten" in capfd.readouterr().err
    elsewhere = tmp_path / "shots"
    elsewhere.mkdir()
    namesake = saved(red_image(), elsewhere / "blue.png")
    assert run(namesake, "--palette", blue, "--out", folder) == 3
    assert "would be overwritten" in capfd.readouterr().err
    assert [path.read_bytes() for path in paths] == before
