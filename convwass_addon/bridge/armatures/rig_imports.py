# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Load a body and a rig from files into one scene."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...applications.whole_paths import whole_path
from ...errors import InputError
from ..files.blend_files import appended_objects, open_blend, open_empty, several_meshes
from ..files.imports import BLEND, READERS, Source, checked_file, import_objects, run_importer
from ..unused_data import removed_on_errors


@dataclass(frozen=True)
class BodyAndRig:
    """A body and the rig to fit into it.

    Attributes
    ----------
    body : bpy.types.Object
        A mesh.
    rig : bpy.types.Object
        An armature, or a mesh of edges.
    """

    body: bpy.types.Object
    rig: bpy.types.Object


def open_body_and_rig(body: Source, rig: Source) -> BodyAndRig:
    """Open the files of a body and a rig.

    The first .blend is opened unchanged, without running its scripts; objects of other files are added to it, or to an
    empty scene. Without a name, the only object of the required kind is used.

    Raises
    ------
    InputError
        The files or objects cannot be used.
    """
    for source in (body, rig):
        checked_file(source.path, source.names, (*READERS, BLEND))
    opened = next((source.path for source in (body, rig) if _is_blend(source)), None)
    if opened is None:
        open_empty()
    else:
        open_blend(opened)
    found_body = _found_body(body, opened)
    return BodyAndRig(found_body, _found_rig(rig, opened, found_body))


def _is_blend(source: Source) -> bool:
    return source.path.suffix.lower() == BLEND


def _is_open(source: Source, opened: Path | None) -> bool:
    return _is_blend(source) and opened is not None and source.path.resolve() == opened.resolve()


def _found_body(source: Source, opened: Path | None) -> bpy.types.Object:
    if not _is_open(source, opened):
        (obj,) = import_objects(source.path, source.names)
        return obj
    meshes = [obj for obj in bpy.context.scene.objects if obj.type == "MESH"]
    if source.object_name is not None:
        return _named(source, bpy.context.scene.objects)
    solid = [obj for obj in meshes if obj.data.polygons or obj.modifiers]
    if len(solid) != 1:
        raise several_meshes(source.path, len(solid), _names(solid))
    return solid[0]


def _found_rig(source: Source, opened: Path | None, body: bpy.types.Object) -> bpy.types.Object:
    if _is_open(source, opened):
        objects = list(bpy.context.scene.objects)
        return _named(source, objects) if source.object_name else _only_rig(source, objects)
    objects = _appended(source) if _is_blend(source) else _read(source)
    with removed_on_errors(objects):
        # A named object is imported alone, possibly under another name.
        rig = objects[0] if source.object_name else _only_rig(source, objects)
    kept = {rig, body}
    parent = rig.parent
    while parent is not None:
        kept.add(parent)
        if parent.name not in bpy.context.scene.objects:
            # Parents of the rig are only saved if they are in the scene.
            bpy.context.scene.collection.objects.link(parent)
        parent = parent.parent
    bpy.data.batch_remove([obj for obj in objects if obj not in kept])
    return rig


def _named(source: Source, objects: Iterable[bpy.types.Object]) -> bpy.types.Object:
    found = next((obj for obj in objects if obj.name == source.object_name), None)
    if found is None:
        raise InputError(
            "{file} has no object {name!r}; it contains {listed}.",
            file=source.path.name,
            name=source.object_name,
            listed=_names(objects),
        )
    return found


def _only_rig(source: Source, objects: Iterable[bpy.types.Object]) -> bpy.types.Object:
    """Return the only armature, else the only mesh of edges; raises InputError if there is not exactly one."""
    armatures = [obj for obj in objects if obj.type == "ARMATURE"]
    rigs = armatures or [obj for obj in objects if obj.type == "MESH" and obj.data.edges and not obj.data.polygons]
    if not rigs:
        raise InputError(
            "{file} contains no armature and no mesh of edges; name a file with a skeleton.", file=source.path.name
        )
    if len(rigs) > 1:
        raise InputError(
            "{file} contains {count} skeletons; name one as {file}:NAME, of {available}.",
            file=source.path.name,
            count=len(rigs),
            available=_names(rigs),
        )
    return rigs[0]


def _names(objects: Iterable[bpy.types.Object]) -> str:
    return ", ".join(sorted(obj.name for obj in objects)) or "-"


def _appended(source: Source) -> list[bpy.types.Object]:
    """Append the named object, or all objects, of a .blend to the scene."""
    objects = appended_objects(source.path, source.names)
    for obj in objects.values():
        bpy.context.scene.collection.objects.link(obj)
    return list(objects.values())


def _read(source: Source) -> list[bpy.types.Object]:
    """Import a file into the scene and return the new objects."""
    before = set(bpy.data.objects)
    run_importer(READERS[source.path.suffix.lower()], whole_path(source.path))
    return [obj for obj in bpy.data.objects if obj not in before]
