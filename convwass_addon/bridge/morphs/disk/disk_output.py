# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Common code for outputs on disk: folders, paths for Blender, and file sizes."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from itertools import chain, count
from pathlib import Path

import bpy

from ....applications.whole_paths import whole_path
from ....errors import InputError
from ...files.output_paths import absolute_folder, creatable_folder, create_folder, file_stem
from ...linked_data import overriding
from ...unused_data import remove_if_unused

OUTPUT_KEY = "convwass_output"
"""Custom property of an object that shows a morph from files on disk: "volume" or "cache"."""

READERS_KEY = "convwass_readers"
"""Custom property of a morph's collection: the objects that were made to read its files, wherever they are moved."""

FOLDER_KEY = "convwass_folder"
"""Custom property of a morph's collection: JSON of the `_Place` of its files."""

# Folders that were handed out since Blender started.
_CREATED: set[Path] = set()


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


@dataclass(frozen=True)
class _Place:
    """Where a morph has its files.

    Attributes
    ----------
    folder : str
        The folder, as Blender stores paths.
    blend : str
        Name of the .blend file that the morph was in; empty if it was not saved.
    """

    folder: str
    blend: str

    @property
    def path(self) -> Path:
        """The absolute path of the folder."""
        return whole_path(bpy.path.abspath(self.folder))


def named_folder(path: str, morph: bpy.types.Collection) -> Path:
    """Return the folder that is named after a morph, without creating it.

    Parameters
    ----------
    path : str
        The parent folder as entered by the user; ``//`` stands for the folder of the .blend file.
    morph : bpy.types.Collection
        The morph.

    Raises
    ------
    InputError
        As for :func:`.files.absolute_folder`.
    """
    return absolute_folder(path) / file_stem(morph.name)


def free_folder(path: str, morph: bpy.types.Collection) -> Path:
    """Return a folder that nothing uses and that is named after a morph, without creating it.

    Even a morph that is written again gets another folder: Blender shows the first content of a .vdb or .usdc file
    until it ends, and saved versions of the .blend file show the old files.

    Parameters
    ----------
    path, morph
        As for `named_folder`.

    Raises
    ------
    InputError
        As for `named_folder`.
    """
    parent, name = absolute_folder(path), file_stem(morph.name)
    taken = {*_remembered_folders(), *_CREATED}
    tried = (parent / each for each in chain([name], (f"{name}_{number:03d}" for number in count(1))))
    return next(folder for folder in tried if folder not in taken and _is_unused(folder))


def own_folder(path: str, morph: bpy.types.Collection) -> Path:
    """Return the folder in which a morph has its files, or else a free one, without creating it.

    A morph has its files where it remembers them. They are not its own if the .blend file has another name now, as
    after *Save As*, or if another morph, such as a copy, has the same folder.

    Parameters
    ----------
    path, morph
        As for `named_folder`.

    Raises
    ------
    InputError
        As for `named_folder`.
    """
    parent, place = absolute_folder(path), _place_of(morph)
    if place is None or place.path.parent != parent or place.blend != bpy.path.basename(bpy.data.filepath):
        return free_folder(path, morph)
    return place.path if _remembered_folders().count(place.path) == 1 else free_folder(path, morph)


def remember_folder(morph: bpy.types.Collection, folder: Path) -> None:
    """Store with a morph that it has its files in a folder."""
    place = _Place(for_blender(folder), bpy.path.basename(bpy.data.filepath))
    morph[FOLDER_KEY] = json.dumps(vars(place))


def keep_folder(morph: bpy.types.Collection, blend: Path) -> None:
    """Store with a morph that the .blend file it is about to be saved to shows its files, if it has any."""
    place = _place_of(morph)
    if place is not None:
        morph[FOLDER_KEY] = json.dumps(vars(replace(place, blend=blend.name)))


def output_folder(folder: Path) -> Path:
    """Create and return a folder for files.

    Raises
    ------
    InputError
        The folder cannot be created or written.
    """
    create_folder(folder)
    _CREATED.add(folder)
    return folder


@contextmanager
def filled_folder(folder: Path) -> Iterator[Path]:
    """Provide a folder as `output_folder`; if it stays empty, it is removed, with those that were created for it.

    On an error or an interrupt, so are the files that were added, complete or not.
    """
    made = [folder, *(parent for parent in folder.parents if not parent.exists())]
    before = set(output_folder(folder).iterdir())
    try:
        yield folder
    except BaseException:
        # On Windows, files that Blender reads cannot be removed.
        with suppress(OSError):
            for added in set(folder.iterdir()) - before:
                added.unlink()
        raise
    finally:
        # Only empty folders can be removed.
        with suppress(OSError):
            for each in made:
                each.rmdir()


def for_blender(path: Path) -> str:
    """Return a path as stored in the open file: relative if the .blend is saved."""
    if not bpy.data.filepath:
        return str(path)
    try:
        return bpy.path.relpath(str(path))
    except ValueError:  # another drive on Windows
        return str(path)


def disk_outputs(morph: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the objects of a morph that read files, and their helper objects, but not meshes made from them.

    Those that were made for it come first, also from other collections; duplicates follow if they are in its own.
    """
    made = [obj for obj in _readers(morph) if obj.users_collection]
    others = [obj for obj in morph.objects if OUTPUT_KEY in obj and _made_for(obj) is None]
    return [obj for obj in (*made, *others) if not _was_converted(obj)]


def remember_readers(morph: bpy.types.Collection, objects: Sequence[bpy.types.Object]) -> None:
    """Store with a morph that objects read its files."""
    morph[READERS_KEY] = {str(number): obj for number, obj in enumerate(dict.fromkeys([*_readers(morph), *objects]))}


def read_morph(obj: bpy.types.Object | None) -> bpy.types.Collection | None:
    """Return the morph whose files an object was made to read, or None."""
    return None if obj is None or OUTPUT_KEY not in obj or _was_converted(obj) else _made_for(obj)


def readers_along(morph: bpy.types.Collection, objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return which objects read the files of a morph with it, such as duplicates; not those of a copy of the morph."""
    return [obj for obj in objects if read_morph(obj) in (None, morph)]


def _made_for(obj: bpy.types.Object) -> bpy.types.Collection | None:
    return next((morph for morph in bpy.data.collections if obj in _readers(morph)), None)


def _readers(morph: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the objects that `remember_readers` has stored, as far as they still exist."""
    stored = morph.get(READERS_KEY)
    values = stored.values() if hasattr(stored, "values") else ()
    return [overriding(obj, morph) for obj in values if isinstance(obj, bpy.types.Object)]


def _was_converted(obj: bpy.types.Object) -> bool:
    """Return whether an object has a mesh of its own in place of what it read; Blender keeps its custom properties."""
    reads = any(modifier.type in ("MESH_SEQUENCE_CACHE", "VOLUME_TO_MESH") for modifier in obj.modifiers)
    return obj.type == "MESH" and len(obj.data.polygons) > 0 and not reads


def cache_readers(obj: bpy.types.Object) -> list[bpy.types.MeshSequenceCacheModifier]:
    """Return the modifiers of an object that read Alembic or USD files."""
    return [modifier for modifier in obj.modifiers if modifier.type == "MESH_SEQUENCE_CACHE"]


def _cache_files(obj: bpy.types.Object) -> list[bpy.types.CacheFile]:
    return [modifier.cache_file for modifier in cache_readers(obj) if modifier.cache_file]


@dataclass(frozen=True)
class ReadFiles:
    """The files that show a morph, and how they can be written again.

    Attributes
    ----------
    output : str
        "VOLUME" or "CACHE".
    folder : str
        Parent of their folder, absolute.
    cache_format : str
        "alembic" or "usd".
    """

    output: str
    folder: str
    cache_format: str


def read_files(morph: bpy.types.Collection) -> ReadFiles | None:
    """Return the files that the objects of a morph read, or None."""
    for obj in disk_outputs(morph):
        for block in [obj.data] if obj.type == "VOLUME" else _cache_files(obj):
            file = whole_path(bpy.path.abspath(block.filepath))
            kind = "alembic" if file.suffix == ".abc" else "usd"
            return ReadFiles(obj[OUTPUT_KEY].upper(), str(file.parent.parent), kind)
    return None


def require_rewritable(morph: bpy.types.Collection) -> None:
    """Check that files can be written beside those that show a morph, if there are any.

    Raises
    ------
    InputError
        Names the folder, and an object that reads the files.
    """
    read = read_files(morph)
    if read is None:
        return
    try:
        creatable_folder(read.folder)
    except InputError as error:
        raise InputError(
            "The files that {name} shows cannot be written again, since {folder} is missing or cannot be written to; "
            "bring it back, or delete {name} to get meshes.",
            name=disk_outputs(morph)[0].name,
            folder=read.folder,
        ) from error


def remove_disk_outputs(morph: bpy.types.Collection) -> None:
    """Remove the objects of :func:`disk_outputs` and data that only they use; the files are kept."""
    objects = disk_outputs(morph)
    spare = [*(obj.data for obj in objects), *(file for obj in objects for file in _cache_files(obj))]
    bpy.data.batch_remove(objects)
    remove_if_unused(spare)


def packed_bytes(objects: Sequence[bpy.types.Object]) -> int:
    """Estimate the uncompressed size of the meshes of some objects in the .blend file."""
    meshes = {obj.data for obj in objects if obj.type == "MESH"}
    # Positions; corners with vertex and edge; edges; face offsets.
    return sum(12 * len(m.vertices) + 8 * len(m.loops) + 8 * len(m.edges) + 4 * len(m.polygons) for m in meshes)


def _remembered_folders() -> list[Path]:
    """Return the folders of all morphs of the file."""
    places = (_place_of(collection) for collection in bpy.data.collections)
    return [place.path for place in places if place is not None]


def _place_of(morph: bpy.types.Collection) -> _Place | None:
    """Return where a morph has its files, or None if that is unknown or damaged."""
    try:
        place = _Place(**json.loads(morph.get(FOLDER_KEY, "null")))
    except (TypeError, ValueError, RecursionError):
        return None
    return place if isinstance(place.folder, str) and isinstance(place.blend, str) else None


def _is_unused(folder: Path) -> bool:
    """Return whether a folder is empty or does not exist."""
    if not os.path.lexists(folder):
        return True
    try:
        return not any(folder.iterdir())
    except OSError:
        return False
