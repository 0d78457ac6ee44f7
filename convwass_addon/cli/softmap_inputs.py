# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The two objects of the command ``softmap``, loaded into one scene with all data that can be transferred."""

from __future__ import annotations

from contextlib import suppress

import bpy

from ..applications.whole_paths import whole_path
from ..bridge.files.blend_files import appended_objects, open_empty
from ..bridge.files.imports import BLEND, READERS, Source, import_objects, parse_source
from .density_inputs import object_in_scene, opened_object

# Formats that may contain weights and shape keys, which must not be applied.
_WITH_KEYS = (".gltf", ".glb", ".fbx", ".usd", ".usda", ".usdc", ".usdz")


def open_objects(source_text: str, target_text: str | None) -> tuple[bpy.types.Object, bpy.types.Object]:
    """Open the objects given on the command line; without a second name, return the first one twice.

    The first .blend is opened unchanged, without running its scripts; objects of other files are added to it, or to an
    empty scene.

    Raises
    ------
    InputError
        The files or objects cannot be used.
    """
    sources = [parse_source(text) for text in (source_text, target_text) if text is not None]
    opened = next((source for source in sources if _is_blend(source)), None)
    if opened is None:
        open_empty()
    else:
        main = opened_object(opened)
    found = []
    for source in sources:
        if source is opened:
            found.append(main)
        elif opened is not None and _is_blend(source) and source.path.resolve() == opened.path.resolve():
            found.append(object_in_scene(source))
        else:
            found.append(_added(source))
    return found[0], found[-1]


def _is_blend(source: Source) -> bool:
    return source.path.suffix.lower() == BLEND and source.path.is_file()


def _added(source: Source) -> bpy.types.Object:
    """Import an object of another file into the scene."""
    if _is_blend(source) and source.object_name:
        return _appended(source)
    if source.path.suffix.lower() in _WITH_KEYS and source.path.is_file():
        before = set(bpy.data.objects)
        # If this fails, import_objects below reports why.
        with suppress(RuntimeError):
            READERS[source.path.suffix.lower()](str(whole_path(source.path)))
        new = [obj for obj in bpy.data.objects if obj not in before]
        meshes = [obj for obj in new if obj.type == "MESH"]
        if len(meshes) == 1:
            return meshes[0]
        bpy.data.batch_remove(new)
    (obj,) = import_objects(source.path, source.names)
    return obj


def _appended(source: Source) -> bpy.types.Object:
    """Append an object unchanged, with its dependencies."""
    (obj,) = appended_objects(source.path, [source.object_name]).values()
    bpy.context.scene.collection.objects.link(obj)
    return obj
