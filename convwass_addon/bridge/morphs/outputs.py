# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The outputs of a morph in a saved file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy

from ...drafts import new_draft
from ...errors import ConvwassError
from ...progress import drained
from ..files.output_paths import checked_target, save_blend
from ..operator_errors import reason
from .disk.cache_output import as_cache
from .disk.disk_output import DiskOutput, filled_folder, keep_folder, named_folder
from .disk.volume_output import as_volume
from .players.blend_pad import make_blend_pad
from .players.player import make_player
from .removal import remove_frames
from .stored import stored_settings

PACKED: dict[str, Callable[..., object] | None] = {
    "objects": None,
    "player": make_player,
    "pad": make_blend_pad,
}
"""Outputs within the .blend, and their functions."""

ON_DISK: dict[str, Callable[[bpy.types.Collection, Path], DiskOutput]] = {
    "volume": lambda collection, folder: drained(as_volume(collection, folder)),
    "alembic": lambda collection, folder: as_cache(collection, folder, "alembic"),
    "usd": lambda collection, folder: as_cache(collection, folder, "usd"),
}
"""Outputs as files next to the .blend, and their functions."""

SHAPE_KEYS = "shape-keys"
"""The output without frames: one mesh with shape keys."""


def folder_beside(target: Path) -> str:
    """Return the folder for files of outputs on disk: next to the .blend and named after it."""
    return f"//{target.stem} files"


def save_as(collection: bpy.types.Collection, output: str, target: Path) -> list[Path]:
    """Save the open file with one output of a morph.

    Parameters
    ----------
    collection : bpy.types.Collection
        The morph; its frames are removed from the file if they are on disk.
    output : str
        A key of `PACKED` or `ON_DISK`.
    target : Path
        The .blend file, which is only replaced once everything is written. With an output on disk, a draft next to it
        becomes the open file, and is removed at the end.

    Returns
    -------
    list of Path
        All written files.

    Raises
    ------
    InputError, ConvwassError
        The output or the file system reported an error.
    """
    if output in PACKED:
        make = PACKED[output]
        if make is not None:
            make(collection, between=stored_settings(collection).get("between", "NEAREST"))
        keep_folder(collection, target)
        return [save_blend(target)]
    target = checked_target(target)
    # Paths are relative to the open .blend. Saving twice to the target would leave a backup of the first state.
    draft = new_draft(target)
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(draft), check_existing=False)
        # The replaced .blend file had its files there, too.
        with filled_folder(named_folder(folder_beside(target), collection)) as folder:
            written = ON_DISK[output](collection, folder)
            remove_frames(collection)
            return [save_blend(target), *written.files]
    except RuntimeError as error:
        raise ConvwassError("{file} could not be written: {reason}", file=str(target), reason=reason(error)) from error
    finally:
        draft.unlink(missing_ok=True)
