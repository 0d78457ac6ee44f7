# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write a mesh with shape keys, and the parts that follow it, in other formats.

glTF and FBX contain the keys as morph targets, with an animation of their weights and of the object, or the armature in
its current pose with its own animation. USD and Alembic contain the positions and velocities of the vertices in every
frame, and vertex animation textures positions and normals.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path

import bpy
import numpy as np

from ...disk_space import require_space
from ...drafts import new_draft, written_whole
from ...errors import InputError
from ...sentence import Sentence
from ..element_values import write_floats
from ..files.borrowed_names import borrowed_names
from ..files.mesh_sequences import mesh_sequences
from ..files.output_paths import checked_target
from ..files.scene_writing import write_alembic, write_draft, write_usd
from ..interrupts import kept_interrupts
from ..mesh_checks import require_not_edited
from ..morphs.disk.gltf_animation import write_gltf_animation
from ..morphs.looks.appearance import write_velocity
from ..objects import evaluated_mesh, take_own_materials
from ..visibility import is_in, shown_objects
from .attached_parts import attached_parts
from .keyed_copies import assign_plain_material, keyed_copies, posed_copies
from .moving_meshes import keyed_span, sampled_vertices
from .skinning import armatures
from .vertex_animation_files import write_moving_mesh

# Extensions of formats with morph targets, which move vertices before modifiers do.
_WITH_TARGETS = (".glb", ".fbx")

# Bytes per corner of a mesh with UV maps, colors and weights; per vertex that moves, for its position and its normal or
# velocity; per normal of a corner; per key and frame; and of the header.
_CORNER, _MOVED, _NORMAL, _KEYED, _FILE = 120, 24, 12, 16, 1 << 20

# Writes a mesh with shape keys, followed by its parts, in the frames of a range; returns the files.
_Writer = Callable[[Sequence[bpy.types.Object], range, Path], list[Path]]
_Copies = Callable[[Sequence[bpy.types.Object], range], AbstractContextManager[object]]


def export_shape_keys(obj: bpy.types.Object, path: Path) -> list[Path]:
    """Write an object whose shape keys are animated, with the visible parts that are attached to it.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh with shape keys, and animation on their drivers, such as sliders.
    path : Path
        Its extension, a key of `KEY_FORMATS`, sets the format.

    Returns
    -------
    list of Path
        The files, absolute. Existing ones have been replaced.

    Raises
    ------
    InputError
        An unknown extension, a missing folder, or an object without shape keys or animation, or in Edit Mode.
    ConvwassError
        Blender could not write a file.
    """
    target = checked_key_target(path)
    if obj.type != "MESH" or obj.data.shape_keys is None:
        raise InputError("{name} has no shape keys.", name=obj.name)
    written = [obj, *_shown_parts(obj)]
    for part in written:
        require_not_edited(part)
    with shown_objects([obj], bpy.context.scene):
        return KEY_FORMATS[target.suffix.lower()](written, keyed_span(obj), target)


def left_out_notices(obj: bpy.types.Object, file: Path) -> list[Sentence]:
    """Return what a file that is written by `export_shape_keys` lacks: visible modifiers, or attached parts."""
    suffix, parts = file.suffix.lower(), _shown_parts(obj)
    if suffix in _WITH_TARGETS:
        return [notice for own in (obj, *parts) for notice in _modifier_notices(own)]
    if suffix == ".json" and parts:
        values = {"name": obj.name, "parts": ", ".join(part.name for part in parts)}
        return [Sentence("The file lacks the parts of {name} ({parts}); the other formats contain them", values)]
    return []


def _modifier_notices(obj: bpy.types.Object) -> list[Sentence]:
    """Return a notice if a file with morph targets lacks visible modifiers of an object."""
    kept = armatures(obj)[:1]
    left = [own.name for own in obj.modifiers if own.show_viewport and own not in kept]
    if not left:
        return []
    values = {"name": obj.name, "modifiers": ", ".join(left)}
    return [Sentence("The file lacks the modifiers of {name} ({modifiers}); USD and Alembic contain them", values)]


def _shown_parts(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """Return the parts that are attached to an object and visible in the current view layer."""
    layer = bpy.context.view_layer
    return [part for part in attached_parts([obj]) if is_in(layer, part) and part.visible_get(view_layer=layer)]


def checked_key_target(path: Path) -> Path:
    """Return the absolute path of a file to be written; raises InputError as `export_shape_keys`."""
    target = checked_target(path)
    if target.suffix.lower() not in KEY_FORMATS:
        raise InputError(
            "{name}: a mesh with shape keys can be written to files that end in {endings}.",
            name=target.name,
            endings=", ".join(KEY_FORMATS),
        )
    return target


def _target_bytes(objects: Sequence[bpy.types.Object], frames: range) -> int:
    """Return a generous estimate of the size of a file with the shape keys of some objects."""
    sizes = [(len(obj.data.loops), len(obj.data.shape_keys.key_blocks)) for obj in objects]
    return _FILE + sum(corners * (_CORNER + _MOVED * keys) + _KEYED * keys * len(frames) for corners, keys in sizes)


def _point_bytes(objects: Sequence[bpy.types.Object], frames: range) -> int:
    """Return a generous estimate of the size of a file with the vertices of some objects in every frame."""
    meshes = [obj.data for obj in objects]
    moving = sum(_MOVED * len(mesh.vertices) + _NORMAL * len(mesh.loops) for mesh in meshes)
    return _FILE + moving * len(frames) + sum(_CORNER * len(mesh.loops) for mesh in meshes)


def _write_targets(write: Callable[[str], set[str]], copies: _Copies) -> _Writer:
    """Return a function that writes the keys of copies with one of Blender's exporters."""

    def written(objects: Sequence[bpy.types.Object], frames: range, target: Path) -> list[Path]:
        require_space(target.parent, _target_bytes(objects, frames))
        with copies(objects, frames), written_whole(target) as draft:
            write_draft(write, draft, target)
        return [target]

    return written


def _write_points(write: Callable[[str], set[str]]) -> _Writer:
    """Return a function that writes the vertices and velocities of every frame with one of Blender's exporters."""

    def written(objects: Sequence[bpy.types.Object], frames: range, target: Path) -> list[Path]:
        require_space(target.parent, _point_bytes(objects, frames))
        shown: dict[str, list[tuple[bpy.types.Object]]] = {}
        try:
            for obj in objects:
                shown[obj.name] = [(one,) for one in _frame_objects(obj, frames)]
            with mesh_sequences(shown, frames[0]) as made, _named_draft(target) as draft:
                pairs = list(zip(made, objects, strict=True))
                with borrowed_names([*pairs, *((own.data, obj.data) for own, obj in pairs)]):
                    write_draft(write, draft, target)
        finally:
            made = [one for own in shown.values() for (one,) in own]
            bpy.data.batch_remove([*made, *(one.data for one in made)])
        return [target]

    return written


@contextmanager
def _named_draft(target: Path) -> Iterator[Path]:
    """Provide a path in a folder of its own, whose file becomes the target: a .usdz contains a file of the same name.

    Raises
    ------
    ConvwassError
        The file could not be written.
    """
    with written_whole(target) as draft:
        folder = new_draft(target, "")
        try:
            folder.mkdir()
            yield folder / target.name
            (folder / target.name).replace(draft)
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def _frame_objects(obj: bpy.types.Object, frames: range) -> list[bpy.types.Object]:
    """Create an object for every frame, in world space, with the velocities of its vertices."""
    render = bpy.context.scene.render
    moving, fps = sampled_vertices(obj, frames), render.fps / render.fps_base
    velocities = np.gradient(moving.points, axis=0) * fps if len(moving.points) > 1 else np.zeros_like(moving.points)
    made = []
    for points, velocity in zip(moving.points, velocities, strict=True):
        mesh = _without_keys(obj)
        write_floats(mesh.vertices, "co", points)
        write_velocity(mesh, velocity)
        mesh.update()
        made.append(bpy.data.objects.new(mesh.name, mesh))
    return made


def _write_textures(objects: Sequence[bpy.types.Object], frames: range, target: Path) -> list[Path]:
    """Write vertex animation textures of the first object."""
    obj, render = objects[0], bpy.context.scene.render
    moving = sampled_vertices(obj, frames)
    mesh = _without_keys(obj)
    plain = assign_plain_material(mesh, obj)
    try:
        return write_moving_mesh(mesh, obj.name, moving, target, render.fps / render.fps_base)
    finally:
        bpy.data.meshes.remove(mesh)
        bpy.data.batch_remove([own for own, _ in plain])


def _without_keys(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Return a copy of an object's mesh, modifiers applied, without shape keys."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = evaluated_mesh(obj.evaluated_get(depsgraph), depsgraph)
    take_own_materials(mesh, obj)
    return mesh


def _gltf(file: str) -> set[str]:
    return write_gltf_animation(
        file,
        export_morph=True,
        export_morph_normal=True,
        export_morph_tangent=False,
        export_skins=True,
        export_rest_position_armature=False,
    )


def _fbx(file: str) -> set[str]:
    with kept_interrupts():
        return bpy.ops.export_scene.fbx(
            filepath=file,
            object_types={"MESH", "ARMATURE", "EMPTY"},
            add_leaf_bones=False,
            bake_anim_use_all_actions=False,
            bake_anim_use_nla_strips=False,
            bake_anim_simplify_factor=0.0,
        )


KEY_FORMATS: dict[str, _Writer] = {
    ".glb": _write_targets(_gltf, keyed_copies),
    ".fbx": _write_targets(_fbx, posed_copies),
    ".usdc": _write_points(write_usd),
    ".usd": _write_points(write_usd),
    ".usda": _write_points(write_usd),
    ".usdz": _write_points(write_usd),
    ".abc": _write_points(partial(write_alembic, colors=False)),
    ".json": _write_textures,
}
"""Functions that write a mesh with shape keys and its parts, by file extension."""
