# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Import files as one mesh object per shape."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...applications.whole_paths import whole_path
from ...errors import InputError
from ..flat.flat_kinds import is_drawn_flat
from ..interrupts import kept_interrupts
from ..joined_shapes import joined_shape
from ..mesh_checks import CONVERTIBLE
from ..objects import frozen_copy, stand
from ..operator_errors import reason
from ..shape_sources import shape_source
from .blend_files import appended_instances, appended_objects, listed_names, several_meshes
from .scratch_scene import scratch_scene

BLEND = ".blend"

READERS: dict[str, Callable[[str], set[str]]] = {
    ".obj": lambda file: bpy.ops.wm.obj_import(filepath=file),
    ".ply": lambda file: bpy.ops.wm.ply_import(filepath=file),
    ".stl": lambda file: bpy.ops.wm.stl_import(filepath=file),
    # Without this option, the importer adds a sphere for drawing bones.
    ".gltf": lambda file: bpy.ops.import_scene.gltf(filepath=file, disable_bone_shape=True),
    ".glb": lambda file: bpy.ops.import_scene.gltf(filepath=file, disable_bone_shape=True),
    ".fbx": lambda file: bpy.ops.wm.fbx_import(filepath=file),
    # Instances would be imported as Empties without meshes.
    ".usd": lambda file: bpy.ops.wm.usd_import(filepath=file, support_scene_instancing=False),
    ".usda": lambda file: bpy.ops.wm.usd_import(filepath=file, support_scene_instancing=False),
    ".usdc": lambda file: bpy.ops.wm.usd_import(filepath=file, support_scene_instancing=False),
    ".usdz": lambda file: bpy.ops.wm.usd_import(filepath=file, support_scene_instancing=False),
    ".abc": lambda file: bpy.ops.wm.alembic_import(filepath=file),
}
"""Blender's importer for each extension, besides .blend."""


@dataclass(frozen=True)
class Source:
    """A shape named on the command line.

    Attributes
    ----------
    path : Path
        The file.
    object_name : str or None
        Name of an object in a .blend.
    """

    path: Path
    object_name: str | None

    @property
    def names(self) -> list[str] | None:
        """The names to import: that of the object, or None for all."""
        return [self.object_name] if self.object_name else None


@dataclass(frozen=True)
class _Part:
    """The objects of one shape."""

    name: str
    objects: list[bpy.types.Object]


def parse_source(text: str) -> Source:
    """Split ``file.blend:Object``; any other text is a path, including drive letters and colons.

    Raises
    ------
    InputError
        There is no name after the colon.
    """
    if os.path.isfile(text):
        return Source(Path(text), None)
    # Paths and object names may both contain ".blend:"; use the shortest existing path.
    splits = [(text[: found.end()], text[found.end() + 1 :]) for found in re.finditer(r"(?i)\.blend(?=:)", text)]
    if not splits:
        return Source(Path(text), None)
    path, name = next((split for split in splits if os.path.isfile(split[0])), splits[0])
    if not name:
        raise InputError("{text}: name an object after the colon, or leave out the colon.", text=text)
    return Source(Path(path), name)


def import_objects(path: Path, names: list[str] | None) -> list[bpy.types.Object]:
    """Import shapes from a file into the current scene.

    Parameters
    ----------
    path : Path
        OBJ, PLY, STL, glTF, FBX, USD, Alembic or .blend.
    names : list of str or None
        Objects or collections of a .blend, each of which becomes one shape. None joins all meshes of the file to a
        single shape named after the file; in a .blend, it selects the only mesh.

    Returns
    -------
    list of bpy.types.Object
        New mesh objects at the top level of the scene, with modifiers, parents and transforms applied. Only their
        materials are imported with them.

    Raises
    ------
    InputError
        The file is missing, a folder, a pipe, unreadable, damaged, of an unknown format, or has no mesh or no object of
        that name; the scene is not changed then.
    """
    file = checked_file(path, names, (*READERS, BLEND))
    with only_kept_data() as kept, scratch_scene() as scene:
        parts = _blend_parts(file, names) if file.suffix.lower() == BLEND else _file_parts(file, scene)
        kept.extend(_joined(part.objects, scene) for part in parts)
    for part, obj in zip(parts, kept, strict=True):
        # The name is only free again after the other imported data was removed.
        obj.name = obj.data.name = part.name
        bpy.context.scene.collection.objects.link(obj)
    return kept


def live_shape(text: str) -> list[bpy.types.Object]:
    """Append an object or a collection of a .blend file to the current scene with its animation.

    Parameters
    ----------
    text : str
        ``file.blend:NAME``.

    Raises
    ------
    InputError
        Anything else, or the file cannot be used.
    """
    source = parse_source(text)
    if source.path.suffix.lower() != BLEND or source.object_name is None:
        raise InputError(
            "{text}: only objects and collections of .blend files can be followed, given as file.blend:NAME.", text=text
        )
    names = [source.object_name]
    file = checked_file(source.path, names, (BLEND,))
    found = appended_instances(file, names) or appended_objects(file, names)
    (obj,) = found.values()
    bpy.context.scene.collection.objects.link(obj)
    return [obj]


def checked_file(path: Path, names: list[str] | None, endings: Sequence[str]) -> Path:
    """Return the absolute path of a file; raises InputError if it cannot be imported."""
    file = whole_path(path)
    suffix = file.suffix.lower()
    if file.is_dir():
        raise InputError("{file} is a folder; name a file in it.", file=str(file))
    if not file.exists():
        raise InputError("{file} does not exist; check the spelling and the folder.", file=str(file))
    if suffix not in endings:
        raise InputError(
            "{file} is of an unknown format; supported formats: {formats}.",
            file=file.name,
            formats=" ".join(endings),
        )
    if names and suffix != BLEND:
        raise InputError(
            "{file}: only {suffix} files support object names; leave out the name.", file=file.name, suffix=BLEND
        )
    if not file.is_file():
        # Blender's importers would wait for a pipe, and read it only once.
        raise InputError("{file} is a pipe or a device; save the shape as a file.", file=str(file))
    try:
        with file.open("rb") as stream:
            empty = not stream.read(1)
    except OSError as error:
        raise InputError("{file} cannot be opened: {reason}.", file=str(file), reason=error.strerror) from error
    if empty:
        raise InputError("{file} is an empty file; export the shape again.", file=file.name)
    return file


def run_importer(importer: Callable[[str], set[str]], file: Path) -> None:
    """Run one of Blender's importers in the current scene.

    Raises
    ------
    InputError
        The importer failed.
    """
    try:
        with kept_interrupts():
            finished = "FINISHED" in importer(str(file))
    except RuntimeError as error:
        raise InputError(
            "{file} could not be read; is it damaged? Blender says: {reason}", file=file.name, reason=reason(error)
        ) from error
    if not finished:
        raise InputError("{file} could not be read; it is damaged, or its extension is wrong.", file=file.name)


def _file_parts(file: Path, scene: bpy.types.Scene) -> list[_Part]:
    """Import a file and return its meshes as the parts of one shape."""
    run_importer(READERS[file.suffix.lower()], file)
    # An invalid STL is imported as an empty mesh.
    objects = [obj for obj in scene.collection.all_objects if obj.type != "MESH" or obj.data.vertices or obj.modifiers]
    meshes = [obj for obj in objects if obj.type == "MESH"]
    if not meshes:
        kinds = _kinds(file, objects)
        raise InputError(
            "{file} contains no mesh, only {kinds}; export the shape as a mesh.", file=file.name, kinds=kinds
        )
    return [_Part(file.stem, meshes)]


def _blend_parts(file: Path, names: list[str] | None) -> list[_Part]:
    """Append objects and collections of a .blend, each as one shape."""
    shown = appended_instances(file, names or ())
    objects = appended_objects(file, names and [name for name in names if name not in shown])
    parts = {name: _Part(name, [obj]) for name, obj in {**objects, **shown}.items()}
    if names:
        return [parts[name] for name in names]
    meshes = [part for part in parts.values() if part.objects[0].type == "MESH"]
    meshes = meshes or [part for part in parts.values() if is_drawn_flat(part.objects[0])]
    if not meshes:
        raise _no_mesh(file, [part.objects[0] for part in parts.values()])
    if len(meshes) > 1:
        raise several_meshes(file, len(meshes), listed_names(part.name for part in meshes))
    return meshes


def _joined(objects: list[bpy.types.Object], scene: bpy.types.Scene) -> bpy.types.Object:
    """Join several objects in world space; a single flat object keeps its type."""
    if len(objects) == 1 and is_drawn_flat(objects[0]):
        return _standing(objects[0], scene)
    for obj in objects:
        if obj not in set(scene.objects):
            scene.collection.objects.link(obj)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    solid = [obj for obj in objects if obj.type != "MESH" or obj.data.polygons or obj.modifiers] or objects[:1]
    copies = [bpy.data.objects.new(obj.name, _solid_copy(obj, depsgraph)) for obj in solid]
    if len(copies) > 1:
        for copy in copies:
            scene.collection.objects.link(copy)
        with bpy.context.temp_override(active_object=copies[0], selected_editable_objects=copies):
            bpy.ops.object.join()
    return copies[0]


def _solid_copy(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bpy.types.Mesh:
    """Make a mesh of an object with its instances, or of the collection that it shows."""
    with joined_shape(shape_source(obj), depsgraph) as joined:
        return frozen_copy(joined, depsgraph)


def _standing(obj: bpy.types.Object, scene: bpy.types.Scene) -> bpy.types.Object:
    """Remove parent, constraints and animation of an object, keeping its position."""
    if obj not in set(scene.objects):
        scene.collection.objects.link(obj)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    place = obj.evaluated_get(depsgraph).matrix_world.copy()
    obj.constraints.clear()
    obj.animation_data_clear()
    stand(obj, place)
    return obj


@contextmanager
def only_kept_data() -> Iterator[list[bpy.types.Object]]:
    """Remove all new data-blocks, except the objects on the list and their dependencies."""
    before = {block.session_uid for block in bpy.data.user_map()}
    kept: list[bpy.types.Object] = []
    try:
        yield kept
    except BaseException:
        kept.clear()
        raise
    finally:
        needed = _with_dependencies(kept)
        new = {block for block in bpy.data.user_map() if block.session_uid not in before}
        bpy.data.batch_remove(new - needed)


def _with_dependencies(objects: list[bpy.types.Object]) -> set[bpy.types.ID]:
    """Return objects with their direct and indirect dependencies."""
    users = bpy.data.user_map()
    needed = set(objects)
    while added := {block for block in users.keys() - needed if users[block] & needed}:
        needed |= added
    return needed


def _no_mesh(file: Path, objects: list[bpy.types.Object]) -> InputError:
    """Return the error for a .blend without a mesh; raises another one if it is empty."""
    kinds = _kinds(file, objects)
    if any(obj.type in CONVERTIBLE for obj in objects):
        return InputError(
            "{file} contains no mesh, only {kinds}; convert them: Object > Convert > Mesh.", file=file.name, kinds=kinds
        )
    return InputError("{file} contains no mesh, only {kinds}; choose a file with one.", file=file.name, kinds=kinds)


def _kinds(file: Path, objects: list[bpy.types.Object]) -> str:
    """Describe the objects of a file; raises InputError if there are none."""
    counts = Counter(obj.type.lower().replace("_", " ") for obj in objects)
    if not counts:
        raise InputError(
            "{file} contains no mesh, and nothing else that Blender can read; export the shape as a mesh.",
            file=file.name,
        )
    return ", ".join(f"{kind} ({count})" for kind, count in sorted(counts.items()))
