# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where files go: folders that must be there, and .blend files that are written whole or not at all."""

from __future__ import annotations

import os
import uuid
from pathlib import Path

import bpy

from ..errors import ConvwassError, InputError


def checked_target(path: Path) -> Path:
    """Return the absolute path of a file to be written.

    Raises
    ------
    InputError
        Its folder does not exist or cannot be written to, or the path is a folder.
    """
    target = Path(path).expanduser().absolute()
    if target.is_dir():
        raise InputError("{target} is a folder; add a file name to it.", target=str(target))
    if not target.parent.is_dir():
        raise InputError(
            "The folder {folder} does not exist; make it first, or choose another one.", folder=str(target.parent)
        )
    if not os.access(target.parent, os.W_OK):
        raise InputError("The folder {folder} cannot be written to; choose another one.", folder=str(target.parent))
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
    draft = target.with_name(f".{uuid.uuid4().hex}.blend")
    try:
        bpy.ops.wm.save_as_mainfile(
            filepath=str(draft), check_existing=False, compress=True, relative_remap=True, copy=True
        )
        os.replace(draft, target)
    except (RuntimeError, OSError) as error:
        raise ConvwassError(
            "{file} could not be written: {reason}", file=str(target), reason=str(error).strip()
        ) from error
    finally:
        draft.unlink(missing_ok=True)
    return target
