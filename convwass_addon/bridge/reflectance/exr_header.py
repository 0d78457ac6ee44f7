# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How large a file of OpenEXR says it is, before Blender makes room for all of its pixels."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

from ...errors import InputError

_MAGIC = struct.pack("<I", 20000630)
_WINDOW = b"dataWindow\0box2i\0" + struct.pack("<I", 16)
# Attributes stand at the beginning, and take no more than this.
_HEADER_BYTES = 1 << 16


@dataclass(frozen=True)
class ExrSize:
    """Pixels of a file."""

    width: int
    height: int


def exr_size(path: Path) -> ExrSize:
    """Read the size of a file of OpenEXR.

    Raises
    ------
    InputError
        There is no such file, it cannot be read, or is no OpenEXR.
    """
    if not path.is_file():
        raise InputError("There is no file {file}.", file=str(path))
    try:
        with path.open("rb") as file:
            header = file.read(_HEADER_BYTES)
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise InputError("{name} cannot be read: {problem}", name=path.name, problem=reason) from problem
    place = header.find(_WINDOW)
    corners = header[place + len(_WINDOW) :][:16]
    if not header.startswith(_MAGIC) or place < 0 or len(corners) < 16:
        raise InputError("{name} is no picture of OpenEXR.", name=path.name)
    left, top, right, bottom = struct.unpack("<4i", corners)
    if right < left or bottom < top:
        raise InputError("{name} is no picture of OpenEXR.", name=path.name)
    return ExrSize(right - left + 1, bottom - top + 1)
