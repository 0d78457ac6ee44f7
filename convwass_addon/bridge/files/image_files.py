# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Load image files temporarily, and write them atomically."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...applications.whole_paths import whole_path
from ...drafts import written_whole
from ...errors import InputError
from ..color_spaces import show_unchanged
from ..operator_errors import reason
from .numbered_files import split_number, with_number

# JPEG quality in percent.
_QUALITY = 95


@dataclass(frozen=True)
class ImageFormat:
    """Format of an image file.

    Attributes
    ----------
    file_format : str
        Blender's name of the format, such as "PNG" or "OPEN_EXR".
    color_mode : str
        Blender's name of the channels: "BW", "RGB" or "RGBA".
    color_depth : str
        Bits per channel that the format supports: "8", "16" or "32".
    """

    file_format: str
    color_mode: str
    color_depth: str


def loaded_image(file: Path) -> bpy.types.Image:
    """Load an image; raises InputError if Blender cannot read it."""
    try:
        return bpy.data.images.load(str(file))
    except RuntimeError as error:
        raise InputError(
            "{file} could not be read; is it damaged? Blender says: {reason}", file=file.name, reason=reason(error)
        ) from error


def image_path(image: bpy.types.Image) -> Path:
    """Return the absolute path of the file of an image."""
    return Path(bpy.path.abspath(image.filepath, library=image.library))


def files_in_frame(image: bpy.types.Image, user: bpy.types.ImageUser, frame: int) -> list[Path]:
    """Return the files that Blender reads for an image; none if it is packed, generated or edited.

    Parameters
    ----------
    image : bpy.types.Image
        The image.
    user : bpy.types.ImageUser
        Which part of a sequence is shown, such as by a texture node.
    frame : int
        The scene frame.

    Returns
    -------
    list of Path
        Those of all tiles, or that of the frame.
    """
    if image.is_dirty:
        return []
    path = image_path(image)
    if image.source == "TILED":
        packed = {own.tile_number for own in image.packed_files}
        tiles = [tile.number for tile in image.tiles if tile.number not in packed]
        # Tiles without a path are generated.
        return [_of_tile(path, number) for number in tiles] if image.filepath else []
    if image.source == "GENERATED" or image.packed_file is not None:
        return []
    if image.source == "SEQUENCE" and split_number(path) is not None:
        return [with_number(path, max(0, _number_in_frame(user, frame)))]
    return [path]


def _of_tile(path: Path, number: int) -> Path:
    """Return the file of a UDIM tile, whose number, or column and row, stands in the place of a token."""
    row, column = divmod(number - 1001, 10)
    name = path.name.replace("<UDIM>", str(number)).replace("<UVTILE>", f"u{column + 1}_v{row + 1}")
    return path.with_name(name)


def _number_in_frame(user: bpy.types.ImageUser, frame: int) -> int:
    """Return the number of the file of a sequence that is shown in a scene frame, as Blender calculates it."""
    place, count = frame - user.frame_start + 1, user.frame_duration
    if count == 0:
        return 0
    if user.use_cyclic:
        place = (place - 1) % count + 1
    return min(max(place, 0), count) + user.frame_offset


def refuse_damaged(image: bpy.types.Image) -> None:
    """Raise InputError if Blender could not load an image whose file exists."""
    file = image_path(image)
    if image.source == "FILE" and image.packed_file is None and not image.has_data and file.is_file():
        raise InputError(
            "{file} could not be read; it is damaged, or of a format that Blender does not know.", file=file.name
        )


@contextmanager
def opened_image(path: str | Path) -> Iterator[bpy.types.Image]:
    """Load an image temporarily.

    Raises
    ------
    InputError
        The file does not exist, or Blender cannot read it.
    """
    file = whole_path(path)
    if not file.is_file():
        raise InputError("There is no file {file}.", file=str(file))
    image = loaded_image(file)
    try:
        yield image
    finally:
        bpy.data.images.remove(image)


@contextmanager
def drawn_image(
    pixels: NDArray[np.float32], colorspace: str | None = None, *, is_float: bool = True
) -> Iterator[bpy.types.Image]:
    """Create a temporary image from pixels.

    Parameters
    ----------
    pixels : (height, width, 4) float32
        RGBA, lowest row first.
    colorspace : str, optional
        Blender's name of the color space of the values; one of `DATA` for values without a view transform. By default
        that of new images.
    is_float : bool
        Store floats rather than bytes.
    """
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("Convwass", width, height, alpha=True, float_buffer=is_float)
    try:
        if colorspace is not None:
            image.colorspace_settings.name = colorspace
        image.pixels.foreach_set(np.ascontiguousarray(pixels, dtype=np.float32).ravel())
        yield image
    finally:
        bpy.data.images.remove(image)


def write_image(image: bpy.types.Image, path: Path, how: ImageFormat) -> None:
    """Write an image with unchanged values; the file is complete or not written at all.

    Image.save would apply sRGB encoding to floats, whatever their color space.

    Raises
    ------
    ConvwassError
        Blender or the system could not write the file.
    """
    with written_whole(path) as draft:
        save_image(image, draft, how)


def save_image(image: bpy.types.Image, draft: Path, how: ImageFormat) -> None:
    """Write an image as `write_image` does, to a draft whose creator reports errors."""
    with _format_scene(how) as scene:
        image.save_render(str(draft), scene=scene)


@contextmanager
def _format_scene(how: ImageFormat) -> Iterator[bpy.types.Scene]:
    """Provide a scene whose render settings define the image format."""
    scene = bpy.data.scenes.new("Convwass")
    try:
        settings = scene.render.image_settings
        settings.file_format = how.file_format
        settings.color_mode = how.color_mode
        settings.color_depth = how.color_depth
        settings.quality = _QUALITY
        if how.file_format == "OPEN_EXR":
            settings.exr_codec = "ZIP"
        show_unchanged(scene)
        scene.view_settings.look = "None"
        yield scene
    finally:
        bpy.data.scenes.remove(scene)


def opaque_pixels(colors: ArrayLike) -> NDArray[np.float32]:
    """Return colors, (height, width, 3), or grays, (height, width, 1), as pixels with an alpha of 1."""
    colors = np.asarray(colors)
    pixels = np.ones((*colors.shape[:2], 4), np.float32)
    pixels[..., :3] = colors
    return pixels


def pixel_values(image: bpy.types.Image) -> NDArray[np.float32]:
    """Return the pixels of an image as Blender stores them, (height, width, channels), bottom row first."""
    width, height = image.size
    values = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(height, width, image.channels)
