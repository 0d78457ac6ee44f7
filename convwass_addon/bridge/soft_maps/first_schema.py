# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read soft maps in the first format in which .blend files stored them.

`_MAGIC`, the length of the header (4 bytes, little-endian), the header in JSON, and all arrays, compressed together.
Arrays are encoded as in :mod:`.soft_map_bytes`, and ``shapes`` in the header contains their sizes.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

_MAGIC = b"CWMAP\x00"
_LENGTH_BYTES = 4
_MOST_HEADER, _MOST_ARRAYS = 1 << 22, 1 << 31


def is_first_schema(data: bytes) -> bool:
    """Return whether a map is stored in this format."""
    return data.startswith(_MAGIC)


def first_schema(data: bytes, kinds: Mapping[str, np.dtype]) -> tuple[dict[str, object], dict[str, NDArray[np.uint8]]]:
    """Return the header of a map and the bytes of its arrays, which are limited by the sizes in the header.

    Parameters
    ----------
    data : bytes
        The stored map.
    kinds : mapping of str to dtype
        All arrays in order, with their stored types.

    Raises
    ------
    ValueError, TypeError, KeyError, RecursionError
        The data is damaged; the message gives the reason.
    """
    start = len(_MAGIC) + _LENGTH_BYTES
    length = int.from_bytes(data[len(_MAGIC) : start], "little")
    if length > _MOST_HEADER:
        raise ValueError(f"a header of {length} bytes")
    header = json.loads(data[start : start + length])
    if not isinstance(header, dict):
        raise TypeError("the header is not a table")
    if header["schema"] != 1:
        raise ValueError(f"schema {header['schema']!r} in the form of schema 1")
    shapes = header["shapes"]
    if not (isinstance(shapes, list) and len(shapes) == len(kinds) and all(map(_is_shape, shapes))):
        raise ValueError("the shapes of its arrays are not what they should be")
    # Bytes per value, columns, rows.
    sizes = [(kind.itemsize, *shape[::-1]) for shape, kind in zip(shapes, kinds.values(), strict=True)]
    counts = [int(np.prod(size, dtype=object)) for size in sizes]
    body = _decompressed(data[start + length :], sum(counts))
    ends = np.cumsum([0, *counts])
    planes = (
        np.frombuffer(body, np.uint8, count, begin).reshape(size)
        for size, count, begin in zip(sizes, counts, ends[:-1], strict=True)
    )
    return header, dict(zip(kinds, planes, strict=True))


def _is_shape(shape: object) -> bool:
    return (
        isinstance(shape, list)
        and len(shape) in (1, 2)
        and all(isinstance(side, int) and not isinstance(side, bool) and side >= 0 for side in shape)
        and (len(shape) == 1 or shape[1] == 3)
    )


def _decompressed(data: bytes, size: int) -> bytes:
    if size > _MOST_ARRAYS:
        raise ValueError(f"arrays of {size} bytes")
    try:
        reader = zlib.decompressobj()
        body = reader.decompress(data, size + 1)
    except zlib.error as error:
        raise ValueError(str(error)) from error
    if len(body) != size or not reader.eof:
        raise ValueError(f"{len(body)} bytes where {size} belong")
    return body
