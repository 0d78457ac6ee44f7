# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read image files, and write them completely or not at all."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..files.image_files import ImageFormat, drawn_image, write_image

FORMATS = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".tif": "TIFF", ".tiff": "TIFF", ".exr": "OPEN_EXR"}
"""File formats by extension."""

# Bits per channel by format.
_DEPTHS = {"PNG": ("8", "16"), "TIFF": ("8", "16"), "JPEG": ("8",), "OPEN_EXR": ("16", "32")}


def require_format(path: Path) -> str:
    """Return the format of a file to be written; raises InputError if its extension is unknown."""
    found = FORMATS.get(path.suffix.lower())
    if found is None:
        raise InputError(
            "{name} does not end like an image; name it {stem}.png or {stem}.exr.", name=path.name, stem=path.stem
        )
    return found


def require_depth(path: Path, depth: str) -> None:
    """Raise InputError if a file to be written cannot have this many bits per channel, as for :func:`save_pixels`."""
    kind = require_format(path)
    allowed = _DEPTHS[kind]
    if depth != "automatic" and depth not in allowed:
        raise InputError(
            "{kind} files have {allowed} bits a channel, not {depth}.",
            kind="OpenEXR" if kind == "OPEN_EXR" else kind,
            allowed=", ".join(allowed),
            depth=depth,
        )


def save_pixels(pixels: NDArray[np.float32], like: bpy.types.Image, path: Path, depth: str = "automatic") -> None:
    """Write pixels to a file.

    Parameters
    ----------
    pixels : (height, width, 4) float32
        In the format of the pixels of `like`.
    like : bpy.types.Image
        Defines the format: floats in the linear scene color space, or bytes.
    path : Path
        Its extension defines the file format.
    depth : str
        Bits per channel: "8", "16" (PNG and TIFF), "32" (OpenEXR), or automatic for the format and the image.

    Raises
    ------
    InputError
        The format does not have these bits per channel.
    ConvwassError
        Blender or the system could not write the file.
    """
    require_depth(path, depth)
    kind = require_format(path)
    mode = "RGBA" if kind != "JPEG" and (pixels[..., 3] < 1.0).any() else "RGB"
    colorspace = None if like.is_float else like.colorspace_settings.name
    with drawn_image(pixels, colorspace, is_float=like.is_float) as image:
        write_image(image, path, ImageFormat(kind, mode, _depth(kind, depth, like.is_float)))


def _depth(kind: str, depth: str, is_float: bool) -> str:
    if depth != "automatic":
        return depth
    return "32" if kind == "OPEN_EXR" else "16" if is_float and "16" in _DEPTHS[kind] else "8"
