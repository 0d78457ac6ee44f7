# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The files that the command ``morph`` reads and writes."""

from __future__ import annotations

import glob
from argparse import Namespace
from pathlib import Path

import bpy

from ..bridge.files.imports import parse_source
from ..bridge.files.numbered_files import numbered_paths
from ..bridge.files.output_paths import checked_folder, checked_target
from ..bridge.flat.flat_imports import TEXT
from ..bridge.morphs.outputs import ON_DISK, folder_beside


def files_read(options: Namespace) -> list[Path]:
    """Return the files of the shapes and guides; some may not exist."""
    names = [text for text in options.shapes if not text.startswith(TEXT)]
    guides = [] if options.guides is None else [Path(options.guides)]
    return [parse_source(text).path for text in names] + guides


def files_written(options: Namespace, target: Path, count: int) -> list[Path]:
    """Return the files that a morph may replace, which are checked before the work begins.

    Parameters
    ----------
    options : Namespace
        The options of the command.
    target : Path
        The .blend to write.
    count : int
        Number of blends.

    Raises
    ------
    InputError
        A file or the folder for other outputs cannot be written.
    """
    rendered = [checked_target(target.with_suffix(suffix)) for suffix in (".png", ".mp4")] if options.render else []
    exported = _exported(options.export, count) if options.export else []
    # Its files are named after the morph.
    folder = Path(bpy.path.abspath(folder_beside(target), start=str(target.parent)))
    if options.output in ON_DISK:
        checked_folder(folder)
    return [target, *rendered, *exported, *folder.rglob("*")]


def _exported(path: Path, count: int) -> list[Path]:
    """Return the files of an export: a single one, one per blend, or one with others next to it."""
    beside = path.parent.glob(f"{glob.escape(path.stem)}_*.*") if path.suffix.lower() == ".json" else []
    numbered = numbered_paths(path.parent, f"{path.stem}_", path.suffix, range(1, count + 1))
    return [*map(checked_target, [path, *numbered]), *beside]
