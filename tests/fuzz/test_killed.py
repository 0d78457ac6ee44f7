# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Killed bakes continue from their cached frames, and bakes that share a cache do not interfere."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.runs import RUN_LENGTH
from tests.applications.test_frame_cache import assert_same
from tests.fuzz.job_cases import CASES, call
from tests.fuzz.killed_bake import FRAMES, bake
from tests.fuzz.killed_jobs import run


@pytest.fixture(scope="module")
def uninterrupted():
    return bake(None)


def started(project, folder):
    return subprocess.Popen([sys.executable, "-m", "tests.fuzz.killed_bake", str(folder)], cwd=project)


def wait_for_frames(folder, count, child):
    """Wait until this many frames exist or the child has ended."""
    while child.poll() is None and len(list(folder.glob("*.frame"))) < count:
        time.sleep(0.005)


@pytest.mark.skipif(sys.platform == "win32", reason="kills as only POSIX does")
def test_a_killed_bake_continues_from_its_cache(project, tmp_path, uninterrupted):
    count = 6
    child = started(project, tmp_path)
    wait_for_frames(tmp_path, count, child)
    child.kill()
    child.wait()
    cache = FrameCache(tmp_path)
    assert_same(bake(cache), uninterrupted)
    # Frames are reused only if their run is complete.
    assert count // RUN_LENGTH * RUN_LENGTH <= cache.reused <= FRAMES + 1
    assert not cache.notices


def test_two_processes_fill_one_cache(project, tmp_path, uninterrupted):
    children = [started(project, tmp_path) for _ in range(2)]
    assert_same(bake(FrameCache(tmp_path)), uninterrupted)
    assert [child.wait() for child in children] == [0, 0]
    assert_same(bake(FrameCache(tmp_path)), uninterrupted)
    assert len(list(tmp_path.glob("*"))) == FRAMES + 1


def killed(project, name, folder, step):
    """Run work in a Blender process that is killed at a step."""
    command = [sys.executable, "-m", "tests.fuzz.killed_jobs", name, str(folder), str(step)]
    done = subprocess.run(command, cwd=project, capture_output=True)
    assert done.returncode == -signal.SIGKILL, done.stderr.decode()


def drafts(folder):
    return [path for path in folder.iterdir() if path.name.startswith(".")]


@pytest.mark.skipif(sys.platform == "win32", reason="kills as only POSIX does")
@pytest.mark.usefixtures("empty_scene")
@pytest.mark.parametrize(
    ("name", "step", "files"),
    [
        ("sky", 3, ["sky.0001.exr", "sky.0002.exr", "sky.0003.exr"]),
        ("export", 1, [f"rise_{number:04d}.{kind}" for number in (1, 2, 3) for kind in ("mtl", "obj")]),
    ],
)
def test_files_survive_a_killed_blender_and_the_next_one_cleans_up(name, step, files, project, tmp_path):
    for file in files:
        (tmp_path / file).write_text("older")
    killed(project, name, tmp_path, step)
    assert all((tmp_path / file).read_text() == "older" for file in files)
    left = drafts(tmp_path)
    assert left
    for draft in left:
        os.utime(draft, (0, 0))
    run(name, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == files
    assert all((tmp_path / file).stat().st_size > 100 for file in files)


@pytest.mark.skipif(sys.platform == "win32", reason="kills as only POSIX does")
@pytest.mark.usefixtures("empty_scene")
@pytest.mark.parametrize(
    ("name", "moments"),
    [
        ("bake_morph pictures", [("", 2)]),
        ("recolor_clip", [("placing: ", 1)]),
    ],
)
def test_of_work_that_is_killed_no_half_file_is_left_and_the_next_one_makes_all_of_them(
    name, moments, project, tmp_path
):
    run(name, tmp_path / "whole")
    wanted = written(tmp_path / "whole")
    assert len(wanted) >= 3
    for number, (kind, step) in enumerate(moments):
        folder = tmp_path / str(number)
        folder.mkdir()
        killed(project, kind + name, folder, step)
        found = written(folder)
        assert found.items() <= wanted.items()
        assert len(found) == (step if kind else 0)
        for left in folder.rglob(".convwass-*"):
            os.utime(left, (0, 0))
        bpy.ops.wm.read_factory_settings(use_empty=True)
        run(name, folder)
        assert written(folder) == wanted
        assert not list(folder.rglob(".convwass-*"))


def written(folder):
    """Return the contents of all written files except drafts."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in (folder / "out").rglob("*")
        if path.is_file() and not any(part.startswith(".convwass-") for part in path.parts)
    }


@pytest.mark.skipif(sys.platform == "win32", reason="kills as only POSIX does")
@pytest.mark.usefixtures("empty_scene")
def test_the_file_on_disk_is_unchanged_and_the_work_can_be_repeated(project, tmp_path):
    """Repeating the killed work from the saved scene gives the same result as without the interruption."""
    name = "bake_morph"
    (tmp_path / "whole").mkdir()
    run(name, tmp_path / "whole")
    wanted = positions_of_all()
    (tmp_path / "cut").mkdir()
    killed(project, name, tmp_path / "cut", 1)
    assert [path.name for path in (tmp_path / "cut").iterdir()] == ["work.blend"]
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "cut" / "work.blend"))
    bpy.ops.object.select_all(action="SELECT")
    assert call(name, **CASES[name][1]) == {"FINISHED"}
    found = positions_of_all()
    assert found.keys() == wanted.keys()
    for key, points in wanted.items():
        np.testing.assert_allclose(found[key], points, atol=1e-6)


def positions_of_all():
    """Return the points of all meshes and bones by name."""
    found = {mesh.name: np.array([vertex.co for vertex in mesh.vertices]) for mesh in bpy.data.meshes}
    found |= {f"{rig.name} bones": np.array([bone.tail_local for bone in rig.bones]) for rig in bpy.data.armatures}
    return found
