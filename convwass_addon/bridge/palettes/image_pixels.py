# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert Blender's images to arrays of pixels and back."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.palettes.distinct_colors import LEVELS
from ...applications.palettes.pixels import PixelFormat
from ...applications.palettes.recolor_job import Picture
from ...errors import InputError
from ..color_spaces import DATA, LINEAR, SRGB
from ..files.image_files import pixel_values, refuse_damaged
from ..last_result import last_result
from ..scene_colors import scene_to_rec709
from .image_kinds import RESULT_OF, source_of


def read_picture(image: bpy.types.Image, mask: bpy.types.Image | None = None, name: str = "") -> Picture:
    """Read an image, and a mask of the same size.

    Parameters
    ----------
    image : bpy.types.Image
        The image.
    mask : bpy.types.Image, optional
        The mask.
    name : str
        Name of the image in messages; empty for its own.

    Raises
    ------
    InputError
        No pixels, tiles, an unsupported color space, or a mask of another size.
    """
    pixels, name = read_pixels(image), name or image.name
    return Picture(pixels, image_format(image), None if mask is None else _mask(mask, image, name), name=name)


def read_pixels(image: bpy.types.Image) -> NDArray[np.float32]:
    """Return the pixels of an image, (height, width, 4), from bottom to top; missing channels become gray and opaque.

    Raises
    ------
    InputError
        No pixels in memory: the file is missing, or the image is a render that is only displayed. Or the image has UDIM
        tiles, of which Blender provides only the first.
    """
    if image.source == "TILED":
        raise InputError(
            "{image} has UDIM tiles, which are images of their own; open the files of the tiles as single images.",
            image=image.name,
        )
    width, height = image.size
    # Accessing a pixel loads the file.
    if not width * height or not len(image.pixels):
        refuse_damaged(image)
        raise InputError(
            "{image} has no pixels that could be read; load it, or save a render as a file first.", image=image.name
        )
    channels = image.channels
    found = pixel_values(image)
    if channels == 4:
        return found
    full = np.ones((height, width, 4), dtype=np.float32)
    full[..., :3] = found[..., :3] if channels == 3 else found[..., :1]
    if channels == 2:
        full[..., 3] = found[..., 1]
    return full


def image_format(image: bpy.types.Image) -> PixelFormat:
    """Return the format of the pixels of an image.

    Blender stores floats in the linear scene color space with premultiplied alpha, and bytes as they are in the file.

    Raises
    ------
    InputError
        Bytes in a color space other than sRGB or linear.
    """
    ignores_alpha = image.alpha_mode in ("NONE", "CHANNEL_PACKED")
    if image.is_float:
        alpha = "ignored" if ignores_alpha else "associated"
        return PixelFormat("linear", alpha, scene_to_rec709(), np.inf)
    space = image.colorspace_settings.name
    if space not in (*LINEAR, *SRGB, *DATA):
        raise InputError(
            "{image} is in the color space {space}, which is not supported; set it to sRGB or Linear Rec.709, or "
            "convert the image to floats.",
            image=image.name,
            space=space,
        )
    encoding, alpha = "linear" if space in LINEAR else "srgb", "ignored" if ignores_alpha else "straight"
    return PixelFormat(encoding, alpha, levels=LEVELS)


def _mask(mask: bpy.types.Image, image: bpy.types.Image, name: str) -> NDArray[np.float32]:
    if tuple(mask.size) != tuple(image.size):
        raise InputError(
            "The mask {mask} has {width} x {height} pixels, unlike {image}; scale it: Image > Resize.",
            mask=mask.name,
            width=mask.size[0],
            height=mask.size[1],
            image=name,
        )
    values = read_pixels(mask)[..., :3].mean(axis=2)
    return np.clip(np.nan_to_num(values), 0.0, 1.0)


def result_image(source: bpy.types.Image) -> bpy.types.Image:
    """Return an image for a result: the previous result of the same size and format, or a new image."""
    width, height = source.size
    name, wanted = f"{source.name} recolored", (source, (width, height), source.is_float)
    stills = (image for image in bpy.data.images if image.source != "SEQUENCE")
    alike = (image for image in stills if (source_of(image), tuple(image.size), image.is_float) == wanted)
    image = last_result(alike, name)
    if image is not None:
        return image
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=source.is_float)
    if not source.is_float:
        image.colorspace_settings.name = source.colorspace_settings.name
    # Bytes are read with straight alpha, whatever the file format.
    premultiplied = source.alpha_mode == "PREMUL" and not source.is_float
    image.alpha_mode = "STRAIGHT" if premultiplied else source.alpha_mode
    image[RESULT_OF] = source
    return image


def require_local(image: bpy.types.Image) -> None:
    """Raise InputError if an image is linked from another file."""
    if image.library is not None:
        raise InputError(
            "{image} is linked from another file and cannot be changed here; make it local.", image=image.name
        )


def write_pixels(image: bpy.types.Image, pixels: NDArray[np.float32]) -> None:
    """Write pixels, (height, width, 4), to an image of the same size.

    Raises
    ------
    InputError
        The size of the image has changed, or it is linked from another file.
    """
    require_local(image)
    if tuple(image.size) != pixels.shape[1::-1]:
        raise InputError("The size of {image} has changed since the start; start again.", image=image.name)
    channels = image.channels
    if channels == 4:
        own = pixels
    elif channels == 2:
        own = np.stack([pixels[..., :3].mean(axis=2), pixels[..., 3]], axis=-1)
    else:
        own = pixels[..., :3] if channels == 3 else pixels[..., :3].mean(axis=2)
    image.pixels.foreach_set(np.ascontiguousarray(own, dtype=np.float32).ravel())
    image.update()


def keep_in_file(image: bpy.types.Image, file: bytes | None = None) -> None:
    """Store a result in the .blend, because pixels without a file would be lost.

    Parameters
    ----------
    image : bpy.types.Image
        The result.
    file : bytes or None
        The result as a file that the image uses from now on; None to pack its own pixels.
    """
    if file is None:
        image.pack()
        return
    image.pack(data=file, data_len=len(file))
    image.source = "FILE"
    # Its previous file is out of date.
    image.buffers_free()
