# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert environment images to skies, and write skies as OpenEXR files."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from ...errors import InputError
from ...transport.sphere import solid_angles
from ..files.image_files import (
    ImageFormat,
    drawn_image,
    opaque_pixels,
    opened_image,
    pixel_values,
    refuse_damaged,
    write_image,
)
from ..palettes.image_pixels import image_format
from ..scene_colors import scene_of_rec709, scene_of_srgb


def read_sky(image: bpy.types.Image) -> NDArray[np.float32]:
    """Read an equirectangular image.

    Returns
    -------
    (rows, columns, 3) float32
        Radiance in the linear scene color space, from the top row down. Column j is at longitude (j + 1/2) 360 degrees
        / columns, from +X towards +Y, as in Blender.

    Raises
    ------
    InputError
        No pixels, not twice as wide as high, or bytes in an unsupported color space.
    """
    width, height = image.size
    # Accessing a pixel loads the file.
    if not width * height or not len(image.pixels) or image.channels < 3:
        refuse_damaged(image)
        raise InputError("The pixels of {image} cannot be read as a sky.", image=image.name)
    if width != 2 * height:
        raise InputError(
            "{image} has {width} x {height} pixels; a sky must be twice as wide as high.",
            image=image.name,
            width=width,
            height=height,
        )
    colors = pixel_values(image)[::-1, :, :3]
    # Non-color data is used as radiance unchanged.
    if not (image.is_float or image.colorspace_settings.is_data):
        is_encoded = image_format(image).encoding == "srgb"
        colors = scene_of_srgb(colors) if is_encoded else scene_of_rec709(colors)
    return turned(colors)


def read_sky_file(path: Path) -> NDArray[np.float32]:
    """Read a file as :func:`read_sky` does.

    Raises
    ------
    InputError
        The file does not exist, Blender cannot read it, or it is not a sky.
    """
    with opened_image(path) as image:
        return read_sky(image)


def turned(colors: NDArray[np.float32]) -> NDArray[np.float32]:
    """Convert between Blender's columns, which go against the longitude and begin at -X, and those of skies.

    The conversion is its own inverse.
    """
    return np.ascontiguousarray(np.roll(colors[:, ::-1], colors.shape[1] // 2, axis=1), dtype=np.float32)


def resized(sky: ArrayLike, height: int) -> NDArray[np.float64]:
    """Resample a sky, (rows, columns, 3), by averaging to (height, 2 * height, 3); preserves the total light."""
    values = np.asarray(sky, dtype=np.float64)
    rows, columns = values.shape[:2]
    if rows == height:
        return values
    lit = values * solid_angles(rows, columns)[..., None]
    # By Archimedes, the area of a zone of the sphere is proportional to its height.
    down = _overlaps(-np.cos(np.pi * _edges(rows)), -np.cos(np.pi * _edges(height)))
    across = _overlaps(_edges(columns), _edges(2 * height))
    tall = (down @ lit.reshape(rows, -1)).reshape(height, columns, 3)
    light = np.stack([(across @ tall[..., channel].T).T for channel in range(3)], axis=-1)
    return light / solid_angles(height, 2 * height)[..., None]


def _edges(count: int) -> NDArray[np.float64]:
    return np.arange(count + 1) / count


def _overlaps(before: NDArray[np.float64], after: NDArray[np.float64]) -> csr_array:
    """Return the fraction of every old interval in every new one, (new, old), from their edges."""
    edges = np.union1d(before, after)
    middles, lengths = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    old, new = (np.clip(np.searchsorted(own, middles) - 1, 0, len(own) - 2) for own in (before, after))
    return csr_array((lengths / np.diff(before)[old], (new, old)), shape=(len(after) - 1, len(before) - 1))


def write_sky(path: Path, sky: NDArray[np.float32]) -> None:
    """Write a sky as an OpenEXR file of 32-bit floats, completely or not at all.

    Raises
    ------
    ConvwassError
        Blender or the system could not write the file.
    """
    with drawn_image(opaque_pixels(turned(sky)[::-1])) as image:
        write_image(image, path, ImageFormat("OPEN_EXR", "RGB", "32"))
