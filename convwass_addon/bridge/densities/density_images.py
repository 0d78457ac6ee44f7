# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write densities as images using a UV map, for texture painting and other programs."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, count
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.meshes.uv_pixels import UvPixels, uv_pixels
from ...sentence import Sentence
from ..color_spaces import DATA, color_space
from ..element_values import MeshTriangles, element_values
from ..files.image_files import ImageFormat, drawn_image, opaque_pixels, write_image
from ..files.numbered_files import numbered_paths
from ..files.output_paths import absolute_folder, file_stem, made_folder
from ..mesh_checks import readable_mesh, require_not_edited
from ..morphs.disk.disk_output import for_blender
from .density_attributes import checked_frames
from .density_nodes import NAME
from .density_store import outputs_of_others, store_density, stored_or_new

IMAGES = "images"
"""Key of the paths stored with an object, as Blender stores paths."""

# Key of the name of the .blend file that the images were written from; empty if it was not saved.
_BLEND = "images_from"

DEPTHS = {"PNG": "16", "OPEN_EXR": "32"}
"""File formats and their bits per channel."""

SUFFIXES = {"PNG": ".png", "OPEN_EXR": ".exr"}


@dataclass(frozen=True)
class ImageSettings:
    """Settings of the images.

    Attributes
    ----------
    size : int
        Pixels along a side.
    margin : int
        Pixels filled around the islands of the UV map, so that seams do not show.
    file_format : str
        A key of `DEPTHS`. PNG has 65536 shades of gray from 0 to the maximum over all steps, OpenEXR the unscaled
        values.
    uv_map : str
        Name of a UV map; empty for the active render UV map.
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
    """Write one image per step; each file is complete when its path is yielded.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh with a UV map, not in Edit Mode. Only the tile from 0 to 1 is drawn.
    densities : (f, n) array_like
        One non-negative value per vertex.
    folder : str or Path
        Output folder; // stands for the folder of the .blend file. The last folder is created if missing. If it
        contains other files of these names, such as images of a bake that was undone or of another .blend file, the
        images are written to a folder in it.
    name : str
        File names are this name followed by the number of the step.
    settings : ImageSettings, optional
        Settings of the images.

    Yields
    ------
    Path
        Path of each image.

    Raises
    ------
    InputError
        There is no UV map or an empty one, the mesh is in Edit Mode, the folder cannot be written, or it contains
        images of these names of another density in the .blend file. Raised before the first step.
    ConvwassError
        An image could not be written.
    """
    settings = settings or ImageSettings()
    frames = checked_frames(densities, len(readable_mesh(obj).vertices))
    pixels = mesh_pixels(obj, settings)
    largest = float(frames.max(initial=0.0))
    scale = 1.0 / largest if settings.file_format == "PNG" and largest > 0.0 else 1.0
    paths = _own_paths(obj, name, made_folder(folder), SUFFIXES[settings.file_format], len(frames))
    return _written(pixels, frames * scale, paths, settings)


def remember_images(obj: bpy.types.Object, name: str, made: Sequence[Path]) -> list[Path]:
    """Store with a density that images are its own, so that the next bake may replace them and no other one does.

    Returns
    -------
    list of Path
        Images of earlier bakes, which stay its own.
    """
    places = {*map(_place, made), *_images_of_others(obj, name)}
    left = [path for path in _known_images(obj, name) if _place(path) not in places and path.is_file()]
    known = stored_or_new(obj, name)
    own = {IMAGES: [for_blender(path) for path in (*made, *left)], _BLEND: [bpy.path.basename(bpy.data.filepath)]}
    store_density(obj, name, replace(known, outputs={**known.outputs, **own}))
    return left


def _known_images(obj: bpy.types.Object, name: str) -> list[Path]:
    """Return the images of a density, which copies of its object have, too.

    Empty if the .blend file has another name now, as after *Save As*.
    """
    outputs = stored_or_new(obj, name).outputs
    before = "".join(outputs.get(_BLEND, ()))
    if before and before != bpy.path.basename(bpy.data.filepath):
        return []
    return [Path(bpy.path.abspath(path)) for path in outputs.get(IMAGES, ())]


def _images_of_others(obj: bpy.types.Object, name: str) -> dict[str, bpy.types.Object]:
    """Return the objects that other images of the file belong to, by the places of these."""
    return {_place(path): other for other, path in outputs_of_others(obj, name, IMAGES)}


def _own_paths(obj: bpy.types.Object, name: str, folder: Path, suffix: str, steps: int) -> list[Path]:
    """Return where to write images: in a folder, or in the first one in it where they replace no other files."""
    stem = file_stem(name)
    known, others = set(map(_place, _known_images(obj, name))), _images_of_others(obj, name)
    own = known.difference(others)
    for tried in chain([folder], (folder / f"{stem}_{number:03d}" for number in count(1))):
        paths = numbered_paths(tried, f"{stem}.", suffix, range(steps))
        foreign = [path for path in paths if _place(path) not in own]
        if tried == folder:
            # Images that a copy of the object has, too, are kept in the folder instead.
            _require_no_others([path for path in foreign if _place(path) not in known], others)
        if not any(path.exists() or _place(path) in others for path in foreign):
            break
    made_folder(paths[0].parent)
    return paths


def _require_no_others(paths: Sequence[Path], others: Mapping[str, bpy.types.Object]) -> None:
    """Raise InputError if files are images of other densities of the .blend file."""
    taken = [path for path in paths if _place(path) in others]
    if taken:
        raise InputError(
            "{file} is an image of a density of {object} and would be overwritten; choose another folder.",
            file=str(taken[0]),
            object=others[_place(taken[0])].name,
        )


def kept_files_notices(folder: str, made: Sequence[Path]) -> list[Sentence]:
    """Return a notice if images were written to another folder, to keep files of the same names.

    Parameters
    ----------
    folder : str
        The folder as entered by the user.
    made : sequence of Path
        The images.
    """
    wanted = absolute_folder(folder)
    if not made or made[0].parent == wanted:
        return []
    kept = sum((wanted / path.name).exists() for path in made)
    values = {"folder": str(wanted), "count": kept}
    return [Sentence("{folder} contains other files of these names ({count}), which are kept", values)]


def _place(path: str | Path) -> str:
    return os.path.normcase(os.path.realpath(bpy.path.abspath(str(path))))


def mesh_pixels(obj: bpy.types.Object, settings: ImageSettings) -> UvPixels:
    """Find the surface point of each pixel.

    Raises
    ------
    InputError
        As `write_step_images`.
    """
    mesh = readable_mesh(obj)
    require_not_edited(obj)
    layer = _uv_layer(obj, settings.uv_map)
    triangles = MeshTriangles.of(mesh)
    loops, faces = triangles.loops, triangles.vertices
    uv = element_values(layer.uv, "vector", 2)
    pixels = uv_pixels(uv[loops], faces, settings.size, settings.margin)
    if not len(pixels.places):
        raise InputError(
            "The UV map {layer} of {object} covers no pixel between 0 and 1; unwrap the mesh in Edit Mode: UV > "
            "Unwrap.",
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
        # The view transform must not change the values.
        with drawn_image(opaque_pixels(pixels.picture(values)[..., None]), color_space(DATA)) as image:
            write_image(image, path, how)
        yield path
