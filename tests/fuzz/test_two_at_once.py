# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two jobs at once: in two processes that write the same files, and in one Blender, where one is refused."""

from __future__ import annotations

import shutil
import subprocess
import sys

import bpy
import pytest

from convwass_addon.operators.background import BackgroundOperator
from convwass_addon.operators.shape_checks import ChecksShapes
from tests.fuzz.job_cases import CASES, kinds_of, prepare
from tests.fuzz.killed_jobs import run
from tests.fuzz.test_killed import written

pytestmark = pytest.mark.usefixtures("empty_scene")

NEVER = "1000000"


def test_two_processes_that_write_the_same_files_leave_complete_ones(project, tmp_path):
    name = "blend_skies"
    run(name, tmp_path)
    wanted = written(tmp_path)
    shutil.rmtree(tmp_path / "out")
    command = [sys.executable, "-m", "tests.fuzz.killed_jobs", name, str(tmp_path), NEVER]
    children = [
        subprocess.Popen(command, cwd=project, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) for _ in range(2)
    ]
    said = [child.communicate()[0].decode() for child in children]
    assert [child.returncode for child in children] == [0, 0], said
    assert written(tmp_path) == wanted
    assert not list(tmp_path.rglob(".convwass-*"))


def operators():
    """All that start a job; during another one, shapes are checked at once (tests/operators/test_morph_inputs.py)."""
    kinds = set(kinds_of(BackgroundOperator)) - set(kinds_of(ChecksShapes))
    return sorted({kind.bl_idname for kind in kinds if hasattr(kind, "bl_idname")})


def test_every_kind_of_job_is_covered():
    assert {name.split()[0] for name in CASES} <= {name.split(".")[1] for name in operators()}


@pytest.mark.parametrize("name", CASES)
def test_no_second_job_can_start_during_a_job(name, tmp_path):
    """For any pair of jobs: the second is available before and after the first, and disabled meanwhile."""
    work = prepare(name, tmp_path)
    operator = getattr(bpy.ops.convwass, name.split()[0])
    progress = bpy.context.window_manager.convwass_progress
    assert operator.poll()
    progress.running = True
    try:
        assert not [own for own in operators() if getattr(bpy.ops.convwass, own.split(".")[1]).poll()]
        with pytest.raises(RuntimeError, match="poll"):
            work()
    finally:
        progress.running = False
    assert operator.poll()
