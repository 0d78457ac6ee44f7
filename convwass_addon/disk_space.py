# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks for full disks, which Blender's writers do not report reliably.

On a full disk, Blender silently truncates .blend, PNG, JPEG, USD and OpenVDB files, and its Alembic writer crashes with
an uncaught exception. Free space is therefore checked before and after writing. Quotas and limits of the size of files
do the same while there is free space; they are noticed by how files end, as far as their format tells.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from .errors import ConvwassError

# With less free space than this after writing, the disk is assumed to have been full in between.
_LEFT = 1 << 16
# The final bytes of a complete file; compressed .blend files end with a table of their Zstandard frames.
_ENDS = {".png": b"IEND\xaeB`\x82", ".jpg": b"\xff\xd9", ".jpeg": b"\xff\xd9", ".blend": b"\xb1\xea\x92\x8f"}
# The first bytes of binary USD files, and where they hold the offset of their table of contents, which is at the end.
_CRATE, _OFFSET = b"PXR-USDC", slice(16, 24)


def require_space(folder: Path, needed: int) -> None:
    """Check the free disk space before writing `needed` bytes.

    Raises
    ------
    ConvwassError
        There is not enough space.
    """
    free = _free(folder)
    if free is not None and free < needed:
        raise ConvwassError(
            "{folder} has {free:.1f} MB of free space, but up to {needed:.1f} MB are needed; free up space there, or "
            "choose another folder.",
            folder=str(folder),
            free=free / 1e6,
            needed=needed / 1e6,
        )


def require_whole(draft: Path, file: Path) -> None:
    """Check that a draft was written completely.

    Raises
    ------
    ConvwassError
        The draft is missing, empty or truncated, or the disk is full.
    """
    if not draft.is_file() or not draft.stat().st_size or not _ends_well(draft):
        raise ConvwassError("{file} could not be written; the disk may be full.", file=str(file))
    free = _free(draft.parent)
    if free is not None and free < _LEFT:
        raise ConvwassError("The disk of {folder} is full; free up space there.", folder=str(draft.parent))


def _free(folder: Path) -> int | None:
    """Free space on the disk of a folder in bytes, or None if unknown."""
    try:
        return shutil.disk_usage(folder).free
    except OSError:
        return None


def _ends_well(file: Path) -> bool:
    """Return whether a file is not known to be truncated."""
    kind, size = file.suffix.lower(), file.stat().st_size
    with file.open("rb") as stream:
        if kind in _ENDS:
            stream.seek(max(size - len(_ENDS[kind]), 0))
            return stream.read() == _ENDS[kind]
        start = stream.read(_OFFSET.stop)
    return not start.startswith(_CRATE) or int.from_bytes(start[_OFFSET], "little") < size
