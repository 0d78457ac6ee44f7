# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Full disks, missing folders and invalid paths: there is a message, and nothing is lost."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections import namedtuple
from pathlib import Path

import bpy
import numpy as np
import pytest

from convwass_addon import disk_space
from convwass_addon.applications.morphs.frame_cache import FrameCache, SpareFrameCache
from convwass_addon.applications.system_errors import error_to_tell
from convwass_addon.applications.whole_paths import path_with_suffix, whole_path
from convwass_addon.bridge.files.output_paths import checked_target, save_blend
from convwass_addon.bridge.files.scene_writing import write_usd
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.palettes.image_files import save_pixels
from convwass_addon.bridge.studio.rendered_scene import move_result
from convwass_addon.cli import main
from convwass_addon.disk_space import require_space, require_whole
from convwass_addon.drafts import written_whole
from convwass_addon.errors import ConvwassError, InputError, ResourceError
from tests.applications.test_frame_cache import assert_same
from tests.fuzz.killed_bake import bake
from tests.operators.morphs import baked_morph
from tests.pictures import image_of

_Usage = namedtuple("_Usage", "total used free")


@pytest.fixture
def small_disk(tmp_path):
    """A disk of 4 MB, and a function that fills it up to some bytes; requires permission to mount disks."""
    if not sys.platform.startswith("linux") or os.geteuid() or not shutil.which("mount"):
        pytest.skip("disks are mounted by root on Linux only")
    disk = tmp_path / "disk"
    disk.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", str(disk)], capture_output=True)
    if done.returncode:
        pytest.skip("this machine lets nobody mount disks")

    def fill(left=0):
        (disk / "fill").write_bytes(bytes(max(shutil.disk_usage(disk).free - left, 0)))
        return disk

    yield fill
    subprocess.run(["umount", "-l", str(disk)], check=True)


@pytest.fixture
def morph(empty_scene):
    """A baked morph, active."""
    for place in (0, 3):
        bpy.ops.mesh.primitive_cube_add(location=(place, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=3, resolution=32)
    return baked_morph()


def test_a_full_disk_is_reported_and_the_cache_continues_once_there_is_space(small_disk):
    disk = small_disk(left=40_000)
    with pytest.raises(ConvwassError, match="No space left"):
        bake(FrameCache(disk))
    assert not list(disk.glob("*.part"))
    spare = SpareFrameCache(disk, 1 << 20)
    frames = bake(spare)
    assert "No space left" in str(spare.notices[0])
    (disk / "fill").unlink()
    assert_same(bake(FrameCache(disk)), frames)


@pytest.mark.usefixtures("empty_scene")
@pytest.mark.parametrize("name", ["x.png", "x.jpg", "x.tif", "x.blend"])
@pytest.mark.parametrize("left", [0, 4096])
def test_old_files_are_kept_if_new_ones_do_not_fit(name, left, small_disk):
    """Blender would write an incomplete PNG without an error."""
    path = small_disk() / name
    path.with_name("fill").unlink()
    path.write_bytes(b"old")
    small_disk(left)
    like = image_of("Like", np.random.default_rng(0).random((99, 99, 4)))
    like.pack()
    like.use_fake_user = True
    with pytest.raises(ConvwassError, match=r"x\.|is full"):
        save_blend(path) if name == "x.blend" else save_pixels(np.array(like.pixels).reshape(99, 99, 4), like, path)
    assert path.read_bytes() == b"old"
    assert sorted(own.name for own in path.parent.iterdir()) == ["fill", name]


@pytest.mark.parametrize("output", ["make_volume", "make_cache", "make_cache usd"])
def test_a_morph_is_kept_if_its_files_do_not_fit(output, morph, small_disk):
    """Its meshes are removed only after the files exist; Alembic's writer would crash Blender."""
    frames = frame_objects(morph)
    name, *kind = output.split()
    arguments = {"kind": kind[0]} if kind else {}
    with pytest.raises(RuntimeError, match=r"Error: (?!Python)"):
        getattr(bpy.ops.convwass, name)(folder=str(small_disk(8192)), **arguments)
    assert frame_objects(morph) == frames


def test_a_result_is_moved_completely_or_not_at_all(tmp_path, small_disk):
    picture = tmp_path / "made.mp4"
    picture.write_bytes(bytes(100_000))
    target = small_disk() / "x.mp4"
    (target.parent / "fill").unlink()
    target.write_bytes(b"old")
    small_disk(8192)
    with pytest.raises(ConvwassError, match="No space left"):
        move_result(picture, target)
    assert target.read_bytes() == b"old"
    assert sorted(own.name for own in target.parent.iterdir()) == ["fill", "x.mp4"]


def test_free_space_is_checked_in_advance(tmp_path, monkeypatch):
    require_space(tmp_path, 1)
    monkeypatch.setattr(disk_space.shutil, "disk_usage", lambda _: _Usage(9, 9, 5_000_000))
    with pytest.raises(ConvwassError, match=r"has 5\.0 MB of free space, but up to 6\.0 MB are needed"):
        require_space(tmp_path, 6_000_000)
    (tmp_path / "a.abc").write_bytes(b"x")
    require_whole(tmp_path / "a.abc", tmp_path / "b.abc")
    monkeypatch.setattr(disk_space.shutil, "disk_usage", lambda _: _Usage(9, 9, 0))
    with pytest.raises(ConvwassError, match="is full"):
        require_whole(tmp_path / "a.abc", tmp_path / "b.abc")


@pytest.mark.skipif(sys.platform == "win32", reason="limits of the size of files are POSIX")
@pytest.mark.parametrize("name", ["x.blend", "x.usdc"])
def test_files_that_a_quota_truncates_are_refused(name, empty_scene, tmp_path):
    """There is free space, and Blender reports no error."""
    import resource

    bpy.ops.mesh.primitive_monkey_add()
    path = tmp_path / name
    path.write_bytes(b"old")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (8192, before[1]))
    try:
        with pytest.raises(ConvwassError, match=r"x\..* could not be written"):
            if path.suffix == ".blend":
                save_blend(path)
            else:
                with written_whole(path) as draft:
                    write_usd(str(draft))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]
    save_blend(path) if path.suffix == ".blend" else write_usd(str(path))
    require_whole(path, path)


@pytest.mark.parametrize("content", [b"", b"\x89PNG half", None])
def test_incomplete_files_are_detected(content, tmp_path):
    draft = tmp_path / "draft.png"
    if content is not None:
        draft.write_bytes(content)
    with pytest.raises(ConvwassError, match=r"x\.png could not be written"):
        require_whole(draft, tmp_path / "x.png")


ODD_PATHS = ("x" * 300, "d/" * 3000, "~nobody_at_all/x", "\0")
on_posix = pytest.mark.skipif(sys.platform == "win32", reason="Windows has other paths")


@on_posix
@pytest.mark.parametrize("path", ODD_PATHS)
def test_invalid_paths_are_refused(path, tmp_path):
    for use in (whole_path, FrameCache, checked_target):
        with pytest.raises(InputError, match="is no path of a file"):
            use(path)
    assert whole_path(tmp_path / "not there") == tmp_path / "not there"


@on_posix
def test_paths_may_begin_with_two_slashes(tmp_path):
    """As those of scripts that join a root of / and a path."""
    assert str(whole_path(f"/{tmp_path}/a.ply")) == f"{tmp_path}/a.ply"
    assert str(whole_path(f"//{tmp_path}/a.ply")) == f"{tmp_path}/a.ply"
    assert str(checked_target(f"/{tmp_path}/a.ply")) == f"{tmp_path}/a.ply"


@pytest.mark.parametrize("path", [".", "/", "", "..", "a/.."])
def test_folders_are_refused_as_files(path):
    with pytest.raises(InputError, match="is a folder"):
        path_with_suffix(path, ".blend")


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("a/horse", "a/horse.blend"),
        ("horse.blend", "horse.blend"),
        ("horse.BLEND", "horse.BLEND"),
        ("horse.v001", "horse.v001.blend"),
        ("horse.v002", "horse.v002.blend"),
        ("horse_0.5", "horse_0.5.blend"),
        (".horse", ".horse.blend"),
    ],
)
def test_suffixes_are_added_to_names_with_dots(path, expected):
    assert path_with_suffix(path, ".blend") == Path(expected)


@on_posix
@pytest.mark.usefixtures("empty_scene")
def test_operators_and_commands_report_invalid_paths(morph, capsys):
    for path in (*ODD_PATHS[:3], "/dev/null/x", "/proc/none/x", "//x"):
        for name in ("make_volume", "make_cache"):
            with pytest.raises(RuntimeError, match=r"Error: (?!Python)"):
                getattr(bpy.ops.convwass, name)(folder=path)
        assert main(["morph", path, path, "--out", path]) in (2, 3), path
        assert "Traceback" not in capsys.readouterr().err, path


@on_posix
@pytest.mark.usefixtures("empty_scene")
def test_names_that_are_not_utf_8_are_refused(tmp_path, capsys):
    shape = tmp_path / "horse.ply"
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.wm.ply_export(filepath=str(shape))
    odd = tmp_path / "pferd_\udcfc.ply"
    shutil.copy(shape, odd)
    for words in ([str(odd), str(shape)], [str(shape), str(shape), "--out", str(odd)]):
        assert main(["morph", *words, "--resolution", "8", "--frames", "2", "--motion", "transport"]) == 3
        said = capsys.readouterr().err
        assert r"pferd_\udcfc.ply" in said
        assert "is not UTF-8" in said


def test_system_errors_become_messages():
    told = error_to_tell(FileNotFoundError(2, "No such file or directory", "/a/b"))
    assert str(told) == "/a/b cannot be read or written: No such file or directory."
    assert str(error_to_tell(OSError(28, "No space left"))) == "The system refused to read or write: No space left."
    assert isinstance(error_to_tell(MemoryError()), ResourceError)
    same = InputError("x")
    assert error_to_tell(same) is same
    assert error_to_tell(ZeroDivisionError()) is None
    assert error_to_tell(KeyboardInterrupt()) is None


def test_commands_report_system_errors(monkeypatch, capsys):
    def fail(*_):
        raise OSError(28, "No space left on device", "/full/x")

    monkeypatch.setattr("convwass_addon.cli.morph_command.given_settings", fail)
    assert main(["morph", "a", "b", "--out", "c"]) == 1
    assert "convwass: /full/x cannot be read or written: No space left on device." in capsys.readouterr().err
