# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension as a user gets it: built, installed from the zip into a clean profile, used, and removed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tools import package


@pytest.fixture(scope="module")
def profile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder for one user's Blender settings, of a user whose name is not made for computers."""
    folder = tmp_path_factory.mktemp("extension") / "Zoë Łukasz 山田" / "Blender settings"
    folder.mkdir(parents=True)
    return folder


@pytest.fixture(scope="module")
def seen(profile: Path, tmp_path_factory: pytest.TempPathFactory) -> dict:
    """What one session with the installed extension saw."""
    folder = tmp_path_factory.mktemp("session")
    extension = package.build_small(folder / "work", folder / "dist")
    report = folder / "report.json"
    script = Path(__file__).with_name("installed_session.py")
    session = subprocess.run(
        [sys.executable, "-I", str(script), str(extension), str(report)],
        cwd=folder,
        env={**os.environ, "BLENDER_USER_RESOURCES": str(profile)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        timeout=600,
    )
    assert session.returncode == 0, session.stdout
    return json.loads(report.read_text(encoding="utf-8"))


def test_installing_enables_it(seen):
    assert not seen["offered before"]
    assert seen["enabled"] == [True, True]
    assert seen["offered"]


def test_it_runs_from_where_it_was_installed(seen, profile):
    assert Path(seen["module file"]).is_relative_to(profile)
    assert not seen["imported from the checkout"]


def test_bake_shows_one_mesh_at_a_time(seen):
    assert seen["baked"] == ["FINISHED"]
    assert set(seen["shown"]) == {1}
    assert len(seen["shown"]) >= 4


def test_disabling_takes_the_operator_away_and_leaves_the_bake(seen):
    assert not seen["offered while disabled"]
    assert seen["shown while disabled"] == seen["shown"]


def test_removing_leaves_nothing_behind(seen):
    assert seen["offered again"]
    assert not seen["offered after removal"]
    assert not seen["left behind"]
