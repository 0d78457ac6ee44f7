# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Disks that are full: Blender's writers say nothing where one is, and some of them end Blender.

Measured on a full disk: .blend, PNG, JPEG, USD and OpenVDB files may be cut off without a word, and Alembic's writer
throws an error that nobody catches. So there is a look at the disk before and after.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from .errors import ConvwassError

# A disk with less room than this after something was written is taken to have been full in between.
_LEFT = 1 << 16
# How the last bytes of a whole file begin, or what they are.
_ENDS = {".png": b"IEND\xaeB`\x82", ".jpg": b"\xff\xd9", ".jpeg": b"\xff\xd9"}


def require_space(folder: Path, needed: int) -> None:
    """Refuse to begin to write where the disk has less room than that, in bytes.

    Raises
    ------
    ConvwassError
        With what there is and what it takes.
    """
    free = _free(folder)
    if free is not None and free < needed:
        raise ConvwassError(
            "{folder} has {free:.1f} MB of room left, and this may take {needed:.1f} MB; make room there, or choose "
            "another folder.",
            folder=str(folder),
            free=free / 1e6,
            needed=needed / 1e6,
        )


def require_whole(draft: Path, file: Path) -> None:
    """Refuse a draft of a file that has just been written and may have been cut off.

    Raises
    ------
    ConvwassError
        It is not there, is empty, does not end as it should, or the disk is full.
    """
    if not draft.is_file() or not draft.stat().st_size or not _ends_well(draft):
        raise ConvwassError("{file} could not be written; the disk may be full.", file=str(file))
    free = _free(draft.parent)
    if free is not None and free < _LEFT:
        raise ConvwassError("The disk of {folder} is full; make room there.", folder=str(draft.parent))


def _free(folder: Path) -> int | None:
    """Bytes of room on the disk of a folder; None where the system does not say."""
    try:
        return shutil.disk_usage(folder).free
    except OSError:
        return None


def _ends_well(file: Path) -> bool:
    wanted = _ENDS.get(file.suffix.lower())
    if wanted is None:
        return True
    with file.open("rb") as stream:
        stream.seek(max(file.stat().st_size - len(wanted), 0))
        return stream.read() == wanted
