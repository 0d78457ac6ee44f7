# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Image files: read, and written whole or not at all."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.whole_paths import whole_path
from ...disk_room import require_whole
from ...errors import ConvwassError, InputError

FORMATS = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".tif": "TIFF", ".tiff": "TIFF", ".exr": "OPEN_EXR"}
"""File formats by the end of the name."""


@contextmanager
def opened_image(path: Path) -> Iterator[bpy.types.Image]:
    """Load an image, and remove it afterwards.

    Raises
    ------
    InputError
        No such file, or none that Blender reads.
    """
    file = whole_path(path)
    if not file.is_file():
        raise InputError("There is no file {file}.", file=str(file))
    try:
        image = bpy.data.images.load(str(file))
    except RuntimeError as error:
        raise InputError("{file} could not be read: {reason}", file=str(file), reason=str(error).strip()) from error
    try:
        yield image
    finally:
        bpy.data.images.remove(image)


def require_format(path: Path) -> str:
    """Return the format of a file to be written; raises InputError where its name says none."""
    found = FORMATS.get(path.suffix.lower())
    if found is None:
        raise InputError(
            "{name} does not end like an image; name it {stem}.png or {stem}.exr.", name=path.name, stem=path.stem
        )
    return found


def save_pixels(pixels: NDArray[np.float32], like: bpy.types.Image, path: Path, depth: str = "automatic") -> None:
    """Write pixels to a file.

    Parameters
    ----------
    pixels : (height, width, 4) float32
        As those of `like` are.
    like : bpy.types.Image
        Says what they mean: floats in the linear space of scenes, or bytes.
    path : Path
        Its end says the format.
    depth : str
        Bits of a channel: "8", "16" (PNG and TIFF), "32" (OpenEXR), or what suits the format and the image.

    Raises
    ------
    ConvwassError
        Blender or the system could not write the file.
    """
    kind = require_format(path)
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("Recolored", width, height, alpha=True, float_buffer=like.is_float)
    draft = path.with_name(f".{uuid.uuid4().hex}{path.suffix}")
    try:
        if not like.is_float:
            image.colorspace_settings.name = like.colorspace_settings.name
        image.pixels.foreach_set(np.ascontiguousarray(pixels, dtype=np.float32).ravel())
        with _format_scene(kind, _depth(kind, depth, like.is_float), bool((pixels[..., 3] < 1.0).any())) as scene:
            image.save_render(str(draft), scene=scene)
        require_whole(draft, path)
        os.replace(draft, path)
    except (RuntimeError, OSError) as error:
        reason = str(error).strip()
        raise ConvwassError("{file} could not be written: {reason}", file=str(path), reason=reason) from error
    finally:
        draft.unlink(missing_ok=True)
        bpy.data.images.remove(image)


def _depth(kind: str, depth: str, is_float: bool) -> str:
    allowed = {"PNG": ("8", "16"), "TIFF": ("8", "16"), "JPEG": ("8",), "OPEN_EXR": ("32", "16")}[kind]
    if depth == "automatic":
        return "32" if kind == "OPEN_EXR" else "16" if is_float and "16" in allowed else "8"
    if depth not in allowed:
        raise InputError(
            "{kind} files have {allowed} bits a channel, not {depth}.",
            kind=kind,
            allowed=", ".join(allowed),
            depth=depth,
        )
    return depth


@contextmanager
def _format_scene(kind: str, depth: str, has_alpha: bool) -> Iterator[bpy.types.Scene]:
    """Give a scene whose settings say how to write the colors as they are."""
    scene = bpy.data.scenes.new("Recolored")
    try:
        settings = scene.render.image_settings
        settings.file_format = kind
        settings.color_mode = "RGBA" if has_alpha and kind != "JPEG" else "RGB"
        if kind != "JPEG":
            settings.color_depth = depth
        settings.quality = 95
        scene.view_settings.view_transform, scene.view_settings.look = "Standard", "None"
        yield scene
    finally:
        bpy.data.scenes.remove(scene)
