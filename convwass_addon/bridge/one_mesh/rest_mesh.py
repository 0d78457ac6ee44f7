# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh that gets shape keys, and the conversion of positions in the scene to coordinates of keys.

Shape keys move vertices before modifiers do. A mesh with an armature keeps it and all modifiers after it. With L_v, the
linear part of the transforms of armature and object at vertex v, a motion from x to p in the scene becomes the key b +
L_v^-1 (p - x), where b is the vertex in the first key. Other modifiers are applied.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.one_mesh.mirror_symmetry import MirrorSymmetry
from ...errors import InputError
from ...geometry.mirror_planes import MirrorPlane
from ...sentence import Sentence
from ..objects import evaluated_object, frozen_copy, take_own_materials, transform_mesh, triangle_mesh
from .shape_keys import require_mixable_keys

# Vertices that the pose flattens more than this have no inverse.
_LEAST = 1e-6


@dataclass(frozen=True)
class RestMesh:
    """A mesh before its armature.

    Attributes
    ----------
    mesh : bpy.types.Mesh
        A copy without users; in world space for a mesh without armature, otherwise in local space of its object.
    seen : (n, 3) float64
        Positions of the vertices in the scene, in world space.
    linear : (n, 3, 3) float64 or None
        Linear parts of armature and object; None for the identity.
    modifiers : tuple of str
        Modifiers that are kept.
    notices : list of Sentence
        Messages for the user.
    """

    mesh: bpy.types.Mesh
    seen: NDArray[np.float64]
    linear: NDArray[np.float64] | None
    modifiers: tuple[str, ...]
    notices: list[Sentence]

    def key_coordinates(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return coordinates of keys, (k, n, 3), for positions in the scene, (k, n, 3)."""
        moved = positions - self.seen
        if self.linear is not None:
            moved = np.linalg.solve(self.linear, moved.transpose(1, 2, 0)).transpose(2, 0, 1)
        return _basis(self.mesh) + moved

    def symmetry(self, obj: bpy.types.Object) -> MirrorSymmetry:
        """Return which vertices are mirror images across the local X axis of the object that the mesh is copied from.

        Raises
        ------
        InputError
            The mesh is not symmetric.
        """
        points = _basis(self.mesh)
        if self.linear is None:
            inverse = np.linalg.inv(np.array(obj.matrix_world, dtype=np.float64))
            points = points @ inverse[:3, :3].T + inverse[:3, 3]
        return MirrorSymmetry.of(points, MirrorPlane(np.zeros(3), np.array([1.0, 0.0, 0.0])), obj.name)


@contextmanager
def armature_last(obj: bpy.types.Object) -> Iterator[int | None]:
    """Hide modifiers after the first armature temporarily; yields its index, or None without an armature."""
    place = armature_place(obj)
    hidden = [] if place is None else [own for own in list(obj.modifiers)[place + 1 :] if own.show_viewport]
    for modifier in hidden:
        modifier.show_viewport = False
    try:
        yield place
    finally:
        for modifier in hidden:
            modifier.show_viewport = True


def armature_place(obj: bpy.types.Object) -> int | None:
    """Return the index of the first modifier of an object that is a deforming armature."""
    places = (
        place
        for place, own in enumerate(obj.modifiers)
        if own.type == "ARMATURE" and own.show_viewport and own.object is not None and own.use_vertex_groups
    )
    return next(places, None)


def rest_mesh(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> RestMesh:
    """Copy the mesh of an object; modifiers after its armature must be hidden (`armature_last`).

    Raises
    ------
    InputError
        As :func:`..objects.frozen_copy`, the pose flattens parts of the mesh, or its own keys admit no others.
    """
    place, seen = armature_place(obj), triangle_mesh(obj, depsgraph).vertices
    before = [own.name for own in list(obj.modifiers)[:place] if own.show_viewport]
    notices = []
    if before:
        values = {"name": obj.name, "modifiers": ", ".join(before)}
        notices.append(Sentence("The modifiers of {name} ({modifiers}) are applied to the copy.", values))
        if obj.data.shape_keys is not None:
            notices.append(Sentence("The shape keys of {name} are applied to the copy, too.", {"name": obj.name}))
    else:
        require_mixable_keys(obj)
    if place is None:
        return RestMesh(_world_copy(obj, depsgraph, apply=bool(before)), seen, None, (), notices)
    kept = tuple(own.name for own in list(obj.modifiers)[place:])
    with _hidden(obj.modifiers[place]):
        mesh = _local_copy(obj, depsgraph) if before else obj.data.copy()
    try:
        linear = _skinning(obj, obj.modifiers[place], mesh)[:, :3, :3]
    except InputError:
        bpy.data.meshes.remove(mesh)
        raise
    return RestMesh(mesh, seen, linear, kept, [*notices, *_approximate(obj, place)])


def at_rest(obj: bpy.types.Object, mesh: bpy.types.Mesh, seen: NDArray[np.float64]) -> RestMesh:
    """Undo the armature of an object on a mesh that shows the object as it is seen in the scene.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object; without an armature, the mesh is left as it is.
    mesh : bpy.types.Mesh
        Without users, in world space, with the vertex groups of the object. Its vertices are moved.
    seen : (n, 3) float64
        Its vertices.

    Raises
    ------
    InputError
        The pose flattens parts of the mesh. The mesh is removed.
    """
    place = armature_place(obj)
    if place is None:
        return RestMesh(mesh, seen, None, (), [])
    try:
        skinning = _skinning(obj, obj.modifiers[place], mesh)
    except InputError:
        bpy.data.meshes.remove(mesh)
        raise
    linear = skinning[:, :3, :3]
    rest = np.linalg.solve(linear, (seen - skinning[:, :3, 3])[..., None])[..., 0]
    mesh.vertices.foreach_set("co", rest.astype(np.float32).ravel())
    if obj.matrix_world.is_negative:
        mesh.flip_normals()
    mesh.update()
    kept = tuple(own.name for own in list(obj.modifiers)[place:])
    return RestMesh(mesh, seen, linear, kept, _approximate(obj, place))


def _approximate(obj: bpy.types.Object, place: int) -> list[Sentence]:
    """Return a notice if the armature of an object, its modifier at `place`, does not just mix transforms of bones."""
    modifier = obj.modifiers[place]
    rig = modifier.object
    if not _is_posed(rig):
        return []
    if modifier.use_deform_preserve_volume:
        return [
            Sentence(
                "{name} is posed with Preserve Volume; at joints its keys are approximate. Use the rest pose.",
                {"name": obj.name},
            )
        ]
    if modifier.use_bone_envelopes or any(
        bone.bbone_segments > 1 and bone.use_deform and bone.name in obj.vertex_groups for bone in rig.data.bones
    ):
        return [
            Sentence(
                "{name} is posed by bendy bones or envelopes; its keys are approximate. Use the rest pose.",
                {"name": obj.name},
            )
        ]
    return []


def _world_copy(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, *, apply: bool) -> bpy.types.Mesh:
    """Copy a mesh to world space; its shape keys are kept if there are no modifiers."""
    if apply or obj.data.shape_keys is None:
        return frozen_copy(obj, depsgraph)
    mesh = obj.data.copy()
    take_own_materials(mesh, obj)
    transform_mesh(mesh, obj.matrix_world, shape_keys=True)
    return mesh


def _local_copy(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bpy.types.Mesh:
    with evaluated_object(obj, depsgraph) as evaluated:
        return bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=depsgraph)


@contextmanager
def _hidden(modifier: bpy.types.Modifier) -> Iterator[None]:
    modifier.show_viewport = False
    try:
        yield
    finally:
        modifier.show_viewport = True


def _skinning(obj: bpy.types.Object, modifier: bpy.types.Modifier, mesh: bpy.types.Mesh) -> NDArray[np.float64]:
    """Return the transform from local to world space by linear blend skinning for every vertex, (n, 4, 4)."""
    rig, own = modifier.object, np.array(obj.matrix_world, dtype=np.float64)
    bones = {
        group.index: np.array(_bone_motion(rig, rig.pose.bones[group.name]), dtype=np.float64)
        for group in obj.vertex_groups
        if group.name in rig.pose.bones and rig.data.bones[group.name].use_deform
    }
    linear = np.tile(own, (len(mesh.vertices), 1, 1))
    for vertex in mesh.vertices:
        weights = [(each.weight, bones[each.group]) for each in vertex.groups if each.group in bones]
        total = sum(weight for weight, _ in weights)
        if total > 0.0:
            share = _influence(obj, modifier, vertex)
            skinned = sum(weight / total * motion for weight, motion in weights)
            linear[vertex.index] = (share * skinned + (1.0 - share) * np.eye(4)) @ own
    if (np.linalg.svd(linear[:, :3, :3], compute_uv=False)[:, -1] < _LEAST).any():
        raise InputError("The pose of {name} flattens parts of it; use the rest pose.", name=obj.name)
    return linear


def _influence(obj: bpy.types.Object, modifier: bpy.types.Modifier, vertex: bpy.types.MeshVertex) -> float:
    """Return how much an armature moves a vertex, by the vertex group that limits its modifier, if any."""
    group = obj.vertex_groups.get(modifier.vertex_group)
    if group is None:
        return 1.0
    weight = next((each.weight for each in vertex.groups if each.group == group.index), 0.0)
    return 1.0 - weight if modifier.invert_vertex_group else weight


def _bone_motion(rig: bpy.types.Object, bone: bpy.types.PoseBone) -> object:
    """Return the world transform that a pose bone applies to points of the rest pose."""
    world = rig.matrix_world
    return world @ bone.matrix @ bone.bone.matrix_local.inverted() @ world.inverted()


def _is_posed(rig: bpy.types.Object) -> bool:
    return rig.data.pose_position == "POSE" and any(
        not np.allclose(bone.matrix, bone.bone.matrix_local, atol=1e-5) for bone in rig.pose.bones
    )


def _basis(mesh: bpy.types.Mesh) -> NDArray[np.float64]:
    """Return the vertices in the first key, (n, 3)."""
    items = mesh.vertices if mesh.shape_keys is None else mesh.shape_keys.key_blocks[0].data
    found = np.empty(3 * len(items), np.float32)
    items.foreach_get("co", found)
    return found.reshape(-1, 3).astype(np.float64)
