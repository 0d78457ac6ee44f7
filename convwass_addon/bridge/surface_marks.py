# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices marked by name: by a small vertex group, an Empty on the surface, or the end of a bone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ..geometry.meshes.mesh import TriangleMesh
from .object_names import without_number
from .surfaces import surface_mesh
from .vertex_groups import read_groups
from .visibility import update_places

# A few vertices are a mark on meshes of any size.
_FEW_VERTICES = 4


def group_marks(
    obj: bpy.types.Object, names: Sequence[str], depsgraph: bpy.types.Depsgraph, largest: float
) -> dict[str, int | None]:
    """Return for each group the vertex nearest to the center of its weights.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh.
    names : sequence of str
        Names of its groups.
    depsgraph : bpy.types.Depsgraph
        Dependency graph of the scene.
    largest : float
        Maximum fraction of the vertices in a group; larger groups are weights of bones.

    Returns
    -------
    dict
        None for empty or large groups.

    Raises
    ------
    InputError
        Not a mesh, or a mesh without a surface.
    """
    mesh = surface_mesh(obj, depsgraph)
    is_used = mesh.is_used
    found: dict[str, int | None] = {}
    for name, weights in zip(names, read_groups(obj, list(names)), strict=True):
        own = np.flatnonzero((weights > 0) & is_used)
        is_mark = 0 < len(own) <= max(largest * is_used.sum(), _FEW_VERTICES)
        found[name] = _middle(mesh, own, weights) if is_mark else None
    return found


def empty_marks(
    objects: Iterable[bpy.types.Object], depsgraph: bpy.types.Depsgraph, empties: Iterable[bpy.types.Object]
) -> dict[bpy.types.Object, dict[str, int | None]]:
    """Return for every object the vertices nearest to its Empties, by name without suffixes such as .001.

    An Empty belongs to its nearest ancestor among the objects, or, without one, to the object whose surface is nearest.

    Parameters
    ----------
    objects : iterable of bpy.types.Object
        Meshes.
    depsgraph : bpy.types.Depsgraph
        Dependency graph of the scene.
    empties : iterable of bpy.types.Object
        Other objects are ignored.

    Returns
    -------
    dict
        None if two Empties on one surface have the same name.

    Raises
    ------
    InputError
        Not a mesh, or a mesh without a surface.
    """
    meshes = {obj: surface_mesh(obj, depsgraph) for obj in dict.fromkeys(objects)}
    found: dict[bpy.types.Object, dict[str, int | None]] = {obj: {} for obj in meshes}
    marks = [obj for obj in empties if obj.type == "EMPTY"]
    # Markers are often hidden, and Blender does not move what is hidden.
    update_places(marks, depsgraph)
    for empty in marks:
        place = np.array(empty.matrix_world.translation, dtype=np.float64)
        nearest = {obj: nearest_vertex(mesh, place) for obj, mesh in meshes.items()}
        distances = {obj: np.linalg.norm(meshes[obj].vertices[vertex] - place) for obj, vertex in nearest.items()}
        owner = _ancestor(empty, meshes) or min(distances, key=distances.get)
        name = without_number(empty.name)
        found[owner][name] = None if name in found[owner] else nearest[owner]
    return found


def bone_marks(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> dict[str, int]:
    """Return the vertices at the ends of chains of bones, by the name of the last bone.

    Only bones that deform the object and have no deforming children are used: their tails are in fingertips, toes and
    the top of the head, where the vertex furthest along the bone is unambiguous.

    Raises
    ------
    InputError
        Not a mesh, or a mesh without a surface.
    """
    mesh = surface_mesh(obj, depsgraph)
    used = np.flatnonzero(mesh.is_used)
    found: dict[str, int] = {}
    for rig in _rigs(obj):
        evaluated = rig.evaluated_get(depsgraph)
        matrix = np.array(evaluated.matrix_world, dtype=np.float64)
        for bone in evaluated.pose.bones:
            if bone.bone.use_deform and not any(child.bone.use_deform for child in bone.children):
                head, tail = (matrix[:3, :3] @ np.array(end) + matrix[:3, 3] for end in (bone.head, bone.tail))
                found[bone.name] = _pointed_at(mesh, used, head, tail)
    return found


def nearest_vertex(mesh: TriangleMesh, place: NDArray[np.float64]) -> int:
    """Return the vertex with a face that is nearest to a point, (3,)."""
    used = np.flatnonzero(mesh.is_used)
    return int(used[np.linalg.norm(mesh.vertices[used] - place, axis=1).argmin()])


def _rigs(obj: bpy.types.Object) -> list[bpy.types.Object]:
    rigs = [modifier.object for modifier in obj.modifiers if modifier.type == "ARMATURE" and modifier.object]
    if not rigs and obj.parent is not None and obj.parent.type == "ARMATURE":
        rigs = [obj.parent]
    return list(dict.fromkeys(rigs))


def _pointed_at(
    mesh: TriangleMesh, used: NDArray[np.int64], head: NDArray[np.float64], tail: NDArray[np.float64]
) -> int:
    """Return the vertex furthest along a bone, among those nearly as close to its tail as the nearest vertex."""
    away = mesh.vertices[used] - tail
    distances = np.linalg.norm(away, axis=1)
    length = np.linalg.norm(tail - head)
    near = distances <= distances.min() + 0.5 * length
    along = away @ (tail - head)
    return int(used[np.where(near, along, -np.inf).argmax()])


def _middle(mesh: TriangleMesh, own: NDArray[np.int64], weights: NDArray[np.float64]) -> int:
    points = mesh.vertices[own]
    center = np.average(points, axis=0, weights=weights[own])
    return int(own[np.linalg.norm(points - center, axis=1).argmin()])


def _ancestor(obj: bpy.types.Object, wanted: Mapping[bpy.types.Object, object]) -> bpy.types.Object | None:
    """Return the nearest ancestor of an object among the wanted objects."""
    parent = obj.parent
    while parent is not None and parent not in wanted:
        parent = parent.parent
    return parent
