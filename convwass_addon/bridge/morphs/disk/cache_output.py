# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Show a morph with one object that reads an Alembic or USD file."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import bpy

from ....errors import ConvwassError, InputError
from ...files.scratch_scene import scratch_scene
from ...operator_errors import reason
from ...render_settings import take_render_settings
from ...unused_data import remove_if_unused
from ..looks.materials import attribute_material
from ..stored import frame_objects, shown_frames
from .disk_output import (
    OUTPUT_KEY,
    DiskOutput,
    cache_readers,
    disk_outputs,
    for_blender,
    readers_along,
    remember_readers,
)
from .exports import COLORS, FORMATS, export_frames

_MATERIAL_NAME = "Convwass Cache"


def as_cache(collection: bpy.types.Collection, folder: Path, kind: Literal["alembic", "usd"]) -> DiskOutput:
    """Write a morph to a file, and let an object show it with a Mesh Sequence Cache modifier; an existing one is kept.

    Parameters
    ----------
    collection : bpy.types.Collection
        A baked morph with its frames, which are kept.
    folder : Path
        An existing folder, which gives the file its name; a file of that name is replaced, but Blender may show its
        old content until it ends.
    kind : "alembic" or "usd"
        The file format.

    Raises
    ------
    InputError, ConvwassError
        As for `require_animation` and :func:`.exports.export_frames`, or Blender cannot read the file back; it is
        removed then.
    """
    require_animation(collection)
    file = folder / (folder.name + FORMATS[kind].suffixes[0])
    # Replaces a file that Blender may be reading, rather than writing into it.
    export_frames(collection, file, kind)
    try:
        shown = _read_back(file, kind)
    except ConvwassError:
        file.unlink(missing_ok=True)
        raise
    read = cache_readers(shown)[0].cache_file
    read.filepath = for_blender(file)
    # A morph that begins before frame 0 is written from 0 on.
    read.frame_offset = min(shown_frames(collection)[0], 0)
    before = next(filter(cache_readers, disk_outputs(collection)), None)
    made = _named(collection, shown) if before is None else _reading_as(collection, before, shown)
    remember_readers(collection, [made])
    return DiskOutput(made, (file,))


def _named(collection: bpy.types.Collection, shown: bpy.types.Object) -> bpy.types.Object:
    """Add an imported object to a morph."""
    shown.name = f"{collection.name} Cache"
    shown[OUTPUT_KEY] = "cache"
    take_render_settings(shown, frame_objects(collection))
    collection.objects.link(shown)
    shown.data.materials.clear()
    shown.data.materials.append(attribute_material(_MATERIAL_NAME, COLORS))
    return shown


def _reading_as(
    collection: bpy.types.Collection, shown: bpy.types.Object, imported: bpy.types.Object
) -> bpy.types.Object:
    """Let an object of a morph and its duplicates read what an imported one does, which is removed."""
    own, other = cache_readers(shown)[0], cache_readers(imported)[0]
    before = own.cache_file
    spare = [imported.data, before]
    readers = [reader for obj in readers_along(collection, bpy.data.objects) for reader in cache_readers(obj)]
    for reader in [own] if before is None else [reader for reader in readers if reader.cache_file == before]:
        reader.cache_file = other.cache_file
        reader.object_path = other.object_path
    # The old file must not be removed while it is evaluated.
    bpy.context.evaluated_depsgraph_get().update()
    bpy.data.objects.remove(imported)
    remove_if_unused(spare)
    return shown


def require_animation(collection: bpy.types.Collection) -> None:
    """Check that a morph is animated, since Blender does not read static caches.

    Raises
    ------
    InputError
        The morph is a sheet, a single blend, or a single frame of a path.
    """
    if frame_objects(collection) and len(shown_frames(collection)) < 2:
        raise InputError(
            "A cache requires an animation, but {name} is static; bake an animation, or choose another output.",
            name=collection.name,
        )


def _read_back(file: Path, kind: str) -> bpy.types.Object:
    """Import the animated mesh of a file, without a collection."""
    existing = set(bpy.data.objects)
    with scratch_scene():
        try:
            if kind == "alembic":
                bpy.ops.wm.alembic_import(filepath=str(file), as_background_job=False, set_frame_range=False)
            else:
                bpy.ops.wm.usd_import(filepath=str(file), set_frame_range=False)
        except RuntimeError as error:
            raise ConvwassError(
                "{file} could not be read back: {reason}", file=str(file), reason=reason(error)
            ) from error
        made = [obj for obj in bpy.data.objects if obj not in existing]
        cached = list(filter(cache_readers, made))
        if not cached:
            bpy.data.batch_remove(made)
            raise ConvwassError("{file} would contain no animated mesh; choose another output.", file=str(file))
        shown = cached[0]
        place = shown.matrix_world.copy()
        shown.parent = None
        shown.matrix_world = place
        for constraint in list(shown.constraints):
            shown.constraints.remove(constraint)
        for user in list(shown.users_collection):
            user.objects.unlink(shown)
        bpy.data.batch_remove([obj for obj in made if obj != shown])
    return shown
