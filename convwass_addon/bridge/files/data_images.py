# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Images that hold numbers for nodes, packed into the .blend."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from .image_files import opaque_pixels


def data_image(name: str, values: NDArray[np.float32]) -> bpy.types.Image:
    """Create a float image of values, (height, width, 3), bottom row first, and pack it."""
    height, width = values.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=False, float_buffer=True, is_data=True)
    image.pixels.foreach_set(opaque_pixels(values).ravel())
    image.update()
    image.pack()
    return image
