# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""User profiles, and Blender sessions in them."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest

from tools import package

SESSION = Path(__file__).with_name("session.py")

Step = tuple[str, Sequence[object]]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--zip",
        type=Path,
        help="install this zip, with the wheels for this machine, into a Python that has nothing but Blender; without "
        "it the small zip is built, and SciPy comes from the environment",
    )
    parser.addoption("--from-zip", type=Path, help="the version to upgrade from, instead of this one's own code")


@dataclass(frozen=True)
class Profile:
    """A user's Blender settings, and the sessions that use them.

    Attributes
    ----------
    folder : Path
        Folder of the profile.
    site : Path or None
        The packages available to sessions; None for those of this Python.
    """

    folder: Path
    site: Path | None

    @property
    def extension(self) -> Path:
        """Where the extension is installed."""
        return self.folder / "extensions" / "user_default" / "convwass"

    def run(self, *steps: Step) -> dict:
        """Run the steps in a new process, and return their results."""
        report = self.folder / "report.json"
        site = [] if self.site is None else ["-S"]
        session = subprocess.run(
            [sys.executable, "-I", *site, str(SESSION), str(report), str(self.site or ""), json.dumps(steps)],
            cwd=self.folder,
            env={**os.environ, "BLENDER_USER_RESOURCES": str(self.folder), "OPENBLAS_NUM_THREADS": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=1200,
        )
        # Blender 4.5 may not end normally; only the report counts.
        assert report.exists(), session.stdout
        told = json.loads(report.read_text(encoding="utf-8"))
        report.unlink()
        return {**told, "said": session.stdout}


@pytest.fixture(scope="session")
def site(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path | None:
    """A folder with only Blender and its own dependencies; None if the zip includes no wheels."""
    if request.config.getoption("--zip", None) is None:
        return None
    folder = tmp_path_factory.mktemp("site")
    for name in sorted(needed_by("bpy")):
        own = distribution(name)
        tops = {file.parts[0] for file in own.files or () if file.parts[0] not in ("..", "__pycache__")}
        for top in tops:
            link = folder / top
            if not link.exists():
                link.symlink_to(own.locate_file(top))
    return folder


def needed_by(name: str) -> set[str]:
    """Return the installed names of a package and of all its dependencies."""
    found, open_names = set(), {name}
    while open_names:
        current = open_names.pop()
        try:
            requirements = distribution(current).requires or []
        except PackageNotFoundError:  # for another Python version, or an extra
            continue
        found.add(current)
        names = {re.match(r"[\w.-]+", text)[0].lower() for text in requirements if "extra ==" not in text}
        open_names |= names - found
    return found


@pytest.fixture(scope="session")
def zip_file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The zip to install."""
    given = request.config.getoption("--zip", None)
    if given is not None:
        return given.resolve()
    folder = tmp_path_factory.mktemp("built")
    return package.build_small(folder / "work", folder / "dist")


@pytest.fixture(scope="module")
def profile(tmp_path_factory: pytest.TempPathFactory, site: Path | None):
    """The profile of a user whose name has spaces and non-ASCII letters."""
    made = new_profile(tmp_path_factory, site)
    yield made
    unlock(made.folder)


@pytest.fixture(scope="module")
def stranger(tmp_path_factory: pytest.TempPathFactory, site: Path | None) -> Profile:
    """The profile of a user who never had the extension."""
    return new_profile(tmp_path_factory, site)


def new_profile(tmp_path_factory: pytest.TempPathFactory, site: Path | None) -> Profile:
    folder = tmp_path_factory.mktemp("extension") / "Zoë Łukasz 山田" / "Blender settings"
    folder.mkdir(parents=True)
    return Profile(folder, site)


def unlock(folder: Path) -> None:
    """Make what a session has locked removable."""
    for path in [folder, *folder.rglob("*")]:
        if not path.is_symlink():
            path.chmod(0o755 if path.is_dir() else 0o644)
    shutil.rmtree(folder, ignore_errors=True)
