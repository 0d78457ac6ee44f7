# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert vertex groups to arrays and back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .element_values import write_attribute
from .group_users import kept_group_users
from .mesh_checks import readable_mesh, writable_mesh
from .nodes.node_math import named_attribute, stored_attribute
from .sequence import frame_group, own_geometry

# Names of temporary attributes.
_READ, _WRITTEN = "convwass read {}", "convwass written"
# Names that Blender 4.5 takes for those of attributes even if the mesh has none of them.
_BUILT_IN = ("material_index", "id", "sharp_face", "sharp_edge")


def group_names(obj: bpy.types.Object) -> list[str]:
    """Return the names of the vertex groups of an object in order."""
    return obj.vertex_groups.keys()


def read_group(obj: bpy.types.Object, name: str) -> NDArray[np.float64]:
    """Return the weight of every vertex in a group, (n,); 0 for vertices outside of the group.

    In Weight Paint and Edit Mode, the current state is read.

    Raises
    ------
    InputError
        Not a mesh, or it has no such group.
    """
    return read_groups(obj, [name])[0]


def read_groups(obj: bpy.types.Object, names: Sequence[str]) -> NDArray[np.float64]:
    """Return the weights of all vertices in several groups, (k, n), in a few milliseconds for meshes of any size.

    Raises
    ------
    InputError
        As `read_group`.
    """
    mesh = readable_mesh(obj)
    for name in names:
        if name not in obj.vertex_groups:
            raise InputError(
                "{object} has no vertex group {name}; it has: {groups}.",
                object=obj.name,
                name=name,
                groups=", ".join(group_names(obj)) or "none",
            )
    return mesh_weights(mesh, names, [obj.vertex_groups[name].index for name in names]).astype(np.float64)


def mesh_weights(mesh: bpy.types.Mesh, names: Sequence[str], indices: Sequence[int]) -> NDArray[np.float32]:
    """Return the weights of all vertices in some groups of a mesh, (k, n), given their names and indices.

    The mesh must be in the file, not a temporary one of an evaluated object.
    """
    weights = _by_nodes(mesh, names)
    for place, (name, index) in enumerate(zip(names, indices, strict=True)):
        # Nodes cannot distinguish a group from an attribute of the same name, and do not read hidden names.
        if name in mesh.attributes or name in _BUILT_IN or name.startswith("."):
            weights[place] = weights_one_by_one(mesh, index)
    return weights


def write_group(obj: bpy.types.Object, name: str, weights: ArrayLike) -> bpy.types.VertexGroup:
    """Write a group, creating it if necessary. Its position in the list, its users and all other groups are kept.

    Parameters
    ----------
    obj : bpy.types.Object
        In any mode except Edit Mode.
    name : str
        Name of the group.
    weights : (n,) array_like
        From 0 to 1; vertices of weight 0 are not in the group. `as_weights` converts densities to weights.

    Raises
    ------
    InputError
        Not a mesh, in Edit Mode, linked, a locked group, or a name that is too long.
    """
    mesh = writable_mesh(obj)
    values = _checked(weights, len(mesh.vertices))
    require_unlocked(obj, [name])
    active, active_attribute = obj.vertex_groups.active_index, mesh.attributes.active_index
    try:
        with kept_group_users(mesh):
            _convert(obj, mesh, values)
            _take_the_place(obj, obj.vertex_groups[-1], name)
    finally:
        mesh.attributes.active_index = active_attribute
        obj.vertex_groups.active_index = max(active, 0)
    mesh.update()
    return obj.vertex_groups[name]


def require_unlocked(obj: bpy.types.Object, names: Iterable[str]) -> None:
    """Raise InputError if one of the groups is locked."""
    locked = next((name for name in names if name in obj.vertex_groups and obj.vertex_groups[name].lock_weight), None)
    if locked is not None:
        raise InputError("The group {name} is locked; unlock it, or choose another name.", name=locked)


def as_weights(density: ArrayLike) -> NDArray[np.float64]:
    """Scale a density, (n,), or several, (k, n), so that the largest value is 1; negative values become 0."""
    values = np.maximum(np.asarray(density, dtype=np.float64), 0.0)
    largest = float(values.max(initial=0.0))
    return values / largest if largest > 0.0 else values


def _checked(weights: ArrayLike, count: int) -> NDArray[np.float32]:
    values = np.ascontiguousarray(weights, dtype=np.float32)
    if values.shape != (count,):
        raise ValueError(f"{values.shape} weights for {count} vertices")
    if not (np.isfinite(values).all() and values.min(initial=0.0) >= 0.0 and values.max(initial=0.0) <= 1.0):
        raise ValueError("weights are not from 0 to 1")
    return values


def _by_nodes(mesh: bpy.types.Mesh, names: Sequence[str]) -> NDArray[np.float32]:
    """Copy groups to attributes with Geometry Nodes, because attributes are read at once, but groups vertex by vertex.

    Uses a temporary scene, so that nothing else is evaluated.
    """
    edited = mesh.copy() if mesh.is_editmode else None
    scene = bpy.data.scenes.new("Vertex Groups")
    probe = bpy.data.objects.new("Vertex Groups", edited or mesh)
    tree = _copying_tree(names)
    try:
        probe.modifiers.new("Vertex Groups", "NODES").node_group = tree
        scene.collection.objects.link(probe)
        layer = scene.view_layers[0]
        layer.update()
        attributes = probe.evaluated_get(layer.depsgraph).data.attributes
        weights = np.empty((len(names), len(mesh.vertices)), dtype=np.float32)
        for place, row in enumerate(weights):
            attributes[_READ.format(place)].data.foreach_get("value", row)
        return weights
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.batch_remove([probe, tree, *([edited] if edited else [])])


def _copying_tree(names: Sequence[str]) -> bpy.types.NodeTree:
    tree = frame_group("Vertex Groups")
    geometry = own_geometry(tree)
    for place, name in enumerate(names):
        geometry = stored_attribute(tree, geometry, _READ.format(place), named_attribute(tree, name))
    tree.links.new(geometry, tree.nodes.new("NodeGroupOutput").inputs["Geometry"])
    return tree


def weights_one_by_one(mesh: bpy.types.Mesh, index: int) -> NDArray[np.float32]:
    """Return the weights of all vertices in a group with this index, (n,), also of a temporary mesh."""
    weights = np.zeros(len(mesh.vertices), np.float32)
    for vertex in mesh.vertices:
        for entry in vertex.groups:
            if entry.group == index:
                weights[vertex.index] = entry.weight
    return weights


def _convert(obj: bpy.types.Object, mesh: bpy.types.Mesh, values: NDArray[np.float32]) -> None:
    """Append a group with these weights by Blender's conversion of an attribute.

    This is the only call that sets all weights at once. It works for hidden objects and without a scene, too.
    """
    mesh.attributes.active = write_attribute(mesh, _WRITTEN, "FLOAT", values)
    with bpy.context.temp_override(object=obj, active_object=obj):
        bpy.ops.geometry.attribute_convert(mode="VERTEX_GROUP")


def _take_the_place(obj: bpy.types.Object, made: bpy.types.VertexGroup, name: str) -> None:
    """Name the last group; it replaces a group that already has the name."""
    groups, old = obj.vertex_groups, obj.vertex_groups.get(name)
    steps = 0
    if old is not None and old != made:
        steps = len(groups) - 2 - old.index
        groups.remove(old)
    made = groups[-1]
    made.name = name
    if made.name != name:
        groups.remove(made)
        raise InputError("{name} is too long for the name of a vertex group; choose a shorter one.", name=name)
    groups.active_index = made.index
    with _in_viewports(obj), bpy.context.temp_override(object=obj, active_object=obj):
        for _ in range(steps):
            bpy.ops.object.vertex_group_move(direction="UP")


@contextmanager
def _in_viewports(obj: bpy.types.Object) -> Iterator[None]:
    """Enable an object in viewports, without which Blender does not move its groups."""
    if not obj.hide_viewport:
        yield
        return
    obj.hide_viewport = False
    try:
        yield
    finally:
        obj.hide_viewport = True
