# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Common code for outputs on disk: folders, paths for Blender, and file sizes."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...applications.whole_paths import whole_path
from ...errors import InputError

OUTPUT_KEY = "convwass_output"
"""Custom property of an object that shows a morph from files on disk: "volume" or "cache"."""

# Blender's prefix for paths relative to the .blend.
_FROM_BLEND = "//"


@dataclass(frozen=True)
class DiskOutput:
    """Files of a morph, and the object that reads them.

    Attributes
    ----------
    shown : bpy.types.Object
        A mesh object in the morph's collection.
    files : tuple of Path
        Absolute paths.
    """

    shown: bpy.types.Object
    files: tuple[Path, ...]

    @property
    def size(self) -> int:
        """Size in bytes."""
        return sum(file.stat().st_size for file in self.files)

    @property
    def megabytes(self) -> float:
        """Size in megabytes."""
        return self.size / 1e6


def folder_of(path: str, morph: bpy.types.Collection) -> Path:
    """Return the folder of a morph's files without creating it; see :func:`output_folder` for the parameters.

    Raises
    ------
    InputError
        The path is relative to an unsaved .blend file.
    """
    if path.startswith(_FROM_BLEND) and not bpy.data.filepath:
        raise InputError(
            "The folder {path} is relative to the .blend file: save that first, or choose an absolute path.", path=path
        )
    return whole_path(bpy.path.abspath(path)) / bpy.path.clean_name(morph.name)


def output_folder(path: str, morph: bpy.types.Collection) -> Path:
    """Create and return the folder of a morph's files.

    Parameters
    ----------
    path : str
        As entered by the user; ``//`` stands for the folder of the .blend file.
    morph : bpy.types.Collection
        Its name becomes the name of a subfolder.

    Raises
    ------
    InputError
        The path is relative to an unsaved .blend file, or the folder cannot be created or written.
    """
    folder = folder_of(path, morph)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "The folder {folder} cannot be created ({reason}); choose another one.",
            folder=str(folder),
            reason=error.strerror,
        ) from error
    if not os.access(folder, os.W_OK):
        raise InputError("The folder {folder} cannot be written to; choose another one.", folder=str(folder))
    return folder


@contextmanager
def filled_folder(path: str, morph: bpy.types.Collection) -> Iterator[Path]:
    """Provide the folder of a morph's files as `output_folder`; if it stays empty, it is removed."""
    folder = output_folder(path, morph)
    try:
        yield folder
    finally:
        # Only empty folders can be removed.
        with suppress(OSError):
            folder.rmdir()


def for_blender(path: Path) -> str:
    """Return a path as stored in the open file: relative if the .blend is saved."""
    if not bpy.data.filepath:
        return str(path)
    try:
        return bpy.path.relpath(str(path))
    except ValueError:  # another drive on Windows
        return str(path)


def disk_outputs(morph: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the objects of a morph that read files, and their helper objects."""
    return [obj for obj in morph.objects if OUTPUT_KEY in obj]


def remove_disk_outputs(morph: bpy.types.Collection) -> None:
    """Remove the objects of :func:`disk_outputs` and data that only they use; the files are kept."""
    objects = disk_outputs(morph)
    caches = {
        m.cache_file for obj in objects for m in obj.modifiers if m.type == "MESH_SEQUENCE_CACHE" and m.cache_file
    }
    spare = {obj.data for obj in objects if obj.data} | caches
    bpy.data.batch_remove(objects)
    bpy.data.batch_remove([block for block in spare if block.users == 0])


def packed_bytes(objects: Sequence[bpy.types.Object]) -> int:
    """Estimate the uncompressed size of the meshes of some objects in the .blend file."""
    meshes = {obj.data for obj in objects if obj.type == "MESH"}
    # Positions; corners with vertex and edge; edges; face offsets.
    return sum(12 * len(m.vertices) + 8 * len(m.loops) + 8 * len(m.edges) + 4 * len(m.polygons) for m in meshes)
