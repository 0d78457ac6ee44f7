# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own tool for building and validating extensions, taken out of the ``bpy`` package without loading it."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path


class BuilderError(Exception):
    """Blender's tool refused; the message is what it printed."""


def build(source: Path, *, output: Path, split_platforms: bool = False) -> None:
    """Build the extension whose manifest lies in `source`.

    Parameters
    ----------
    source : Path
        Folder with ``blender_manifest.toml``.
    output : Path
        Folder for the zip files; made where it is missing.
    split_platforms : bool
        One zip for each of the manifest's platforms, with the wheels that fit it, instead of one with everything.

    Raises
    ------
    BuilderError
        If the manifest or the files are not as Blender wants them.
    """
    output.mkdir(parents=True, exist_ok=True)
    options = ["--split-platforms"] if split_platforms else []
    _call("build", "--source-dir", str(source), "--output-dir", str(output), *options)


def validate(extension: Path) -> None:
    """Check a zip file, or a folder with a manifest, as Blender would on installing it.

    Raises
    ------
    BuilderError
        If it would be refused.
    """
    _call("validate", str(extension))


def _call(*arguments: str) -> None:
    command = [sys.executable, str(program()), *arguments]
    answer = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    if answer.returncode:
        raise BuilderError(answer.stdout.strip())


def program() -> Path:
    """Return where the builder is that comes with Blender; raises BuilderError where there is none."""
    spec = importlib.util.find_spec("bpy")
    folders = map(Path, (spec and spec.submodule_search_locations) or ())
    for folder in folders:
        for found in folder.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"):
            return found
    raise BuilderError("Blender's extension builder was not found: this needs the Python that run.py sets up")
