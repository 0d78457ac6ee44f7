# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Export a morph for other programs."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import bpy
import numpy as np

from ....applications.whole_paths import whole_path
from ....disk_space import require_space
from ....drafts import new_draft, replace_together
from ....errors import ConvwassError, InputError
from ...element_values import element_values, write_floats
from ...files.mesh_sequences import mesh_sequences
from ...files.numbered_files import numbered_paths
from ...files.output_paths import checked_target, file_stem
from ...files.scene_writing import write_alembic, write_draft, write_still_gltf, write_usd
from ...files.scratch_scene import scratch_animation, scratch_scene
from ...objects import world_copy
from ...one_mesh.moving_meshes import triangles_of_frames
from ...one_mesh.vertex_animation_files import write_changing_mesh
from ...operator_errors import reason
from ...scene_colors import set_colors
from ..looks.appearance import VELOCITY, seen_colors, write_velocity
from ..looks.materials import plain_copy, shows_color_attribute, shows_object_color
from ..stored import shown_frames, some_frame_objects
from .gltf_animation import scaled_stand_ins, write_gltf_animation
from .still_frames import StillFrames, still_frames

# Exported bytes per vertex, corner and face with colors, normals, UV maps and velocities, and for the file header.
_VERTEX, _CORNER, _FACE, _FILE = 48, 40, 8, 1 << 20

_UV_MAP = "UVMap"

COLORS = "displayColor"
"""Name of the colors in animated files, as in USD."""


@dataclass(frozen=True)
class _Format:
    suffixes: tuple[str, ...]
    """Accepted extensions; the first one is the default."""
    animated: bool
    """Whether one file holds the whole animation, rather than one file per frame."""
    write: Callable[[str], set[str]] | None
    """Writes the current scene."""
    write_colors: Callable[[bpy.types.Mesh, np.ndarray], None] | None = None
    """Writes one color per vertex to a mesh, as the format requires; for animated formats."""
    write_steps: Callable[[str], set[str]] | None = None
    """Writes the current scene when its meshes are shown one after another; for formats that store paths this way."""
    write_frames: Callable[[Sequence[bpy.types.Object], Path, float], list[Path]] | None = None
    """Writes frame objects at some frames per second to a target and to files next to it, in place of `write`."""


def export_frames(collection: bpy.types.Collection, path: Path, file_format: str) -> list[Path]:
    """Export the frames of a morph.

    OBJ, PLY and STL cannot swap meshes over time, so they get one file per frame, numbered from 0001 in the order of
    the frames, with materials; materials that use the object's color get that color. A path is exported to glTF as a
    single .glb, in which every frame is a node that an animation scales to 1 while it is shown and to 0 otherwise; a
    sheet is exported to glTF as one file per blend. USD and Alembic get a single file with one mesh of changing
    topology; its displayColor is the color of the frames, with velocities. If the path begins before frame 0, they
    begin at 0. A sheet is exported to them as a still.
    Vertex animation textures are a .json file, a mesh and textures, which contain the triangles of all frames, padded
    to the same number; see :mod:`.one_mesh.vertex_animation_files`.

    Parameters
    ----------
    collection : bpy.types.Collection
        A baked morph.
    path : Path
        A file, whose extension may be left out, or an existing folder, in which files are named after the collection.
    file_format : str
        A key of `FORMATS`.

    Returns
    -------
    list of Path
        Absolute paths of the files. Existing files are replaced once all are complete.

    Raises
    ------
    InputError
        The format is unknown, the folder does not exist, the collection has no frames, or the place of a frame is not
        finite.
    ConvwassError
        Blender could not write a file.
    """
    if file_format not in FORMATS:
        raise InputError(
            "There is no export format {file_format!r}; choose one of {formats}.",
            file_format=file_format,
            formats=", ".join(FORMATS),
        )
    chosen = FORMATS[file_format]
    target = checked_target(_with_suffix(path, chosen, collection.name))
    frames = some_frame_objects(collection)
    span = shown_frames(collection)
    with still_frames(frames, span) as still:
        if chosen.write_frames is not None:
            return chosen.write_frames(still.first, target, _frames_per_second(frames, span))
        if chosen.animated or (chosen.write_steps is not None and span):
            require_space(target.parent, _exported_bytes(still.all))
            with _draft_folder(target) as folder:
                if chosen.animated:
                    _export_animation(still, span, folder / target.name, chosen)
                else:
                    _export_steps(still, folder / target.name, chosen)
            return [target]
        files = numbered_paths(target.parent, f"{target.stem}_", target.suffix, range(1, len(frames) + 1))
        require_space(target.parent, sum(_exported_bytes([obj]) for obj in still.first))
        with _draft_folder(target) as folder:
            for obj, file in zip(still.first, files, strict=True):
                _export_still(obj, folder / file.name, chosen)
        return files


def format_of(path: Path) -> str:
    """Return the format of a file by its extension; raises InputError if there is none."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError("{name}: the extension must be one of {endings}.", name=path.name, endings=", ".join(SUFFIXES))
    return SUFFIXES[path.suffix.lower()]


def _frames_per_second(frames: Sequence[bpy.types.Object], span: range) -> float:
    """Return how many frame objects are shown per second; each is assumed to be shown equally long."""
    render = bpy.context.scene.render
    return render.fps / render.fps_base * (len(frames) / len(span) if span else 1.0)


def _with_suffix(path: Path, chosen: _Format, name: str) -> Path:
    """Return the path with an extension of the format."""
    target = whole_path(path)
    if target.is_dir():
        target /= file_stem(name)
    if target.suffix.lower() in chosen.suffixes:
        return target
    # Other dots belong to the name: "walk.v2" becomes "walk.v2.obj".
    stem = target.stem if target.suffix.lower() in (".blend", *SUFFIXES) else target.name
    return target.with_name(stem + chosen.suffixes[0])


def _exported_bytes(objects: Sequence[bpy.types.Object]) -> int:
    """Return a generous estimate of the size of a file with the meshes of some objects."""
    meshes = [obj.data for obj in objects if obj.type == "MESH"]
    return _FILE + sum(
        _VERTEX * len(own.vertices) + _CORNER * len(own.loops) + _FACE * len(own.polygons) for own in meshes
    )


def _export_still(obj: bpy.types.Object, file: Path, chosen: _Format) -> None:
    """Export one frame object, whether or not it is visible."""
    with scratch_scene() as scene:
        # A copy, since the frame object itself is hidden in all frames but one.
        still = world_copy(obj, file.stem)
        try:
            scene.collection.objects.link(still)
            with _plain_materials([still]):
                _write(file, chosen)
        finally:
            bpy.data.batch_remove([still, still.data])


def _export_animation(still: StillFrames, span: range, file: Path, chosen: _Format) -> None:
    """Export the frame objects as one mesh over scene frames; without animation, in their current state."""
    with _colored_copies(still.all, chosen.write_colors) as copies:
        groups = [tuple(copies[obj] for obj in group) for group in still.shown]
        first = span[0] if span else bpy.context.scene.frame_current
        with mesh_sequences({bpy.path.clean_name(file.stem): groups}, first):
            _write(file, chosen)


def _export_steps(still: StillFrames, file: Path, chosen: _Format) -> None:
    """Write the frame objects of a path as nodes that take turns."""
    with (
        scratch_animation(0, len(still.shown)) as scene,
        scaled_stand_ins(still.all, still.shown, file.stem) as copies,
        _plain_materials(copies),
    ):
        for copy in copies:
            scene.collection.objects.link(copy)
        scene.frame_set(0)
        _write(file, replace(chosen, write=chosen.write_steps))


@contextmanager
def _colored_copies(
    objects: list[bpy.types.Object], write_colors: Callable[[bpy.types.Mesh, np.ndarray], None]
) -> Iterator[dict[bpy.types.Object, bpy.types.Object]]:
    """Provide copies with vertex colors, since a file cannot change the materials of a mesh over time."""
    copies = {}
    try:
        for obj in objects:
            copies[obj] = world_copy(obj, obj.name)
            mesh = copies[obj].data
            colors = seen_colors(mesh, obj.color)
            mesh.materials.clear()
            # Removed by name: before Blender 5, removing an attribute invalidates references to the others.
            for name in [attribute.name for attribute in mesh.color_attributes]:
                mesh.color_attributes.remove(mesh.color_attributes[name])
            write_colors(mesh, colors)
        meshes = [copy.data for copy in copies.values()]
        _still_where_none_moves(meshes)
        _with_one_uv_map(meshes)
        yield copies
    finally:
        bpy.data.batch_remove([*copies.values(), *(copy.data for copy in copies.values())])


def _still_where_none_moves(meshes: list[bpy.types.Mesh]) -> None:
    """If some meshes have a velocity, give the others a velocity of zero: files need it in all frames or none."""
    moving = [mesh for mesh in meshes if VELOCITY in mesh.attributes]
    for mesh in meshes if moving else ():
        if mesh not in moving:
            write_velocity(mesh, np.zeros((len(mesh.vertices), 3)))


def _with_one_uv_map(meshes: list[bpy.types.Mesh]) -> None:
    """If some meshes have UV maps, leave each its active one under the same name: files need it in all frames."""
    if not any(mesh.uv_layers for mesh in meshes):
        return
    for mesh in meshes:
        active = mesh.uv_layers.active
        kept = np.zeros(2 * len(mesh.loops), np.float32)
        if active is not None:
            active.uv.foreach_get("vector", kept)
        for name in [layer.name for layer in mesh.uv_layers]:
            mesh.uv_layers.remove(mesh.uv_layers[name])
        mesh.uv_layers.new(name=_UV_MAP, do_init=False).uv.foreach_set("vector", kept)


@contextmanager
def _draft_folder(target: Path) -> Iterator[Path]:
    """Provide a folder whose files are moved next to a target together at the end; on an error, none is.

    They are written under their final names, since an OBJ contains the name of its material file.
    """
    folder = new_draft(target, "")
    try:
        folder.mkdir()
        yield folder
        for materials in folder.glob("*.mtl"):
            _name_textures(materials, target.parent)
        replace_together({target.with_name(draft.name): draft for draft in folder.iterdir()})
    except OSError as error:
        raise ConvwassError("{file} could not be written: {reason}", file=str(target), reason=reason(error)) from error
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _write(draft: Path, chosen: _Format) -> None:
    """Export the current scene to a file in a draft folder; messages name the final file."""
    write_draft(chosen.write, draft, draft.parents[1] / draft.name)


def _name_textures(materials: Path, folder: Path) -> None:
    """Make texture paths below a folder relative to it, as Blender does when it writes there."""
    near = f" {folder.as_posix()}/".encode()
    materials.write_bytes(materials.read_bytes().replace(near, b" "))


@contextmanager
def _plain_materials(objects: list[bpy.types.Object]) -> Iterator[None]:
    """Temporarily replace shared materials that read the object's color by materials of that color."""
    slots = [
        slot
        for obj in objects
        for slot in obj.material_slots
        if shows_object_color(slot.material) or shows_color_attribute(slot.material)
    ]
    copies = [plain_copy(slot.material, tuple(slot.id_data.color)) for slot in slots]
    for slot, copy in zip(slots, copies, strict=True):
        slot.link = "OBJECT"
        slot.material = copy
    try:
        yield
    finally:
        for slot in slots:
            slot.material = None
            slot.link = "DATA"
        bpy.data.batch_remove(copies)


def _write_point_colors(mesh: bpy.types.Mesh, colors: np.ndarray) -> None:
    attribute = mesh.color_attributes.new(COLORS, "FLOAT_COLOR", "POINT")
    write_floats(attribute.data, "color", colors)


def _write_corner_colors(mesh: bpy.types.Mesh, colors: np.ndarray) -> None:
    """Write colors per corner, the only kind that Blender's Alembic exporter supports."""
    vertices = element_values(mesh.loops, "vertex_index", kind=np.int32)
    attribute = mesh.color_attributes.new(COLORS, "BYTE_COLOR", "CORNER")
    set_colors(attribute, colors.reshape(-1, 4)[vertices])


def _write_textures(frames: Sequence[bpy.types.Object], target: Path, fps: float) -> list[Path]:
    return write_changing_mesh(triangles_of_frames(frames), target, fps)


FORMATS: dict[str, _Format] = {
    "obj": _Format((".obj",), animated=False, write=lambda file: bpy.ops.wm.obj_export(filepath=file)),
    "ply": _Format((".ply",), animated=False, write=lambda file: bpy.ops.wm.ply_export(filepath=file)),
    "stl": _Format((".stl",), animated=False, write=lambda file: bpy.ops.wm.stl_export(filepath=file)),
    "gltf": _Format((".glb",), animated=False, write=write_still_gltf, write_steps=write_gltf_animation),
    "usd": _Format(
        (".usdc", ".usd", ".usda", ".usdz"), animated=True, write=write_usd, write_colors=_write_point_colors
    ),
    "vat": _Format((".json",), animated=False, write=None, write_frames=_write_textures),
    "alembic": _Format(
        (".abc",), animated=True, write=partial(write_alembic, colors=True), write_colors=_write_corner_colors
    ),
}
"""The formats of `export_frames`."""

SUFFIXES = {suffix: name for name, chosen in FORMATS.items() for suffix in chosen.suffixes}
"""The format of every file extension."""
