# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert silhouettes of image Empties to polygons."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...errors import InputError
from ...geometry.level_sets.contours import outline_enclosing
from ...geometry.plane.fitting import fitted_polygons
from ..files.image_files import pixel_values, refuse_damaged
from .flat_rings import FlatRings

# Larger images are downsampled to this number of pixels per side.
_MOST_PIXELS = 1024
# Images with pixels below this opacity are segmented by opacity.
_OPAQUE = 0.5
# Radius in pixels for smoothing steps, and error of the polygons.
_SMOOTHED, _ERROR = 0.7, 0.05
# A silhouette must cover at least this share of an image, and leave as much uncovered.
_LEAST_SHARE = 1e-4


def image_rings(obj: bpy.types.Object, evaluated: bpy.types.Object) -> FlatRings:
    """Read the silhouette of an image Empty: its opaque part, or else what differs from the border.

    Raises
    ------
    InputError
        The image cannot be read, or is uniform.
    """
    silhouette = silhouette_of(obj.data)
    wide, high = obj.data.size
    count = np.array(silhouette.shape, dtype=np.float64)
    size = obj.empty_display_size * np.array([wide, high]) / max(wide, high)
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    offset = np.array(obj.empty_image_offset)
    rings = []
    for ring in _outlines(silhouette):
        flat = (ring / count + offset) * size
        rings.append(flat @ matrix[:3, :2].T + matrix[:3, 3])
    return FlatRings(rings, matrix, "even-odd", None, (0,) * len(rings))


def silhouette_of(image: bpy.types.Image) -> NDArray[np.float64]:
    """Coverage of every pixel of an image, from 0 to 1, (w, h), with columns from the left and rows from the bottom.

    Raises
    ------
    InputError
        The image cannot be read, or is uniform.
    """
    values = figure_of(pixels_of(image))
    share = float((values > 0.5).mean())
    if not _LEAST_SHARE <= share <= 1.0 - _LEAST_SHARE:
        raise one_tone(image.name)
    return values.T.astype(np.float64)


def one_tone(name: str) -> InputError:
    """Return the error for a uniform image."""
    return InputError(
        "The image {name} is uniform; choose a silhouette: black on white, or on a transparent background.",
        name=name,
    )


def pixels_of(image: bpy.types.Image) -> NDArray[np.float32]:
    """Return the pixels of an image, (h, w, c), with rows from the bottom; large images are averaged in blocks.

    Raises
    ------
    InputError
        The image cannot be read.
    """
    wide, high = image.size
    if not (wide and high and image.channels):
        refuse_damaged(image)
        raise InputError("The image {name} could not be read; does its file still exist?", name=image.name)
    pixels = np.nan_to_num(pixel_values(image))
    block = -(-max(wide, high) // _MOST_PIXELS)
    if block > 1:
        padded = np.pad(pixels, ((0, -high % block), (0, -wide % block), (0, 0)), mode="edge")
        rows, columns = (side // block for side in padded.shape[:2])
        pixels = padded.reshape(rows, block, columns, block, -1).mean(axis=(1, 3))
    return pixels


def has_ground(pixels: NDArray[np.float32]) -> bool:
    """Return whether an image, (h, w, c), has an opaque background."""
    return not (pixels.shape[2] == 4 and pixels[:, :, 3].min() < _OPAQUE)


def border_of(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the pixels at the border of an image, (n, c)."""
    return np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])


def figure_of(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Coverage of every pixel, (h, w, c), by the figure."""
    if not has_ground(pixels):
        return np.clip(pixels[:, :, 3], 0.0, 1.0)
    gray = pixels[:, :, :3] @ np.array([0.2126, 0.7152, 0.0722], np.float32) if pixels.shape[2] > 2 else pixels[:, :, 0]
    gray = np.clip(gray, 0.0, 1.0)
    return 1.0 - gray if np.median(border_of(gray)) > 0.5 else gray


def _outlines(silhouette: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Outlines in pixels that enclose the area of the silhouette."""
    half = np.clip((silhouette - 0.5) * 2.0 + 0.5, 0.0, 1.0)
    prepared = gaussian_filter(np.pad(half, 2), _SMOOTHED)
    outline = fitted_polygons(outline_enclosing(prepared, float(half.sum())).outline, _ERROR)
    return [ring - 2.0 for ring in outline.rings]
