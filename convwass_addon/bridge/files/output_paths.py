# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check output paths, and save .blend files atomically."""

from __future__ import annotations

import os
import zlib
from pathlib import Path

import bpy

from ...applications.whole_paths import whole_path
from ...drafts import written_whole
from ...errors import InputError

# Bytes of a name in UTF-8 that leave room for numbers, extensions and the names of drafts in the 255 that Linux allows.
_LONGEST = 180


def file_stem(name: str) -> str:
    """Return a name for files in plain letters and digits; long ones are cut and end in a checksum instead."""
    stem = bpy.path.clean_name(name)
    content = stem.encode(errors="ignore")
    if len(content) <= _LONGEST:
        return stem
    return f"{content[:_LONGEST].decode(errors='ignore')}_{zlib.crc32(content):08x}"


def checked_target(path: Path) -> Path:
    """Return the absolute path of an output file.

    Raises
    ------
    InputError
        The folder does not exist, is a file or cannot be written, or the path is a folder or a protected file.
    """
    target = whole_path(path)
    if target.is_dir():
        raise InputError("{target} is a folder; add a file name to it.", target=str(target))
    _require_folder(target.parent)
    _require_writable(target.parent)
    # Drafts would replace it all the same, on other systems than Windows.
    if target.exists() and not os.access(target, os.W_OK):
        raise InputError("{target} is protected from being overwritten; write to another file.", target=str(target))
    return target


def _require_folder(folder: Path) -> None:
    """Raise InputError unless a folder exists."""
    _refuse_file(folder)
    if not folder.is_dir():
        raise InputError(
            "The folder {folder} does not exist; create it first, or choose another one.", folder=str(folder)
        )


def _require_writable(folder: Path) -> None:
    """Raise InputError unless files can be created in a folder."""
    if not os.access(folder, os.W_OK):
        raise InputError("The folder {folder} cannot be written to; choose another one.", folder=str(folder))


def _refuse_file(folder: Path) -> None:
    """Raise InputError if a file is where a folder should be."""
    if folder.exists() and not folder.is_dir():
        raise InputError("{folder} is a file; choose a folder.", folder=str(folder))


def absolute_path(path: str | Path) -> Path:
    """Return the absolute path of a file or folder that a user has entered, which need not exist.

    Parameters
    ----------
    path : str or Path
        // stands for the folder of the .blend file.

    Raises
    ------
    InputError
        The path is relative to an unsaved file.
    """
    text = str(path)
    if text.startswith("//") and not bpy.data.filepath:
        raise InputError(
            "Save the file first, since {folder} is relative to it, or choose an absolute path.", folder=text
        )
    return whole_path(bpy.path.abspath(text))


def absolute_folder(folder: str | Path) -> Path:
    """Return the absolute path of an output folder, which need not exist.

    Parameters
    ----------
    folder : str or Path
        // stands for the folder of the .blend file.

    Raises
    ------
    InputError
        The path is empty, relative to an unsaved file, or a file.
    """
    text = str(folder)
    if not text.strip():
        raise InputError("Choose a folder for the files.")
    target = absolute_path(text)
    _refuse_file(target)
    return target


def checked_folder(folder: str | Path) -> Path:
    """Return the absolute path of an output folder, which need not exist but must be creatable.

    Raises
    ------
    InputError
        As for `absolute_folder`, or the folder cannot be created or written.
    """
    target = absolute_folder(folder)
    checked_target(target / "x" if target.is_dir() else target)
    return target


def creatable_folder(folder: str | Path) -> Path:
    """Return the absolute path of an output folder, which need not exist, and neither do those that contain it.

    Raises
    ------
    InputError
        As for `absolute_folder`, or the folder cannot be created or written.
    """
    target = absolute_folder(folder)
    there = next((own for own in (target, *target.parents) if os.path.exists(own)), None)
    if there is None or not there.is_dir() or not os.access(there, os.W_OK):
        raise InputError("The folder {folder} cannot be written to; choose another one.", folder=str(target))
    return target


def made_folder(folder: str | Path) -> Path:
    """Return the absolute path of an output folder; its last part is created if missing.

    Raises
    ------
    InputError
        As for `absolute_folder`, or the folder cannot be created or written.
    """
    target = absolute_folder(folder)
    _require_folder(target.parent)
    create_folder(target)
    return target


def create_folder(folder: Path) -> None:
    """Create a folder for files, and those that contain it, unless it exists.

    Raises
    ------
    InputError
        The folder cannot be created or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "The folder {folder} cannot be created ({reason}); choose another one.",
            folder=str(folder),
            reason=error.strerror,
        ) from error
    _require_writable(folder)


def save_blend(path: Path) -> Path:
    """Save the open file as a compressed .blend with relative paths, without changing which file is open.

    An existing file is only replaced once the new one is complete.

    Returns
    -------
    Path
        The absolute path.

    Raises
    ------
    InputError
        As for `checked_target`, or the name does not end in .blend.
    ConvwassError
        Blender or the system could not write the file.
    """
    target = checked_target(path)
    if target.suffix.lower() != ".blend":
        raise InputError("{name} does not end in .blend; name it {stem}.blend.", name=target.name, stem=target.stem)
    with written_whole(target) as draft:
        bpy.ops.wm.save_as_mainfile(
            filepath=str(draft), check_existing=False, compress=True, relative_remap=True, copy=True
        )
    return target
