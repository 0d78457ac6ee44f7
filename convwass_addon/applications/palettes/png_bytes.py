# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""PNG encoding in memory (ISO/IEC 15948), which can run on a worker thread; Blender's own would block its window."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control

# The fastest level that compresses; with row differences the result is smaller than Blender's.
_LEVEL = 1
_FILTER_UP = 2
_RGB, _RGBA = 2, 6
_ROWS_AT_ONCE = 64


def png_bytes(pixels: NDArray[np.float32], control: Control = UNINTERRUPTED) -> bytes:
    """Return a PNG file with 8 bits per channel, with alpha if any pixel is not opaque.

    Parameters
    ----------
    pixels : (height, width, 4) float32
        From 0 to 1, bottom row first; alpha is not premultiplied.
    control : Control
        Stops the work when cancelled.
    """
    height, width = pixels.shape[:2]
    channels = 4 if (pixels[..., 3] < 1.0).any() else 3
    packer, parts = zlib.compressobj(_LEVEL), []
    above = np.zeros((1, width * channels), dtype=np.uint8)
    for start in range(0, height, _ROWS_AT_ONCE):
        control.check()
        # PNG stores the top row first.
        last = height - start
        rows = pixels[max(last - _ROWS_AT_ONCE, 0) : last, :, :channels][::-1]
        values = (np.clip(rows, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8).reshape(len(rows), -1)
        filtered = np.full((len(rows), 1 + values.shape[1]), _FILTER_UP, dtype=np.uint8)
        filtered[:, 1:] = values - np.concatenate([above, values[:-1]])
        parts.append(packer.compress(filtered.tobytes()))
        above = values[-1:]
    parts.append(packer.flush())
    head = struct.pack(">IIBBBBB", width, height, 8, _RGBA if channels == 4 else _RGB, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", b"".join(parts)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
