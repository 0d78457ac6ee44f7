# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One finished frame as a file: a surface and the solver's figures, checked when they are read.

The file begins with `MAGIC`, the SHA-256 of all that follows it (32 bytes) and the length of the header (8 bytes, as
all numbers little-endian). The header is JSON: ``key`` says which frame it is, ``record`` holds the figures and
``counts`` how many vertices and triangles there are, or null where there is no surface. Vertices (3 float64 each) and
triangles (3 int32 each) come last.
"""

from __future__ import annotations

import hashlib
import json
import os
import stat
import struct
import uuid
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..geometry.mesh import TriangleMesh

MAGIC = b"convwass frame 1\n"

_DIGEST_BYTES = 32
_LENGTH = struct.Struct("<Q")
_VERTEX, _TRIANGLE = 3 * 8, 3 * 4
# Far above any surface of the finest grid; what is larger is no frame, and is not even read.
_MOST_BYTES = 2 << 30
_MOST_HEADER_BYTES = 1 << 20
# What is said of a frame elsewhere, and must be of this type where it is there.
_TYPES: dict[str, tuple[type, ...]] = {
    "weights": (tuple,),
    "converged": (bool,),
    "marginal_error": (float, int, type(None)),
    "notice": (str,),
}


class DamagedFrameError(Exception):
    """The file is not the frame that it should be; the message says in a few words why."""


@dataclass(frozen=True)
class StoredFrame:
    """What a file holds.

    Attributes
    ----------
    mesh : TriangleMesh or None
        The surface, if there is one.
    record : dict
        The solver's figures.
    """

    mesh: TriangleMesh | None
    record: dict[str, object]


def write_frame(path: Path, key: str, frame: StoredFrame) -> None:
    """Write a frame so that the file is there as a whole or not at all.

    Parameters
    ----------
    path : Path
        The file; one that is there already is replaced.
    key : str
        Which frame it is.
    frame : StoredFrame
        What to write.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    draft = path.with_name(f".{uuid.uuid4().hex}.part")
    try:
        draft.write_bytes(_packed(key, frame))
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)


def read_frame(path: Path, key: str) -> StoredFrame:
    """Read a frame and check all of it; nothing in the file is trusted.

    Raises
    ------
    FileNotFoundError
        There is none.
    OSError
        The file cannot be read.
    DamagedFrameError
        It is no regular file, too large, cut off, changed, another frame, or not what a frame must be.
    """
    # A link could lead out of the folder, and a pipe would never end.
    if not stat.S_ISREG(os.lstat(path).st_mode):
        raise DamagedFrameError("it is no regular file")
    with open(path, "rb") as file:
        size = os.fstat(file.fileno()).st_size
        if size > _MOST_BYTES:
            raise DamagedFrameError("it is too large")
        content = memoryview(file.read(size))
    try:
        return _unpacked(content, key)
    except (ValueError, TypeError, KeyError, RecursionError, InputError) as error:
        raise DamagedFrameError(str(error) or type(error).__name__) from error


def _packed(key: str, frame: StoredFrame) -> bytes:
    mesh = frame.mesh
    counts = None if mesh is None else [len(mesh.vertices), len(mesh.faces)]
    header = json.dumps({"key": key, "counts": counts, "record": frame.record}).encode()
    arrays = b"" if mesh is None else mesh.vertices.astype("<f8").tobytes() + mesh.faces.astype("<i4").tobytes()
    body = _LENGTH.pack(len(header)) + header + arrays
    return MAGIC + hashlib.sha256(body).digest() + body


def _unpacked(content: memoryview, key: str) -> StoredFrame:
    start = len(MAGIC) + _DIGEST_BYTES
    if len(content) < start + _LENGTH.size or content[: len(MAGIC)] != MAGIC:
        raise ValueError("it does not begin as a frame does")
    body = content[start:]
    if hashlib.sha256(body).digest() != content[len(MAGIC) : start]:
        raise ValueError("it was cut off or changed")
    (length,) = _LENGTH.unpack(body[: _LENGTH.size])
    if length > min(_MOST_HEADER_BYTES, len(body) - _LENGTH.size):
        raise ValueError("its header is too long")
    arrays = body[_LENGTH.size + length :]
    header = json.loads(str(body[_LENGTH.size : _LENGTH.size + length], "utf-8"))
    if not isinstance(header, dict) or header["key"] != key:
        raise ValueError("it is another frame")
    return StoredFrame(_mesh(header["counts"], arrays), _record(header["record"]))


def _mesh(counts: object, arrays: memoryview) -> TriangleMesh | None:
    numbers = [0, 0] if counts is None else counts
    if not (isinstance(numbers, list) and len(numbers) == 2 and all(type(n) is int and n >= 0 for n in numbers)):
        raise ValueError("its counts are no counts")
    split = numbers[0] * _VERTEX
    if split + numbers[1] * _TRIANGLE != len(arrays):
        raise ValueError("its arrays do not have the size that it says")
    if counts is None:
        return None
    vertices = np.frombuffer(arrays[:split], "<f8").astype(np.float64).reshape(-1, 3)
    faces = np.frombuffer(arrays[split:], "<i4").astype(np.int64).reshape(-1, 3)
    return TriangleMesh.from_arrays(vertices, faces)


def _record(value: object) -> dict[str, object]:
    if not isinstance(value, dict):
        raise TypeError("its record is no table")
    record = {name: _tupled(item) for name, item in value.items()}
    for name, types in _TYPES.items():
        if name in record and not isinstance(record[name], types):
            raise TypeError(f"its {name} is of the wrong type")
    return record


def _tupled(value: object) -> object:
    """Return lists, which JSON makes of tuples, as tuples again."""
    if isinstance(value, list):
        return tuple(map(_tupled, value))
    if isinstance(value, dict):
        return {name: _tupled(item) for name, item in value.items()}
    return value
