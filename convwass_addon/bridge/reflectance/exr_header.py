# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check whether an OpenEXR file is complete, and read its size, before Blender opens it.

Blender allocates memory for all pixels declared in a header, and Blender 5.0 crashes if a header is damaged or the file
truncated.
"""

from __future__ import annotations

import math
import re
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from ...errors import InputError

# Version 2, single part, scan lines of flat pixels.
_MAGIC = struct.pack("<II", 20000630, 2)
# The same, with long attribute names.
_LONG_NAMES = struct.pack("<II", 20000630, 2 | 0x400)
_MOST_BYTES = 1 << 30
_NAME = re.compile(rb"[ -~]{1,255}")
# Size of the values of each attribute type in bytes; None if it varies.
_TYPES = {
    b"box2f": 16,
    b"box2i": 16,
    b"chlist": None,
    b"chromaticities": 32,
    b"compression": 1,
    b"double": 8,
    b"envmap": 1,
    b"float": 4,
    b"int": 4,
    b"keycode": 28,
    b"lineOrder": 1,
    b"m33f": 36,
    b"m44f": 64,
    b"rational": 8,
    b"string": None,
    b"stringvector": None,
    b"timecode": 8,
    b"v2f": 8,
    b"v2i": 8,
    b"v3f": 12,
    b"v3i": 12,
}
_NEEDED = {
    b"channels": b"chlist",
    b"compression": b"compression",
    b"dataWindow": b"box2i",
    b"displayWindow": b"box2i",
    b"lineOrder": b"lineOrder",
    b"pixelAspectRatio": b"float",
    b"screenWindowCenter": b"v2f",
    b"screenWindowWidth": b"float",
}
# Rows per block by compression, and the compressions that mean none and zlib.
_ROWS = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)
_PLAIN, _ZLIB = 0, (2, 3)
# Size of a pixel value in bytes by type: integer, half, float.
_VALUE_BYTES = (4, 2, 4)


@dataclass(frozen=True)
class ExrSize:
    """Size of the picture in a file."""

    width: int
    height: int


@dataclass(frozen=True)
class _Header:
    """Position and packing of the pixels, as declared in a header, and where the header ends."""

    top: int
    size: ExrSize
    pixel_bytes: int
    compression: int
    end: int


def exr_size(path: Path) -> ExrSize:
    """Read the size of an OpenEXR file after checking all of its blocks.

    Raises
    ------
    InputError
        The file does not exist, cannot be read, is not a single-part scan line OpenEXR file, or is damaged.
    """
    if not path.is_file():
        raise InputError("There is no file {file}.", file=str(path))
    try:
        with path.open("rb") as file:
            data = file.read(_MOST_BYTES)
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise InputError("{name} cannot be read: {problem}", name=path.name, problem=reason) from problem
    try:
        header = _header(data)
        _check_blocks(data, header)
    except (ValueError, IndexError, struct.error, zlib.error) as problem:
        raise InputError("{name} is not an OpenEXR picture, or is damaged.", name=path.name) from problem
    return header.size


def _header(data: bytes) -> _Header:
    """Read the header; invalid data raises an error that `exr_size` handles."""
    _require(data.startswith((_MAGIC, _LONG_NAMES)))
    found: dict[bytes, tuple[bytes, bytes]] = {}
    place = len(_MAGIC)
    while data[place]:
        name, kind, value, place = _attribute(data, place)
        _require(name not in found)
        found[name] = kind, value
    _require(all(found.get(name, (b"",))[0] == kind for name, kind in _NEEDED.items()))
    windows = [struct.unpack("<4i", found[name][1]) for name in (b"dataWindow", b"displayWindow")]
    _require(all(right >= left and bottom >= top for left, top, right, bottom in windows))
    left, top, right, bottom = windows[0]
    pixel_bytes = sum(_channel_bytes(found[b"channels"][1]))
    compression = found[b"compression"][1][0]
    _require(pixel_bytes > 0 and compression < len(_ROWS) and found[b"lineOrder"][1][0] < 3)
    return _Header(top, ExrSize(right - left + 1, bottom - top + 1), pixel_bytes, compression, place + 1)


def _attribute(data: bytes, place: int) -> tuple[bytes, bytes, bytes, int]:
    """Return the name, type and value of the attribute at an offset, and the offset of the next one."""
    words = []
    for _ in range(2):
        end = data.index(0, place, place + 256)
        words.append(data[place:end])
        place = end + 1
    name, kind = words
    (size,) = struct.unpack_from("<I", data, place)
    place += 4
    _require(_NAME.fullmatch(name) is not None and kind in _TYPES)
    _require(_TYPES[kind] in (size, None) and place + size < len(data))
    return name, kind, data[place : place + size], place + size


def _channel_bytes(value: bytes) -> Iterator[int]:
    """Yield the bytes per pixel of each channel."""
    place = 0
    while value[place]:
        place = value.index(0, place) + 1
        kind, _linear, across, down = struct.unpack_from("<iI2i", value, place)
        place += 16
        _require(kind in range(len(_VALUE_BYTES)) and (across, down) == (1, 1))
        yield _VALUE_BYTES[kind]
    _require(place + 1 == len(value))


def _check_blocks(data: bytes, header: _Header) -> None:
    """Check that all blocks of rows exist, have the right size, and can be decompressed."""
    rows, size = _ROWS[header.compression], header.size
    count = math.ceil(size.height / rows)
    # Checked before numbers from the file are used.
    _require(header.end + 16 * count <= len(data))
    starts = struct.unpack_from(f"<{count}Q", data, header.end)
    _require(all(first < second for first, second in pairwise(sorted(starts))))
    for number, start in enumerate(starts):
        _require(header.end + 8 * count <= start <= len(data) - 8)
        row, length = struct.unpack_from("<ii", data, start)
        whole = min(rows, size.height - number * rows) * size.width * header.pixel_bytes
        block = data[start + 8 : start + 8 + max(length, 0)]
        _require(row == header.top + number * rows and 0 < len(block) == length <= whole)
        if header.compression == _PLAIN:
            _require(length == whole)
        elif header.compression in _ZLIB and length < whole:
            unpacker = zlib.decompressobj()
            # Includes the checksum at the end; the limit protects from wrong sizes in the file.
            _require(len(unpacker.decompress(block, whole + 1)) == whole and unpacker.eof)


def _require(condition: bool) -> None:
    if not condition:
        raise ValueError
