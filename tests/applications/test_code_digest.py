# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames computed by other code are not used."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import convwass_addon
from convwass_addon.applications.morphs.code_digest import code_digest, digest_of, digested_files
from convwass_addon.errors import InputError
from tests.tooling.test_architecture import imports_of

PACKAGE = Path(convwass_addon.__file__).parent
NAME_FRAMES = """
import sys
from pathlib import Path
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.geometry.meshes.mesh import TriangleMesh

shape = TriangleMesh.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 2, 1]])
inputs = MorphInputs.of([shape, shape], ["a", "b"])
cache = FrameCache(Path(sys.argv[1])).of(inputs, MorphSettings(motion="transport"))
print(*(path.name for path in cache.paths(path_blends(2, 3))))
"""


@pytest.fixture
def copied(tmp_path) -> Path:
    target = tmp_path / "copy" / "convwass_addon"
    shutil.copytree(PACKAGE, target, ignore=shutil.ignore_patterns("__pycache__", "presets", "translations"))
    return target


def change_one_byte(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[content.index(b"#") + 2] ^= 1
    path.write_bytes(content)


def frame_names(package: Path, folder: Path) -> list[str]:
    environment = {**os.environ, "PYTHONPATH": str(package.parent), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-c", NAME_FRAMES, str(folder)]
    return subprocess.run(
        command, cwd=package.parent, env=environment, capture_output=True, text=True, check=True
    ).stdout.split()


def test_a_byte_of_the_solver_renames_every_frame(copied, tmp_path):
    before = frame_names(copied, tmp_path / "frames")
    change_one_byte(copied / "transport" / "bregman.py")
    after = frame_names(copied, tmp_path / "frames")
    assert len(before) == len(after) == 4
    assert not set(before) & set(after)


def test_the_digest_is_of_this_code(copied):
    assert digest_of(copied) == code_digest()


@pytest.mark.parametrize(
    "changed", ["transport/grid.py", "geometry/level_sets/mending.py", "applications/morphs/volumes.py", "progress.py"]
)
def test_a_byte_anywhere_changes_it(copied, changed):
    change_one_byte(copied / changed)
    assert digest_of(copied) != code_digest()


def test_a_file_that_is_added_or_renamed_counts(copied):
    before = digest_of(copied)
    (copied / "geometry" / "another.py").touch()
    added = digest_of(copied)
    (copied / "geometry" / "another.py").rename(copied / "geometry" / "renamed.py")
    assert len({before, added, digest_of(copied)}) == 3


def test_line_endings_and_other_packages_do_not_change_it(copied):
    before = digest_of(copied)
    path = copied / "transport" / "grid.py"
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    change_one_byte(copied / "panels" / "morph.py")
    assert digest_of(copied) == before


@pytest.mark.parametrize("missing", ["transport", "geometry", "applications", "progress.py"])
def test_a_package_without_its_sources_is_refused(copied, missing):
    path = copied / missing
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    with pytest.raises(InputError, match=f"{missing} are missing"):
        digest_of(copied)


def test_all_that_frames_are_computed_with_is_in():
    """Whatever the modules that make frames import of the package, however far away, is among the files."""
    reached, waiting = set(), ["applications/morphs/morph.py", "applications/morphs/between_frames.py"]
    while waiting:
        module = waiting.pop()
        if module in reached:
            continue
        reached.add(module)
        for _, name in imports_of(module):
            first, *parts = name.split("/")
            if first == ".":
                tried = [
                    Path(*parts).with_suffix(".py"),
                    Path(*parts[:-1]).with_suffix(".py"),
                    Path(*parts, "__init__.py"),
                ]
                waiting += [path.as_posix() for path in tried if (PACKAGE / path).is_file()]
    found = {path.relative_to(PACKAGE).as_posix() for path in digested_files(PACKAGE)}
    assert len(reached) > 50
    assert reached - found == set()
