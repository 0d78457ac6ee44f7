# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The colors of an image of bytes, each once: a photograph of 4K has a tenth as many of them as pixels."""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LEVELS = 255
"""Steps of a channel that is a byte."""

_COUNT = 1 << 24
# Where a byte lies in a number of 32 bits; alpha comes last, and does not count.
_SHIFTS = (0, 8, 16) if sys.byteorder == "little" else (24, 16, 8)
_ALPHA_AWAY = 0x00FFFFFF if sys.byteorder == "little" else 0xFFFFFF00


def color_keys(pixels: NDArray[np.float32]) -> NDArray[np.uint32]:
    """Return a number below 2^24 for the color of every pixel, (..., 4), of values from 0 to 1."""
    scaled = pixels * np.float32(LEVELS)
    scaled += np.float32(0.5)
    keys = scaled.astype(np.uint8).view(np.uint32)[..., 0]
    keys &= np.uint32(_ALPHA_AWAY)
    return keys if _SHIFTS[0] == 0 else keys >> np.uint32(8)


@dataclass(frozen=True)
class DistinctColors:
    """The colors that there are.

    Attributes
    ----------
    pixels : (1, n, 4) float32
        Each as an opaque pixel, exactly as Blender gives bytes as floats.
    ranks : (2^24,) int32
        For the number of a color its place among these; anything for others.
    """

    pixels: NDArray[np.float32]
    ranks: NDArray[np.int32]


def present_flags() -> NDArray[np.bool_]:
    """Return room for which colors there are, by their numbers: none."""
    return np.zeros(_COUNT, dtype=bool)


def distinct_colors(present: NDArray[np.bool_]) -> DistinctColors:
    """Return the colors whose flags, (2^24,), are set."""
    keys = np.flatnonzero(present)
    ranks = np.empty(_COUNT, dtype=np.int32)
    ranks[keys] = np.arange(len(keys), dtype=np.int32)
    pixels = np.ones((1, len(keys), 4), dtype=np.float32)
    shifts = [shift - min(_SHIFTS) for shift in _SHIFTS]
    for channel, shift in enumerate(shifts):
        pixels[0, :, channel] = (keys >> shift & 0xFF).astype(np.float32) * np.float32(1.0 / LEVELS)
    return DistinctColors(pixels, ranks)
