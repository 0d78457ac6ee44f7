# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake has written beside the .blend, so that the next one in its place takes away what it has no use for."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import bpy

WRITTEN_KEY = "convwass_written"
"""Custom property of a morph's collection: names of files, and digests of what was written to them."""


def store_written(morph: bpy.types.Collection, files: Sequence[Path]) -> None:
    """Note on a morph which files it has written, all in one folder."""
    morph[WRITTEN_KEY] = json.dumps({path.name: _digest(path) for path in files})


def drop_surplus(morph: bpy.types.Collection, folder: Path, stem: str, kept: Sequence[Path]) -> None:
    """Remove those numbered files of an earlier bake from a folder that a later one has not written again.

    Only files that hold what the earlier bake wrote to them: one that was painted over, or put there by anybody else,
    stays.

    Parameters
    ----------
    morph : bpy.types.Collection
        The earlier bake; what is noted on it may come from any file, and is not trusted.
    folder : Path
        Where the later one has written.
    stem : str
        What the names of its files begin with, before the number.
    kept : sequence of Path
        The files of the later bake.
    """
    names = {path.name for path in kept}
    for name, digest in _noted(morph).items():
        number = name.removeprefix(f"{stem}_").removesuffix(".png")
        if name in names or name != f"{stem}_{number}.png" or not (number.isascii() and number.isdigit()):
            continue
        path = folder / name
        # What cannot be read or removed is left.
        with suppress(OSError):
            if path.is_file() and not path.is_symlink() and _digest(path) == digest:
                path.unlink()


def _noted(morph: bpy.types.Collection) -> dict[str, str]:
    try:
        found = json.loads(morph.get(WRITTEN_KEY, "{}"))
    except (TypeError, ValueError, RecursionError):
        return {}
    if not isinstance(found, dict):
        return {}
    return {name: digest for name, digest in found.items() if isinstance(digest, str)}


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()[:32]
