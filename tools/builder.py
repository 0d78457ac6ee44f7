# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own tool for building and validating extensions, called from the ``bpy`` package without importing it."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path


class BuilderError(Exception):
    """Blender's tool failed; the message is its output."""


def build(source: Path, *, output: Path, split_platforms: bool = False) -> None:
    """Build the extension from the folder of its manifest.

    Parameters
    ----------
    source : Path
        Folder with ``blender_manifest.toml``.
    output : Path
        Folder for the zip files; created if missing.
    split_platforms : bool
        Build one zip per platform of the manifest, with the wheels for it, instead of one with everything.

    Raises
    ------
    BuilderError
        If Blender's tool rejects the manifest or the files.
    """
    output.mkdir(parents=True, exist_ok=True)
    options = ["--split-platforms"] if split_platforms else []
    _call("build", "--source-dir", str(source), "--output-dir", str(output), *options)


def validate(extension: Path) -> None:
    """Check a zip file, or a folder with a manifest, as Blender does when installing it.

    Raises
    ------
    BuilderError
        If Blender would reject it.
    """
    _call("validate", str(extension))


def _call(*arguments: str) -> None:
    command = [sys.executable, str(program()), *arguments]
    answer = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    if answer.returncode:
        raise BuilderError(answer.stdout.strip())


def program() -> Path:
    """Return the path of the builder that comes with Blender; raises BuilderError if it is missing."""
    spec = importlib.util.find_spec("bpy")
    folders = map(Path, (spec and spec.submodule_search_locations) or ())
    for folder in folders:
        for found in folder.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"):
            return found
    raise BuilderError("Blender's extension builder was not found: this needs the Python that run.py sets up")
