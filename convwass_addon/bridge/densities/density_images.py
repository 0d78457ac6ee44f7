# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities as images, through the UV map of a mesh: what texture painters and other programs read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.uv_pixels import UvPixels, uv_pixels
from ..files import made_folder
from ..image_files import ImageFormat, drawn_image, write_image
from ..mesh_checks import readable_mesh
from ..numbered_files import numbered_paths
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
    target = made_folder(folder)
    pixels = mesh_pixels(obj, settings)
    largest = float(frames.max(initial=0.0))
    scale = 1.0 / largest if settings.file_format == "PNG" and largest > 0.0 else 1.0
    suffix = SUFFIXES[settings.file_format]
    paths = numbered_paths(target, f"{bpy.path.clean_name(name)}.", suffix, range(len(frames)))
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


def _written(
    pixels: UvPixels, frames: NDArray[np.float64], paths: list[Path], settings: ImageSettings
) -> Iterator[Path]:
    how = ImageFormat(settings.file_format, "BW", DEPTHS[settings.file_format])
    for values, path in zip(frames, paths, strict=True):
        # No view transform may touch the values.
        with drawn_image(_gray(pixels.picture(values)), "Non-Color") as image:
            write_image(image, path, how)
        yield path


def _gray(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return gray pixels, (height, width, 4), of values, (height, width)."""
    rgba = np.ones((*values.shape, 4), dtype=np.float32)
    rgba[..., :3] = values[..., None]
    return rgba
