# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh that gets shape keys, and the conversion of positions in the scene to coordinates of keys.

Shape keys move vertices before modifiers do. A mesh with an armature keeps it and all modifiers after it. With L_v, the
linear part of the transforms of object and armatures at vertex v, a motion from x to p in the scene becomes the key b +
L_v^-1 (p - x), where b is the vertex in the first key. Other modifiers are applied.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.one_mesh.mirror_symmetry import MirrorSymmetry
from ...geometry.algebra.affine import transformed_points
from ...geometry.meshes.mirror_planes import MirrorPlane
from ...sentence import Sentence
from ..armatures.rigs import is_posed
from ..element_values import vectors_of, write_floats
from ..objects import evaluated_mesh, frozen_copy, take_own_materials, transform_mesh, triangle_mesh
from ..unused_data import removed_on_errors
from ..visibility import evaluated_object, hidden_modifiers
from .shape_keys import require_mixable_keys
from .skinning import approximation_notices, armatures, deforms_by_groups, skinning


@dataclass(frozen=True)
class RestMesh:
    """A mesh before its armatures.

    Attributes
    ----------
    mesh : bpy.types.Mesh
        A copy without users; in world space for a mesh without armature, otherwise in local space of its object.
    seen : (n, 3) float64
        Positions of the vertices in the scene, in world space.
    linear : (n, 3, 3) float64 or None
        Linear parts of object and armatures; None for the identity.
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
            points = transformed_points(points, np.linalg.inv(np.array(obj.matrix_world, dtype=np.float64)))
        return MirrorSymmetry.of(points, MirrorPlane(np.zeros(3), np.array([1.0, 0.0, 0.0])), obj.name)


def armature_last(obj: bpy.types.Object) -> AbstractContextManager[None]:
    """Hide modifiers after the armatures of an object temporarily; does nothing if there are none."""
    return hidden_modifiers(_shown_after(obj, armatures(obj)))


def pose_notices(obj: bpy.types.Object) -> list[Sentence]:
    """Return a notice for every posed armature of an object that its keys do not heed.

    They heed the first armature, and others that directly follow it.
    """
    later = [own for own in _shown_after(obj, armatures(obj)) if deforms_by_groups(own) and is_posed(own.object)]
    return [
        Sentence(
            "The keys of {name} are made without the pose of {modifier}; move that modifier directly after the first "
            "armature, or use the rest pose.",
            {"name": obj.name, "modifier": own.name},
        )
        for own in later
    ]


def _shown_after(obj: bpy.types.Object, rigged: Sequence[bpy.types.Modifier]) -> list[bpy.types.Modifier]:
    """Return the visible modifiers after the armatures of an object; none without any."""
    own = list(obj.modifiers)
    return [modifier for modifier in own[own.index(rigged[-1]) + 1 :] if modifier.show_viewport] if rigged else []


def rest_mesh(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> RestMesh:
    """Copy the mesh of an object; modifiers after its armatures must be hidden (`armature_last`).

    Raises
    ------
    InputError
        As :func:`..objects.frozen_copy`, the pose flattens parts of the mesh, or its own keys admit no others.
    """
    rigged, seen = armatures(obj), triangle_mesh(obj, depsgraph).vertices
    kept = _from_first(obj, rigged)
    before = [own.name for own in obj.modifiers if own.show_viewport and own.name not in kept]
    notices = []
    if before:
        values = {"name": obj.name, "modifiers": ", ".join(before)}
        notices.append(Sentence("The modifiers of {name} ({modifiers}) are applied to the copy.", values))
        if obj.data.shape_keys is not None:
            notices.append(Sentence("The shape keys of {name} are applied to the copy, too.", {"name": obj.name}))
    else:
        require_mixable_keys(obj)
    if not rigged:
        return RestMesh(_world_copy(obj, depsgraph, apply=bool(before)), seen, None, (), notices)
    with hidden_modifiers(rigged):
        mesh = _local_copy(obj, depsgraph) if before else obj.data.copy()
    with removed_on_errors([mesh]):
        linear = skinning(obj, rigged, mesh)[:, :3, :3]
    return RestMesh(mesh, seen, linear, kept, [*notices, *approximation_notices(obj, rigged)])


def at_rest(obj: bpy.types.Object, mesh: bpy.types.Mesh, seen: NDArray[np.float64]) -> RestMesh:
    """Undo the armatures of an object on a mesh that shows the object as it is seen in the scene.

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
    rigged = armatures(obj)
    if not rigged:
        return RestMesh(mesh, seen, None, (), [])
    with removed_on_errors([mesh]):
        transforms = skinning(obj, rigged, mesh)
    linear = transforms[:, :3, :3]
    rest = np.linalg.solve(linear, (seen - transforms[:, :3, 3])[..., None])[..., 0]
    write_floats(mesh.vertices, "co", rest)
    if obj.matrix_world.is_negative:
        mesh.flip_normals()
    mesh.update()
    return RestMesh(mesh, seen, linear, _from_first(obj, rigged), approximation_notices(obj, rigged))


def _from_first(obj: bpy.types.Object, rigged: Sequence[bpy.types.Modifier]) -> tuple[str, ...]:
    """Return the names of the first armature of an object and of all modifiers after it; none without any."""
    names = [own.name for own in obj.modifiers]
    return tuple(names[names.index(rigged[0].name) :]) if rigged else ()


def _world_copy(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, *, apply: bool) -> bpy.types.Mesh:
    """Copy a mesh to world space; its shape keys are kept if there are no modifiers."""
    if apply or obj.data.shape_keys is None:
        return frozen_copy(obj, depsgraph)
    mesh = obj.data.copy()
    take_own_materials(mesh, obj)
    transform_mesh(mesh, obj.matrix_world)
    return mesh


def _local_copy(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bpy.types.Mesh:
    with evaluated_object(obj, depsgraph) as evaluated:
        return evaluated_mesh(evaluated, depsgraph)


def _basis(mesh: bpy.types.Mesh) -> NDArray[np.float64]:
    """Return the vertices in the first key, (n, 3)."""
    items = mesh.vertices if mesh.shape_keys is None else mesh.shape_keys.key_blocks[0].data
    return vectors_of(items)
