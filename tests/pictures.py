# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Images in Blender with known colors."""

from __future__ import annotations

import bpy
import numpy as np

from convwass_addon.applications.palettes.lab_colors import lab_of_linear, linear_of_srgb
from convwass_addon.bridge.files.image_files import opened_image, pixel_values
from tests.applications.palettes import cloud, picture_of

SIZE = (60, 40)


def image_of(name, pixels, *, as_floats=False, **options):
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=as_floats, **options)
    image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    image.update()
    return image


def red_image(name="Red", **options):
    return image_of(name, picture_of(cloud(1, (55, 15, 5), np.diag([6.0, 5.0, 4.0]), 2400), SIZE[0]), **options)


def blue_image(name="Blue", **options):
    return image_of(name, picture_of(cloud(2, (60, 0, -15), np.diag([5.0, 4.0, 5.0]), 1200), 30), **options)


def pixels_in(path, *, as_data=False):
    """Return the pixels of a file, bottom row first, (height, width, channels); encoded values of data as they are."""
    with opened_image(path) as image:
        if as_data:
            image.colorspace_settings.name = "Non-Color"
        return pixel_values(image)


def mean_lab(pixels):
    """Return the mean color of sRGB pixels in Lab."""
    return lab_of_linear(linear_of_srgb(pixels[..., :3].reshape(-1, 3).T.astype(float))).mean(axis=1)
