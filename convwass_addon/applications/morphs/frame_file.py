# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One finished frame as a file: a surface, where it comes from, figures and potentials, checked when they are read.

The file begins with `MAGIC`, the SHA-256 of all that follows it (32 bytes) and the length of the header (8 bytes, as
all numbers little-endian). The header is JSON: ``key`` says which frame it is, ``record`` holds the figures and
``counts`` how many vertices and triangles there are, or null where there is no surface. ``potentials`` says for every
part of the blend the ``shape`` of its grid, how many ``rows`` of potentials it has and for how many ``cells``, and its
``sharpness`` and ``sigma``; an input that is shown as it is has none. ``origins`` says on how many inputs every vertex
has an origin, or null. Vertices (3 float64 each) and triangles (3 int32 each) come next, then the origins of all
vertices on the first input (3 float32 each), on the second, and so on, and then for every part one bit per cell of the
grid, which tells whether it has potentials, filled up to whole bytes with zeros, and the rows (float32).
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import stat
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...drafts import draft_of
from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from .potentials import PartPotentials

MAGIC = b"convwass frame 3\n"

_DIGEST_BYTES = 32
_LENGTH = struct.Struct("<Q")
_VERTEX, _TRIANGLE, _ORIGIN, _POTENTIAL = 3 * 8, 3 * 4, 3 * 4, 4
# Far above any surface of the finest grid; what is larger is no frame, and is not even read.
_MOST_BYTES = 2 << 30
_MOST_HEADER_BYTES = 1 << 20
# What is said of a frame elsewhere, and must be of this type where it is there.
_TYPES: dict[str, tuple[type, ...]] = {
    "weights": (tuple,),
    "converged": (bool,),
    "marginal_error": (float, int, type(None)),
    "notices": (tuple,),
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
    potentials : tuple of PartPotentials
        One per part; none of an input that is shown as it is.
    origins : (k, n, 3) float32 or None
        Where the vertices of the surface come from.
    """

    mesh: TriangleMesh | None
    record: dict[str, object]
    potentials: tuple[PartPotentials, ...] = ()
    origins: NDArray[np.float32] | None = None


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
    with draft_of(path, ".part") as draft:
        draft.write_bytes(_packed(key, frame))


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
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError, InputError) as error:
        raise DamagedFrameError(str(error) or type(error).__name__) from error


def _packed(key: str, frame: StoredFrame) -> bytes:
    mesh = frame.mesh
    description = {
        "key": key,
        "counts": None if mesh is None else [len(mesh.vertices), len(mesh.faces)],
        "origins": None if frame.origins is None else len(frame.origins),
        "potentials": [
            {
                "shape": part.inside.shape,
                "rows": len(part.columns),
                "cells": part.columns.shape[1],
                "sharpness": part.sharpness,
                "sigma": part.sigma,
            }
            for part in frame.potentials
        ],
        "record": frame.record,
    }
    header = json.dumps(description).encode()
    arrays = [] if mesh is None else [mesh.vertices.astype("<f8"), mesh.faces.astype("<i4")]
    if frame.origins is not None:
        arrays.append(frame.origins.astype("<f4"))
    for part in frame.potentials:
        arrays += [np.packbits(part.inside), part.columns.astype("<f4")]
    body = b"".join([_LENGTH.pack(len(header)), header, *(array.tobytes() for array in arrays)])
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
    reader = _Reader(arrays)
    mesh = _mesh(header["counts"], reader)
    origins = _origins(header["origins"], mesh, reader)
    potentials = _potentials(header["potentials"], reader)
    reader.end()
    return StoredFrame(mesh, _record(header["record"]), potentials, origins)


class _Reader:
    """Takes arrays off the front of what is left of a file."""

    def __init__(self, rest: memoryview) -> None:
        self._rest = rest

    def take(self, size: int) -> memoryview:
        """Return the next so many bytes; sizes that are not there are refused before anything is made of them."""
        if size > len(self._rest):
            raise ValueError("its arrays do not have the size that it says")
        taken, self._rest = self._rest[:size], self._rest[size:]
        return taken

    def end(self) -> None:
        """Refuse a file of which something is left."""
        if len(self._rest):
            raise ValueError("its arrays do not have the size that it says")


def _mesh(counts: object, reader: _Reader) -> TriangleMesh | None:
    if counts is None:
        return None
    vertices, triangles = _counts(counts, 2)
    points = np.frombuffer(reader.take(vertices * _VERTEX), "<f8").astype(np.float64).reshape(-1, 3)
    faces = np.frombuffer(reader.take(triangles * _TRIANGLE), "<i4").astype(np.int64).reshape(-1, 3)
    return TriangleMesh.from_arrays(points, faces)


def _origins(inputs: object, mesh: TriangleMesh | None, reader: _Reader) -> NDArray[np.float32] | None:
    if inputs is None:
        return None
    (count,) = _counts([inputs], 1)
    if mesh is None:
        raise ValueError("its origins are of no vertices")
    vertices = len(mesh.vertices)
    origins = np.frombuffer(reader.take(count * vertices * _ORIGIN), "<f4").astype(np.float32)
    if not np.isfinite(origins).all():
        raise ValueError("its origins are not numbers")
    return origins.reshape(count, vertices, 3)


def _potentials(descriptions: object, reader: _Reader) -> tuple[PartPotentials, ...]:
    if not isinstance(descriptions, list):
        raise TypeError("its potentials are no list")
    return tuple(_part(description, reader) for description in descriptions)


def _part(description: object, reader: _Reader) -> PartPotentials:
    if not isinstance(description, dict):
        raise TypeError("its potentials are no table")
    shape = _counts(description["shape"], 3)
    rows, cells = _counts([description["rows"], description["cells"]], 2)
    sharpness, sigma = (_number(description[name]) for name in ("sharpness", "sigma"))
    size = math.prod(shape)
    bits = np.unpackbits(np.frombuffer(reader.take(-(-size // 8)), np.uint8))
    if bits[size:].any() or np.count_nonzero(bits) != cells:
        raise ValueError("its potentials do not have the size of their cells")
    values = np.frombuffer(reader.take(rows * cells * _POTENTIAL), "<f4").astype(np.float32)
    return PartPotentials(bits[:size].astype(bool).reshape(shape), values.reshape(rows, cells), sharpness, sigma)


def _counts(value: object, length: int) -> list[int]:
    if not (isinstance(value, list) and len(value) == length and all(type(n) is int and n >= 0 for n in value)):
        raise ValueError("its counts are no counts")
    return value


def _number(value: object) -> float:
    if type(value) not in (int, float):
        raise TypeError("its potentials are of no solve")
    return float(value)


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
