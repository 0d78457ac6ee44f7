# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write a mesh with shape keys in other formats.

glTF and FBX contain the keys as morph targets, with an animation of their weights and of the object, or the armature in
its current pose with its own animation. USD and Alembic contain the positions and velocities of the vertices in every
frame, and vertex animation textures positions and normals.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ...drafts import written_whole
from ...errors import InputError
from ...sentence import Sentence
from ..animation_time import returning, show_time
from ..borrowed_names import borrowed_names
from ..files import checked_target
from ..keyframes import curves_of, interpolate
from ..mesh_checks import require_not_edited
from ..morphs.appearance import write_velocity
from ..morphs.gltf_animation import write_gltf_animation
from ..morphs.materials import plain_copy, shows_object_color
from ..objects import is_sheared, take_own_materials, transform_mesh, unsheared_factors
from ..scene_writing import require_written, write_alembic, write_usd
from ..scratch_scene import scratch_animation
from ..sequence import mesh_sequence
from ..visibility import shown_objects
from .limiting_groups import anchor_vertices, apply_key_groups
from .moving_meshes import MovingVertices, keyed_span, sampled_vertices
from .skinning import armatures, influences
from .vertex_animation_files import write_moving_mesh

# Extensions of formats with morph targets, which move vertices before modifiers do.
_WITH_TARGETS = (".glb", ".fbx")


def export_shape_keys(obj: bpy.types.Object, path: Path) -> list[Path]:
    """Write an object whose shape keys are animated.

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
    require_not_edited(obj)
    with shown_objects([obj], bpy.context.scene):
        return KEY_FORMATS[target.suffix.lower()](obj, keyed_span(obj), target)


def left_out_notices(obj: bpy.types.Object, file: Path) -> list[Sentence]:
    """Return a notice if a file that is written by `export_shape_keys` lacks visible modifiers of the object."""
    kept = armatures(obj)[:1]
    left = [own.name for own in obj.modifiers if own.show_viewport and own not in kept]
    if file.suffix.lower() not in _WITH_TARGETS or not left:
        return []
    values = {"name": obj.name, "modifiers": ", ".join(left)}
    return [Sentence("The file lacks the modifiers of {name} ({modifiers}); USD and Alembic contain them", values)]


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


@dataclass(frozen=True)
class _Sampled:
    """Values of all shape keys but the first in every frame, (f, k), their names, and where the object is."""

    names: list[str]
    values: NDArray[np.float64]
    places: list[Matrix]


def _sampled_keys(obj: bpy.types.Object, frames: range) -> _Sampled:
    """Read the shape keys with drivers and animation; restores the current frame of the scene."""
    scene, found, places = bpy.context.scene, [], []
    with returning(scene):
        for frame in frames:
            show_time(scene, frame)
            evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
            found.append([key.value for key in list(evaluated.data.shape_keys.key_blocks)[1:]])
            places.append(evaluated.matrix_world.copy())
    names = [key.name for key in list(obj.data.shape_keys.key_blocks)[1:]]
    return _Sampled(names, np.array(found, dtype=np.float64), places)


@contextmanager
def _keyed_copy(obj: bpy.types.Object, frames: range) -> Iterator[None]:
    """Link a copy of an object to a temporary scene, with its shape keys keyed in every frame from 0 on.

    Of its modifiers it keeps an armature, of which a copy is linked too.
    """
    sampled = _sampled_keys(obj, frames)
    with scratch_animation(0, len(frames) - 1) as scene:
        mesh = obj.data.copy()
        take_own_materials(mesh, obj)
        plain = _assign_plain_material(mesh, obj)
        copy = bpy.data.objects.new(obj.name, mesh)
        scene.collection.objects.link(copy)
        apply_key_groups(copy)
        rig = _rigged(copy, obj, scene)
        keys = mesh.shape_keys
        keys.animation_data_clear()
        keys.name = f"{obj.name} Keys"
        made = []
        try:
            for name, values in zip(sampled.names, sampled.values.T, strict=True):
                for number, value in enumerate(values):
                    keys.key_blocks[name].value = value
                    keys.key_blocks[name].keyframe_insert("value", frame=number)
            made.append(keys.animation_data.action)
            if rig is None:
                _key_places(copy, sampled.places, made[0])
            for block in (keys, copy):
                interpolate(curves_of(block))
            made[0].name = keys.name
            scene.frame_set(0)
            with borrowed_names([(copy, obj), (mesh, obj.data), *plain, *_rig_names(rig, obj)]):
                yield
        finally:
            bpy.data.objects.remove(copy)
            bpy.data.meshes.remove(mesh)
            bpy.data.batch_remove([*made, *(own for own, _ in plain), *_parts_of(rig)])


def _key_places(copy: bpy.types.Object, places: Sequence[Matrix], action: bpy.types.Action) -> None:
    """Place an object in every frame from 0 on, with keys in an action if it moves; its mesh takes a shear."""
    if any(map(is_sheared, places)):
        transform_mesh(copy.data, places[0], shape_keys=True)
        # Free of shear if only its parent moves.
        places = [place @ places[0].inverted_safe() for place in places]
    copy.matrix_world = places[0]
    if np.allclose(places, places[0], atol=1e-6):
        return
    data = copy.animation_data_create()
    data.action, data.action_slot = action, action.slots.new("OBJECT", copy.name)
    copy.rotation_mode = "QUATERNION"
    for number, place in enumerate(places):
        before = copy.rotation_quaternion.copy()
        copy.matrix_world = place
        copy.rotation_quaternion.make_compatible(before)
        for path in ("location", "rotation_quaternion", "scale"):
            copy.keyframe_insert(path, frame=number)


def _rigged(copy: bpy.types.Object, obj: bpy.types.Object, scene: bpy.types.Scene) -> bpy.types.Object | None:
    """Link a copy of an object's armature to a scene, and let it deform a copy of the object; return it, if any.

    If the armature is sheared, its copy has an Empty as a parent, since files contain locations, rotations and scales.
    """
    rigged = armatures(obj)
    if not rigged:
        return None
    rig = rigged[0].object.copy()
    rig.data = rig.data.copy()
    world = rig.matrix_world.copy()
    scene.collection.objects.link(rig)
    rig.parent = None
    if is_sheared(world):
        rig.parent = bpy.data.objects.new(f"{rig.name} Place", None)
        scene.collection.objects.link(rig.parent)
        rig.parent.matrix_basis, rig.matrix_basis = unsheared_factors(world)
        rig.parent_type, rig.matrix_parent_inverse = "OBJECT", Matrix()
    else:
        rig.matrix_world = world
    copy.modifiers.new("Armature", "ARMATURE").object = rig
    # Unlike a location, a rotation and a scale, it may have a shear.
    copy.parent, copy.matrix_parent_inverse = rig, world.inverted() @ obj.matrix_world
    anchor_vertices(copy, rig, influences(obj, rigged[0], copy.data).ravel())
    return rig


def _parts_of(rig: bpy.types.Object | None) -> list[bpy.types.ID]:
    """Return the data-blocks of a copy of an armature."""
    return [] if rig is None else [rig, rig.data, *([rig.parent] if rig.parent else [])]


def _rig_names(rig: bpy.types.Object | None, obj: bpy.types.Object) -> list[tuple[bpy.types.ID, bpy.types.ID]]:
    """Return the copy of an object's armature and of its data, each with its original."""
    if rig is None:
        return []
    original = armatures(obj)[0].object
    return [(rig, original), (rig.data, original.data)]


def _assign_plain_material(
    mesh: bpy.types.Mesh, obj: bpy.types.Object
) -> list[tuple[bpy.types.Material, bpy.types.Material]]:
    """Replace materials that read the color of the object by copies with that color; return these and the originals."""
    made = []
    for place, material in enumerate(mesh.materials):
        if shows_object_color(material):
            made.append((plain_copy(material, tuple(obj.color)), material))
            mesh.materials[place] = made[-1][0]
    return made


def _write_targets(write: Callable[[str], set[str]]) -> Callable[[bpy.types.Object, range, Path], list[Path]]:
    """Return a function that writes the keys with one of Blender's exporters."""

    def written(obj: bpy.types.Object, frames: range, target: Path) -> list[Path]:
        with _keyed_copy(obj, frames), written_whole(target) as draft:
            require_written(write(str(draft)), draft, target)
        return [target]

    return written


def _write_points(write: Callable[[str], set[str]]) -> Callable[[bpy.types.Object, range, Path], list[Path]]:
    """Return a function that writes the vertices and velocities of every frame with one of Blender's exporters."""

    def written(obj: bpy.types.Object, frames: range, target: Path) -> list[Path]:
        render = bpy.context.scene.render
        moving = sampled_vertices(obj, frames)
        meshes = _frame_meshes(obj, moving, render.fps / render.fps_base)
        shown = [bpy.data.objects.new(mesh.name, mesh) for mesh in meshes]
        try:
            sequence = mesh_sequence(bpy.path.clean_name(target.stem), [(one,) for one in shown], frames[0])
            with sequence, written_whole(target) as draft:
                require_written(write(str(draft)), draft, target)
        finally:
            bpy.data.batch_remove([*shown, *meshes])
        return [target]

    return written


def _frame_meshes(obj: bpy.types.Object, moving: MovingVertices, fps: float) -> list[bpy.types.Mesh]:
    """Create a mesh for every frame, in world space, with the velocities of its vertices."""
    velocities = np.gradient(moving.points, axis=0) * fps if len(moving.points) > 1 else np.zeros_like(moving.points)
    meshes = []
    for points, velocity in zip(moving.points, velocities, strict=True):
        mesh = _without_keys(obj)
        mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
        write_velocity(mesh, velocity)
        mesh.update()
        meshes.append(mesh)
    return meshes


def _write_textures(obj: bpy.types.Object, frames: range, target: Path) -> list[Path]:
    """Write vertex animation textures."""
    render = bpy.context.scene.render
    moving = sampled_vertices(obj, frames)
    mesh = _without_keys(obj)
    plain = _assign_plain_material(mesh, obj)
    try:
        return write_moving_mesh(mesh, obj.name, moving, target, render.fps / render.fps_base)
    finally:
        bpy.data.meshes.remove(mesh)
        bpy.data.batch_remove([own for own, _ in plain])


def _without_keys(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Return a copy of an object's mesh, modifiers applied, without shape keys."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(
        obj.evaluated_get(depsgraph), preserve_all_data_layers=True, depsgraph=depsgraph
    )
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
    return bpy.ops.export_scene.fbx(
        filepath=file,
        object_types={"MESH", "ARMATURE", "EMPTY"},
        add_leaf_bones=False,
        bake_anim_use_all_actions=False,
        bake_anim_use_nla_strips=False,
        bake_anim_simplify_factor=0.0,
    )


KEY_FORMATS: dict[str, Callable[[bpy.types.Object, range, Path], list[Path]]] = {
    ".glb": _write_targets(_gltf),
    ".fbx": _write_targets(_fbx),
    ".usdc": _write_points(write_usd),
    ".usd": _write_points(write_usd),
    ".usda": _write_points(write_usd),
    ".abc": _write_points(partial(write_alembic, colors=False)),
    ".json": _write_textures,
}
"""Functions that write a mesh with shape keys, by file extension."""
