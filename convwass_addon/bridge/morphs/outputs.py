# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What may stand in for the frame objects of a morph in a file that is written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy

from ...errors import ConvwassError
from ...progress import drained
from ..files import save_blend
from ..operator_errors import reason
from .blend_pad import make_blend_pad
from .cache_output import as_cache
from .disk_output import DiskOutput, filled_folder
from .player import make_player
from .removal import remove_frames
from .stored import stored_settings
from .volume_output import as_volume

PACKED: dict[str, Callable[..., object] | None] = {
    "objects": None,
    "player": make_player,
    "pad": make_blend_pad,
}
"""Outputs that live in the .blend, and what makes them of a morph."""

ON_DISK: dict[str, Callable[[bpy.types.Collection, Path], DiskOutput]] = {
    "volume": lambda collection, folder: drained(as_volume(collection, folder)),
    "alembic": lambda collection, folder: as_cache(collection, folder, "alembic"),
    "usd": lambda collection, folder: as_cache(collection, folder, "usd"),
}
"""Outputs that read files beside the .blend, and what makes them of a morph."""

SHAPE_KEYS = "shape-keys"
"""The output that is no morph of frames: one mesh with shape keys."""


def folder_beside(target: Path) -> str:
    """Return where the files of outputs on disk go: a folder beside the .blend file, named after it."""
    return f"//{target.stem} files"


def save_as(collection: bpy.types.Collection, output: str, target: Path) -> list[Path]:
    """Save the open file with a morph in one of the outputs.

    Parameters
    ----------
    collection : bpy.types.Collection
        The morph; its frames are removed from the file where they are on disk.
    output : str
        A key of `PACKED` or of `ON_DISK`.
    target : Path
        The .blend file. With an output on disk it becomes the open file.

    Returns
    -------
    list of Path
        All files that have been written.

    Raises
    ------
    InputError, ConvwassError
        What the output or the file system refuses.
    """
    if output in PACKED:
        make = PACKED[output]
        if make is not None:
            make(collection, between=stored_settings(collection).get("between", "NEAREST"))
        return [save_blend(target)]
    # Paths are relative to a file that is there.
    saved = save_blend(target)
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(saved), check_existing=False, compress=True)
        with filled_folder(folder_beside(saved), collection) as folder:
            written = ON_DISK[output](collection, folder)
        remove_frames(collection)
        bpy.ops.wm.save_mainfile(compress=True)
    except RuntimeError as error:
        raise ConvwassError("{file} could not be written: {reason}", file=str(saved), reason=reason(error)) from error
    return [saved, *written.files]
