# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes that are killed go on from what they have left, and bakes that share a cache do each other no harm."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest

from convwass_addon.applications.morphs.frame_cache import FrameCache, SpareFrameCache
from convwass_addon.applications.morphs.runs import RUN_LENGTH
from tests.applications.test_frame_cache import assert_same
from tests.fuzz.killed_bake import FRAMES, bake


@pytest.fixture(scope="module")
def uninterrupted():
    return bake(None)


def started(project, folder):
    return subprocess.Popen([sys.executable, "-m", "tests.fuzz.killed_bake", str(folder)], cwd=project)


def wait_for_frames(folder, count, child):
    """Wait until so many are there, or the child has ended."""
    while child.poll() is None and len(list(folder.glob("*.frame"))) < count:
        time.sleep(0.005)


@pytest.mark.skipif(sys.platform == "win32", reason="kills as only POSIX does")
@pytest.mark.parametrize("count", [1, 6])
def test_a_bake_that_is_killed_goes_on_from_its_cache(count, project, tmp_path, uninterrupted):
    child = started(project, tmp_path)
    wait_for_frames(tmp_path, count, child)
    child.kill()
    child.wait()
    cache = FrameCache(tmp_path)
    assert_same(bake(cache), uninterrupted)
    # Frames are read where all of a run are there.
    assert count // RUN_LENGTH * RUN_LENGTH <= cache.reused <= FRAMES + 1
    assert not cache.notices


def test_two_processes_fill_one_cache(project, tmp_path, uninterrupted):
    children = [started(project, tmp_path) for _ in range(2)]
    assert_same(bake(FrameCache(tmp_path)), uninterrupted)
    assert [child.wait() for child in children] == [0, 0]
    assert_same(bake(FrameCache(tmp_path)), uninterrupted)
    assert len(list(tmp_path.glob("*"))) == FRAMES + 1


def test_what_killed_bakes_were_about_to_write_is_dropped_after_a_day(tmp_path):
    old, new = tmp_path / ".old.part", tmp_path / ".new.part"
    for path in (old, new):
        path.write_bytes(b"half")
    os.utime(old, (0, 0))
    SpareFrameCache(tmp_path, 1 << 20)
    assert not old.exists() and new.exists()
