# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The distinct colors of an 8-bit image: a 4K photograph has a tenth as many of them as pixels."""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LEVELS = 255
"""Largest value of an 8-bit channel."""

_COUNT = 1 << 24
# Bit positions of the channels in a 32-bit number; alpha comes last and is ignored.
_SHIFTS = (0, 8, 16) if sys.byteorder == "little" else (24, 16, 8)
_ALPHA_AWAY = 0x00FFFFFF if sys.byteorder == "little" else 0xFFFFFF00


def color_keys(pixels: NDArray[np.float32]) -> NDArray[np.uint32]:
    """Return a number below 2^24 for the color of every pixel, (..., 4), with values from 0 to 1."""
    scaled = pixels * np.float32(LEVELS)
    scaled += np.float32(0.5)
    keys = scaled.astype(np.uint8).view(np.uint32)[..., 0]
    keys &= np.uint32(_ALPHA_AWAY)
    return keys if _SHIFTS[0] == 0 else keys >> np.uint32(8)


@dataclass(frozen=True)
class DistinctColors:
    """The distinct colors of an image.

    Attributes
    ----------
    pixels : (1, n, 4) float32
        Each color as an opaque pixel, exactly as Blender converts bytes to floats.
    ranks : (2^24,) int32
        Index of a color by its number; undefined for other numbers.
    """

    pixels: NDArray[np.float32]
    ranks: NDArray[np.int32]


def present_flags() -> NDArray[np.bool_]:
    """Return flags for the presence of every color number, all False."""
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
