# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Track the files written by a bake, so that a later bake can remove surplus ones."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import bpy

from ...stored_json import table_stored_with

WRITTEN_KEY = "convwass_written"
"""Custom property of a morph's collection: names and digests of the written files."""


def store_written(morph: bpy.types.Collection, files: Sequence[Path]) -> None:
    """Store which files a morph has written, all in one folder."""
    morph[WRITTEN_KEY] = json.dumps({path.name: _digest(path) for path in files})


def drop_surplus(morph: bpy.types.Collection, folder: Path, stem: str, kept: Sequence[Path]) -> None:
    """Remove numbered files of an earlier bake that a later bake has not written again.

    Only unchanged files are removed: files that were modified, or added by others, are kept.

    Parameters
    ----------
    morph : bpy.types.Collection
        The earlier bake; its stored data may come from any file and is not trusted.
    folder : Path
        The folder of the later bake.
    stem : str
        Common prefix of the file names, before the number.
    kept : sequence of Path
        The files of the later bake.
    """
    names = {path.name for path in kept}
    for name, digest in table_stored_with(morph, WRITTEN_KEY).items():
        number = name.removeprefix(f"{stem}_").removesuffix(".png")
        if name in names or name != f"{stem}_{number}.png" or not (number.isascii() and number.isdigit()):
            continue
        path = folder / name
        # Files that cannot be read or removed are kept.
        with suppress(OSError):
            if path.is_file() and not path.is_symlink() and _digest(path) == digest:
                path.unlink()


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()[:32]
