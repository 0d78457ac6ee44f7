# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities as images, through the UV map of a mesh: what texture painters and other programs read."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import ConvwassError, InputError
from ...geometry.uv_pixels import UvPixels, uv_pixels
from ..mesh_checks import readable_mesh
from .density_nodes import NAME

DEPTHS = {"PNG": "16", "OPEN_EXR": "32"}
"""File formats, and the bits of a pixel."""

SUFFIXES = {"PNG": ".png", "OPEN_EXR": ".exr"}


@dataclass(frozen=True)
class ImageSettings:
    """What images are to be like.

    Attributes
    ----------
    size : int
        Pixels along a side.
    margin : int
        Pixels around the islands of the UV map that are filled, so that no seams show.
    file_format : str
        One of `DEPTHS`. PNG holds 65536 shades of gray from 0 to the largest value of all steps, OpenEXR the values.
    uv_map : str
        Name of a UV map; empty for that of renders.
    """

    size: int = 1024
    margin: int = 8
    file_format: str = "PNG"
    uv_map: str = ""


def write_step_images(
    obj: bpy.types.Object,
    densities: ArrayLike,
    folder: str | Path,
    name: str = NAME,
    settings: ImageSettings | None = None,
) -> Iterator[Path]:
    """Write one image for each step; each file is there as soon as its path is yielded, whole or not at all.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh with a UV map, in any mode but Edit Mode. Only the tile from 0 to 1 is drawn.
    densities : (f, n) array_like
        One value per vertex, not negative.
    folder : str or Path
        Where to; a path that starts with two slashes goes from the saved file. Its last folder is made if missing.
    name : str
        Files are called by it and the number of the step.
    settings : ImageSettings, optional
        What images are to be like.

    Yields
    ------
    Path
        One after the other.

    Raises
    ------
    InputError
        No UV map or an empty one, in Edit Mode, or a folder that cannot be written to. Raised before the first step.
    ConvwassError
        An image could not be written.
    """
    settings = settings or ImageSettings()
    frames = np.atleast_2d(np.asarray(densities, dtype=np.float64))
    if frames.ndim != 2 or frames.shape[1] != len(readable_mesh(obj).vertices):
        raise ValueError(f"densities of shape {frames.shape} for {len(obj.data.vertices)} vertices")
    target = _checked_folder(folder)
    pixels = mesh_pixels(obj, settings)
    largest = float(frames.max(initial=0.0))
    scale = 1.0 / largest if settings.file_format == "PNG" and largest > 0.0 else 1.0
    suffix = SUFFIXES[settings.file_format]
    paths = [target / f"{bpy.path.clean_name(name)}.{step:04d}{suffix}" for step in range(len(frames))]
    return _written(pixels, frames * scale, paths, settings)


def mesh_pixels(obj: bpy.types.Object, settings: ImageSettings) -> UvPixels:
    """Find which point of a mesh every pixel shows.

    Raises
    ------
    InputError
        As `write_step_images`.
    """
    mesh = readable_mesh(obj)
    if mesh.is_editmode:
        raise InputError("{object} is in Edit Mode; leave it with Tab, then try again.", object=obj.name)
    layer = _uv_layer(obj, settings.uv_map)
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    loops, faces = np.empty((2, 3 * count), dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    mesh.loop_triangles.foreach_get("vertices", faces)
    uv = np.empty(2 * len(mesh.loops), dtype=np.float32)
    layer.uv.foreach_get("vector", uv)
    pixels = uv_pixels(uv.reshape(-1, 2)[loops.reshape(-1, 3)], faces.reshape(-1, 3), settings.size, settings.margin)
    if not len(pixels.places):
        raise InputError(
            "The UV map {layer} of {object} covers no pixel from 0 to 1; unwrap the mesh in Edit Mode: UV > Unwrap.",
            layer=layer.name,
            object=obj.name,
        )
    return pixels


def _uv_layer(obj: bpy.types.Object, name: str) -> bpy.types.MeshUVLoopLayer:
    layers = obj.data.uv_layers
    if not len(layers):
        raise InputError("{object} has no UV map; unwrap it in Edit Mode: UV > Unwrap.", object=obj.name)
    if name and name not in layers:
        raise InputError(
            "{object} has no UV map {name}; it has: {layers}.",
            object=obj.name,
            name=name,
            layers=", ".join(layers.keys()),
        )
    if name:
        return layers[name]
    return next((layer for layer in layers if layer.active_render), layers[0])


def _checked_folder(folder: str | Path) -> Path:
    text = str(folder)
    if text.startswith("//") and not bpy.data.filepath:
        raise InputError("Save the file first: {folder} is relative to it. Or choose a whole path.", folder=text)
    target = Path(bpy.path.abspath(text)).expanduser().absolute()
    if target.exists() and not target.is_dir():
        raise InputError("{folder} is a file; choose a folder.", folder=str(target))
    if not target.parent.is_dir():
        raise InputError(
            "The folder {folder} does not exist; make it first, or choose another one.", folder=str(target.parent)
        )
    try:
        target.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError("The folder {folder} cannot be made; choose another one.", folder=str(target)) from error
    if not os.access(target, os.W_OK):
        raise InputError("The folder {folder} cannot be written to; choose another one.", folder=str(target))
    return target


def _written(
    pixels: UvPixels, frames: NDArray[np.float64], paths: list[Path], settings: ImageSettings
) -> Iterator[Path]:
    for values, path in zip(frames, paths, strict=True):
        with _drawn(pixels.picture(values)) as image, _format_scene(settings.file_format) as scene:
            draft = path.with_name(f".{uuid.uuid4().hex}{path.suffix}")
            try:
                image.save_render(str(draft), scene=scene)
                os.replace(draft, path)
            except (RuntimeError, OSError) as error:
                reason = str(error).strip()
                raise ConvwassError("{path} could not be written: {reason}", path=str(path), reason=reason) from error
            finally:
                draft.unlink(missing_ok=True)
        yield path


@contextmanager
def _drawn(values: NDArray[np.float32]) -> Iterator[bpy.types.Image]:
    """Give an image of gray values, (height, width), which no view transform touches."""
    height, width = values.shape
    image = bpy.data.images.new("Density", width, height, float_buffer=True, is_data=True)
    try:
        rgba = np.ones((height, width, 4), dtype=np.float32)
        rgba[..., :3] = values[..., None]
        image.pixels.foreach_set(rgba.ravel())
        yield image
    finally:
        bpy.data.images.remove(image)


@contextmanager
def _format_scene(file_format: str) -> Iterator[bpy.types.Scene]:
    """Give a scene whose render settings say how to write a gray image."""
    scene = bpy.data.scenes.new("Density")
    try:
        settings = scene.render.image_settings
        settings.file_format = file_format
        settings.color_mode, settings.color_depth = "BW", DEPTHS[file_format]
        if file_format == "OPEN_EXR":
            settings.exr_codec = "ZIP"
        yield scene
    finally:
        bpy.data.scenes.remove(scene)
