# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What outputs that live on disk have in common: where the files go, how Blender is told, and what they weigh."""

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

# Blender's notation for a path from the folder of the .blend.
_FROM_BLEND = "//"


@dataclass(frozen=True)
class DiskOutput:
    """Files that show a morph, and the object that reads them.

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
        """Bytes on disk."""
        return sum(file.stat().st_size for file in self.files)

    @property
    def megabytes(self) -> float:
        """The same for reports."""
        return self.size / 1e6


def folder_of(path: str, morph: bpy.types.Collection) -> Path:
    """Return the folder of a morph's files, which need not be there; parameters are those of :func:`output_folder`.

    Raises
    ------
    InputError
        A path from a .blend file that has not been saved.
    """
    if path.startswith(_FROM_BLEND) and not bpy.data.filepath:
        raise InputError(
            "The folder {path} lies beside the .blend file: save that first, or give a whole path.", path=path
        )
    return whole_path(bpy.path.abspath(path)) / bpy.path.clean_name(morph.name)


def output_folder(path: str, morph: bpy.types.Collection) -> Path:
    """Make and return the folder of a morph's files.

    Parameters
    ----------
    path : str
        As the user wrote it; ``//`` stands for the folder of the saved .blend file.
    morph : bpy.types.Collection
        Its name becomes that of a folder inside.

    Raises
    ------
    InputError
        A path from a .blend file that has not been saved, or a folder that cannot be made or written to.
    """
    folder = folder_of(path, morph)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "The folder {folder} cannot be made ({reason}); choose another one.",
            folder=str(folder),
            reason=error.strerror,
        ) from error
    if not os.access(folder, os.W_OK):
        raise InputError("The folder {folder} cannot be written to; choose another one.", folder=str(folder))
    return folder


@contextmanager
def filled_folder(path: str, morph: bpy.types.Collection) -> Iterator[Path]:
    """Give the folder of a morph's files, as `output_folder`; where filling it fails, it does not stay empty."""
    folder = output_folder(path, morph)
    try:
        yield folder
    finally:
        # Only a folder without files can be removed.
        with suppress(OSError):
            folder.rmdir()


def for_blender(path: Path) -> str:
    """Return a path as the open file should keep it: relative where the .blend has a place."""
    if not bpy.data.filepath:
        return str(path)
    try:
        return bpy.path.relpath(str(path))
    except ValueError:  # another drive on Windows
        return str(path)


def disk_outputs(morph: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the objects of a morph that read files, and those that these need."""
    return [obj for obj in morph.objects if OUTPUT_KEY in obj]


def remove_disk_outputs(morph: bpy.types.Collection) -> None:
    """Remove the objects of :func:`disk_outputs` and what they alone use; the files stay where they are."""
    objects = disk_outputs(morph)
    caches = {
        m.cache_file for obj in objects for m in obj.modifiers if m.type == "MESH_SEQUENCE_CACHE" and m.cache_file
    }
    spare = {obj.data for obj in objects if obj.data} | caches
    bpy.data.batch_remove(objects)
    bpy.data.batch_remove([block for block in spare if block.users == 0])


def packed_bytes(objects: Sequence[bpy.types.Object]) -> int:
    """Estimate what the meshes of some objects add to the .blend file before compression."""
    meshes = {obj.data for obj in objects if obj.type == "MESH"}
    # Positions; corners with their vertices and edges; edges; offsets of faces.
    return sum(12 * len(m.vertices) + 8 * len(m.loops) + 8 * len(m.edges) + 4 * len(m.polygons) for m in meshes)
