# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands ``reflect`` and ``sky``: files and exit codes."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest

from convwass_addon import cli
from convwass_addon.applications.reflectance.table_files import read_table
from convwass_addon.bridge.reflectance.lobe_images import read_lobe_exr
from convwass_addon.bridge.reflectance.pad_materials import PLACE
from convwass_addon.bridge.skies.sky_pixels import read_sky_file, write_sky
from tests.lights import coarse_lobes, sky

pytestmark = pytest.mark.usefixtures("empty_scene")


def reflect(out, *words):
    with coarse_lobes():
        return cli.main(["reflect", *words, "--rows", "10", "--out", str(out)])


def test_a_blend_is_written_and_reported(tmp_path, capfd):
    out = tmp_path / "half.npz"
    assert reflect(out, "ggx:0.2,0.2", "ggx:0.6,0.6", "--weights", "1,1", "--json") == 0
    record = json.loads(capfd.readouterr().out)
    assert record["written"] == [str(out)]
    (blend,) = record["blends"]
    assert blend["weights"] == [0.5, 0.5]
    # Half-way between half-angle quantiles: the mean of the alphas.
    assert blend["fit"]["alpha_x"] == pytest.approx(0.4, rel=0.12)
    assert read_table(out).rows == 10


def test_written_tables_can_be_blended_again(tmp_path):
    for name, word in (("a.npz", "blinn:50"), ("b.lobes.exr", "principled:0.7")):
        assert reflect(tmp_path / name, word, word) == 0
    assert reflect(tmp_path / "c.exr", str(tmp_path / "a.npz"), str(tmp_path / "b.lobes.exr"), "--steps", "3") == 0
    assert len(read_lobe_exr(tmp_path / "c.exr")) == 3


def test_a_path_and_a_pad_are_written(tmp_path):
    words = ["ggx:0.2,0.2", "ggx:0.6,0.6", "blinn:20"]
    assert reflect(tmp_path / "way.exr", *words, "--weights", "1,0,0", "--weights", "0,1,1", "--steps", "3") == 0
    assert len(read_lobe_exr(tmp_path / "way.exr")) == 3
    assert reflect(tmp_path / "pad.exr", *words, "--pad", "2") == 0
    assert len(read_lobe_exr(tmp_path / "pad.exr")) == 4


def test_a_blend_file_shows_a_pad_on_balls(tmp_path):
    words = ["ggx:0.2,0.2", "ggx:0.6,0.6", "blinn:20"]
    assert reflect(tmp_path / "pad.blend", *words, "--pad", "2") == 0
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "pad.blend"))
    name = "-".join(words)
    assert {name, f"{name} fitted"} <= {block.name for block in bpy.data.objects}
    handle = bpy.data.objects["Material Handle"]
    handle.location.x = 10.0
    bpy.context.scene.frame_set(1)
    assert bpy.data.materials[name].node_tree.nodes[PLACE].inputs["X"].default_value == pytest.approx(1.0)


def test_grain_requires_complete_tables(tmp_path, capfd):
    assert reflect(tmp_path / "a.exr", "ashikhmin:10,100", "ggx:0.3,0.3") == 3
    assert "choose .npz or .lobes.exr" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["ggx:0.2,0.2"], "two to four"),
        (["ggx:0.2", "ggx:0.2,0.2"], "is neither a material"),
        (["velvet:1", "blinn:20"], "is neither a material"),
        (["blinn:x", "blinn:20"], "is neither a material"),
        (["none.npz", "none.npz"], "cannot be read"),
        (["none.binary", "blinn:20"], "cannot be read"),
        (["blinn:20", "blinn:30", "--steps", "3"], "files hold one blend"),
        (["blinn:20", "blinn:30", "--weights", "1"], "one weight for each"),
        (["blinn:20", "blinn:30", "--weights", "1,0", "--weights", "0,1"], "set the number of blends"),
        (["blinn:20", "blinn:30", "--pad", "3"], "leave out --steps and --pad"),
    ],
)
def test_invalid_input_is_refused(tmp_path, capfd, words, message):
    assert reflect(tmp_path / "a.npz", *words) == 3
    assert message in capfd.readouterr().err
    assert not list(tmp_path.iterdir())


def test_skies_are_written(tmp_path, capfd):
    ends = [sky((1, 0, 1)), sky((0, 1, 1))]
    for name, image in zip("ab", ends, strict=True):
        write_sky(tmp_path / f"{name}.exr", image)
    words = ["sky", str(tmp_path / "a.exr"), str(tmp_path / "b.exr"), "--steps", "3", "--first", "7"]
    assert cli.main([*words, "--out", str(tmp_path / "out"), "--json"]) == 0
    record = json.loads(capfd.readouterr().out)
    paths = sorted((tmp_path / "out").iterdir())
    assert [path.name for path in paths] == ["sky.0007.exr", "sky.0008.exr", "sky.0009.exr"]
    assert record["written"] == [str(path) for path in paths]
    assert [frame["time"] for frame in record["frames"]] == [0.0, 0.5, 1.0]
    np.testing.assert_allclose(read_sky_file(paths[0]), ends[0], rtol=1e-5)


@pytest.fixture
def gray_skies(tmp_path):
    """Two images of bytes without suns."""
    paths = [tmp_path / "a.png", tmp_path / "b.jpg"]
    for path, kind in zip(paths, ("PNG", "JPEG"), strict=True):
        image = bpy.data.images.new(path.name, 64, 32)
        image.generated_color = (0.5, 0.5, 0.5, 1.0)
        image.file_format, image.filepath_raw = kind, str(path)
        image.save()
    return [str(path) for path in paths]


@pytest.mark.parametrize(
    ("steps", "left"), [(2, "sky.0003.exr to sky.0005.exr"), (4, "sky.0005.exr,"), (5, None), (6, None)]
)
def test_skies_left_by_a_longer_run_are_reported_and_kept(tmp_path, gray_skies, capfd, steps, left):
    out = tmp_path / "out"
    out.mkdir()
    for name in ("sky.0003.exr", "sky.0005.exr", "sky.exr", "notes.txt"):
        (out / name).touch()
    assert cli.main(["sky", *gray_skies, "--steps", str(steps), "--out", str(out)]) == 0
    said = capfd.readouterr().err
    assert (f"{out} also contains {left}" in said) if left else ("also contains" not in said)
    assert {"sky.0005.exr", "sky.exr", "notes.txt"} <= {path.name for path in out.iterdir()}


def test_damaged_skies_are_named(tmp_path, gray_skies, capfd):
    (tmp_path / "bad.exr").write_bytes(b"no pixels")
    assert cli.main(["sky", gray_skies[0], str(tmp_path / "bad.exr"), "--out", str(tmp_path / "out")]) == 3
    assert "bad.exr could not be read; it is damaged" in capfd.readouterr().err


def test_missing_skies_and_single_steps_are_refused(tmp_path, capfd):
    write_sky(tmp_path / "a.exr", sky((1, 0, 1)))
    words = ["sky", str(tmp_path / "a.exr"), str(tmp_path / "b.exr")]
    assert cli.main([*words, "--out", str(tmp_path / "out")]) == 3
    assert "There is no file" in capfd.readouterr().err
    assert cli.main([*words, "--out", str(tmp_path / "out"), "--steps", "1"]) == 3
    assert not (tmp_path / "out").exists()
    assert cli.main(["sky", str(tmp_path / "a.exr"), "--out", str(tmp_path / "out")]) == 3
    assert "at least two images" in capfd.readouterr().err


def test_skies_have_no_negative_numbers(tmp_path, gray_skies, capfd):
    assert cli.main(["sky", *gray_skies, "--steps", "3", "--first", "-1", "--out", str(tmp_path / "out")]) == 3
    assert "--first must be 0 or more" in capfd.readouterr().err
    assert not (tmp_path / "out").exists()


def test_black_skies_are_named(tmp_path, gray_skies, capfd):
    write_sky(tmp_path / "night.exr", np.zeros((32, 64, 3), np.float32))
    assert cli.main(["sky", gray_skies[0], str(tmp_path / "night.exr"), "--out", str(tmp_path / "out")]) == 3
    assert "The sky of night.exr has no light." in capfd.readouterr().err
    assert not (tmp_path / "out").exists()
