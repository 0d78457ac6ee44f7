# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Store tables of lobes by half and difference angle in images and OpenEXR files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.reflectance.lobe_lookup import HEIGHT, WIDTH
from ...applications.reflectance.lobe_table import LobeTable
from ...applications.reflectance.table_pictures import has_table_size, table_of_picture, table_picture
from ...applications.whole_paths import whole_path
from ...drafts import written_whole
from ...errors import InputError
from ..color_spaces import DATA, color_space
from ..files.data_images import data_image
from ..files.image_files import opened_image, pixel_values
from ..files.output_paths import checked_target
from .exr_header import exr_size

# Brighter lobes are invalid.
_LARGEST = 1e9
_MOST_STEPS = 256


def lobe_image(name: str, tables: Sequence[NDArray[np.float32]]) -> bpy.types.Image:
    """Create an image of one or more tables, stacked from the bottom up, and pack it into the .blend.

    Parameters
    ----------
    name : str
        Name of the image.
    tables : sequence of (64, 256, 3) float32
        f in 1/sr, as returned by :func:`..applications.reflectance.lobe_lookup.half_angle_table`.
    """
    return data_image(name, np.concatenate(tables))


def write_lobe_exr(path: Path, tables: Sequence[NDArray[np.float32]]) -> Path:
    """Write tables, (64, 256, 3) each, as one OpenEXR file of 32-bit floats, stacked as in the image.

    Raises
    ------
    InputError
        The folder is not writable.
    ConvwassError
        The file could not be written.
    """
    return _write_exr(path, np.concatenate(tables))


def write_table_exr(path: Path, table: LobeTable) -> Path:
    """Write a whole table in the same way; see :func:`...applications.reflectance.table_pictures.table_picture`."""
    return _write_exr(path, table_picture(table)[::-1])


def _write_exr(path: Path, values: NDArray[np.float32]) -> Path:
    """Write values, (height, width, 3), from the bottom row up."""
    target = checked_target(path)
    image = data_image("Lobes", values)
    try:
        image.file_format = "OPEN_EXR"
        with written_whole(target) as draft:
            image.filepath_raw = str(draft)
            image.save()
    finally:
        bpy.data.images.remove(image)
    return target


def holds_whole_table(path: Path) -> bool:
    """Return whether an OpenEXR file has the size of a whole table; raises InputError if it is not an OpenEXR file."""
    size = exr_size(whole_path(path))
    return has_table_size(size.width, size.height)


def read_table_exr(path: Path) -> LobeTable:
    """Read a file from :func:`write_table_exr`.

    Raises
    ------
    InputError
        The file does not exist, Blender cannot read it, or its size or values are invalid for a table.
    """
    file = whole_path(path)
    if not holds_whole_table(file):
        raise InputError("{name} is not a table of lobes.", name=file.name)
    return table_of_picture(_read_exr(file)[::-1], file.name)


def read_lobe_exr(path: Path) -> list[NDArray[np.float32]]:
    """Read a file from :func:`write_lobe_exr`.

    Raises
    ------
    InputError
        The file does not exist, Blender cannot read it, or its size or values are invalid for a material.
    """
    file = whole_path(path)
    size = exr_size(file)
    steps = size.height // HEIGHT
    if size.width != WIDTH or size.height != steps * HEIGHT or not 1 <= steps <= _MOST_STEPS:
        raise InputError("{name} is not a table of lobes.", name=file.name)
    values = _read_exr(file).reshape(steps, HEIGHT, WIDTH, 3)
    if not np.isfinite(values).all() or values.min() < 0 or values.max() > _LARGEST:
        raise InputError("{name} has values that are invalid for a table of lobes.", name=file.name)
    return list(values)


def _read_exr(file: Path) -> NDArray[np.float32]:
    """Read a file whose size was checked, (height, width, 3), from the bottom row up."""
    with opened_image(file) as image:
        image.colorspace_settings.name = color_space(DATA)
        width, height = image.size
        if not image.is_float or len(image.pixels) != width * height * image.channels or image.channels < 3:
            raise InputError("{name} is not a table of lobes.", name=file.name)
        return pixel_values(image)[..., :3]
