# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A later version installed over an earlier one: settings, presets, caches and work are kept.

The earlier version is this one with a smaller number, or the zip given by ``--from-zip``. A third version differs from
this one by a single byte of the solver.
"""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

EARLIER = "0.0.9"
LATER = "99.0.0"
SOLVER = "transport/bregman.py"
PREFERRED = {"cache_folder": "", "spare_megabytes": 77, "threads": 1, "default_preset": "Mine ä"}


@pytest.fixture(scope="module")
def earlier_zip(request, zip_file, tmp_path_factory) -> Path:
    given = request.config.getoption("--from-zip", None)
    if given is not None:
        return given.resolve()
    target = tmp_path_factory.mktemp("earlier") / "convwass-earlier.zip"
    return with_version(zip_file, target, EARLIER)


@pytest.fixture(scope="module")
def changed_zip(zip_file, tmp_path_factory) -> Path:
    """A later version with one changed byte in the solver."""
    target = tmp_path_factory.mktemp("changed") / "convwass-changed.zip"
    return with_version(zip_file, target, LATER, changed=f"convwass_addon/{SOLVER}")


def with_version(zip_file: Path, target: Path, version: str, changed: str | None = None) -> Path:
    """Copy a zip with another version number, and add a line break to the file `changed`."""
    touched = 0
    with zipfile.ZipFile(zip_file) as source, zipfile.ZipFile(target, "w") as copy:
        for entry in source.infolist():
            content = source.read(entry)
            if entry.filename == "blender_manifest.toml":
                content, count = re.subn(rb'(?m)^version = ".*"$', f'version = "{version}"'.encode(), content)
                touched += count
            if entry.filename == changed:
                content += b"\n"
                touched += 1
            copy.writestr(entry, content)
    assert touched == 1 + (changed is not None)
    return target


@pytest.fixture(scope="module")
def work(profile) -> Path:
    return profile.folder.parent / "Work"


@pytest.fixture(scope="module")
def before(profile, earlier_zip, zip_file, work, is_same_code) -> dict:
    """The report of a session with the earlier version, which ends with installing this one.

    It makes only morphs if both have the same code.
    """
    return profile.run(
        ("install", [str(earlier_zip)]),
        ("clear", []),
        ("prefer", [PREFERRED]),
        ("add_preset", ["Mine ä", 41]),
        ("clear", []),
        ("make", [str(work), "morphs" if is_same_code else ""]),
        ("figures", []),
        ("version", []),
        ("own_files", []),
        ("leave_module", [str(profile.extension)]),
        ("install", [str(zip_file)]),
    )


@pytest.fixture(scope="module")
def after(before, profile, work) -> dict:
    """The report of the first session with this version."""
    return profile.run(
        ("version", []),
        ("preferred", []),
        ("presets", []),
        ("own_files", []),
        ("open_file", [str(work)]),
        ("figures", []),
        ("panels", []),
        ("polls", []),
        ("bake_again", ["Morph objects ball to objects box"]),
        ("bake_again", ["Morph player ball to player box"]),
        ("own_files", []),
        ("figures", []),
    )


@pytest.fixture(scope="module")
def changed(after, profile, changed_zip, earlier_zip, work) -> dict:
    """The report of a session after the solver has changed, which ends with the earlier version."""
    return profile.run(
        ("install", [str(changed_zip)]),
        ("open_file", [str(work)]),
        ("bake_again", ["Morph objects ball to objects box"]),
        ("own_files", []),
        ("install", [str(earlier_zip)]),
        ("version", []),
        ("preferred", []),
        ("presets", []),
    )


@pytest.fixture(scope="module")
def is_same_code(request) -> bool:
    return request.config.getoption("--from-zip", None) is None


PLAYER = "Morph player ball to player box Player"


def assert_same(one: dict, other: dict) -> None:
    for frame, own in one.items():
        assert own.keys() <= other[frame].keys()
        for name, numbers in own.items():
            np.testing.assert_allclose(other[frame][name], numbers, rtol=2e-3, atol=0.01, err_msg=f"{frame}: {name}")


def test_the_later_version_replaces_the_earlier(before, after, profile):
    assert before["install"] == [True, True]
    assert before["version"] != after["version"]
    assert not (profile.extension / "convwass_addon" / "of_the_earlier_version.py").exists()


def test_preferences_are_kept(after):
    assert {name: after["preferred"][name] for name in PREFERRED} == PREFERRED


def test_presets_are_kept(after):
    assert after["presets"]["Mine ä"] == 41
    assert set(after["presets"]) == {"Draft", "Standard", "Fine", "Mine ä"}


def test_cached_frames_are_kept(before, after):
    assert before["own_files"]
    assert before["own_files"].items() <= after["own_files"].items()


def test_work_opens_and_plays(before, after):
    assert_same(before["figures"], after["figures"])


def test_work_is_known_and_can_be_baked_again(after, is_same_code):
    assert after["polls"]["rebake_morph"] and after["panels"]["CONVWASS_PT_baked_morph"]
    assert after["bake_again"] == after["bake_again 2"] == ["FINISHED"]
    if is_same_code:
        # The frames themselves are new objects.
        assert_same({frame: {PLAYER: own[PLAYER]} for frame, own in after["figures"].items()}, after["figures 2"])


def test_frames_of_the_same_code_are_reused(before, after, is_same_code):
    if not is_same_code:
        pytest.skip("another version may compute other frames")
    assert before["own_files"] == after["own_files 2"]


def test_frames_of_another_solver_are_not_reused(after, changed):
    assert changed["bake_again"] == ["FINISHED"]
    assert after["own_files 2"].items() < changed["own_files"].items()


def test_a_file_that_the_earlier_version_saved_needs_no_extension(before, stranger, work, is_same_code):
    if is_same_code:
        pytest.skip("what this code saves is opened without it in test_installed.py")
    found = stranger.run(("open_file", [str(work)]), ("figures", []), ("leftovers", []))
    assert_same(before["figures"], found["figures"])
    assert {name: own for name, own in found["leftovers"].items() if own} == {}


def test_an_earlier_version_can_be_restored(before, after, changed):
    assert changed["version"] == before["version"] != after["version"]
    assert changed["preferred"] == after["preferred"]
    assert changed["presets"] == after["presets"]
