# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where files go: folders that must be there, and .blend files that are written whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from ..applications.whole_paths import whole_path
from ..drafts import written_whole
from ..errors import InputError


def checked_target(path: Path) -> Path:
    """Return the absolute path of a file to be written.

    Raises
    ------
    InputError
        Its folder does not exist or cannot be written to, or the path is a folder.
    """
    target = whole_path(path)
    if target.is_dir():
        raise InputError("{target} is a folder; add a file name to it.", target=str(target))
    if not target.parent.is_dir():
        raise InputError(
            "The folder {folder} does not exist; make it first, or choose another one.", folder=str(target.parent)
        )
    if not os.access(target.parent, os.W_OK):
        raise InputError("The folder {folder} cannot be written to; choose another one.", folder=str(target.parent))
    return target


def absolute_folder(folder: str | Path) -> Path:
    """Return the absolute path of a folder that files go to; it need not exist.

    Parameters
    ----------
    folder : str or Path
        A path that starts with two slashes goes from the saved file.

    Raises
    ------
    InputError
        It goes from a file that has not been saved, or is a file itself.
    """
    text = str(folder)
    if text.startswith("//") and not bpy.data.filepath:
        raise InputError("Save the file first: {folder} is relative to it. Or choose a whole path.", folder=text)
    target = whole_path(bpy.path.abspath(text))
    if target.exists() and not target.is_dir():
        raise InputError("{folder} is a file; choose a folder.", folder=str(target))
    return target


def checked_folder(folder: str | Path) -> Path:
    """Return the absolute path of a folder that files will go to, which need not be there yet.

    Raises
    ------
    InputError
        As `absolute_folder`, or it cannot be made or written to.
    """
    target = absolute_folder(folder)
    checked_target(target / "x" if target.is_dir() else target)
    return target


def made_folder(folder: str | Path) -> Path:
    """Return the absolute path of a folder that files go to; its last part is made if missing.

    Raises
    ------
    InputError
        As `absolute_folder`, or it cannot be made or written to.
    """
    target = absolute_folder(folder)
    if not target.parent.is_dir():
        raise InputError(
            "The folder {folder} does not exist; make it first, or choose another one.", folder=str(target.parent)
        )
    try:
        target.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError("The folder {folder} cannot be made; choose another one.", folder=str(target)) from error
    if not os.access(target, os.W_OK):
        raise InputError("The folder {folder} cannot be written to; choose another one.", folder=str(target))
    return target


def save_blend(path: Path) -> Path:
    """Save the open file as a compressed .blend with relative paths; which file is open stays as it is.

    An existing file is replaced only when the new one is complete.

    Returns
    -------
    Path
        The absolute path.

    Raises
    ------
    InputError
        As `checked_target`, or the name does not end in .blend.
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
