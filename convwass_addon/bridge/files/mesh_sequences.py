# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene of objects that show the meshes of others, frame by frame, for exporters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

import bpy

from ..nodes.index_switch import chosen, index_switch
from ..nodes.node_math import joined
from ..nodes.node_trees import node_trees
from ..sequence import MODIFIER, along_x, frame_group, nearest, object_info, output, own_geometry, table_object
from .scratch_scene import scratch_animation


@contextmanager
def mesh_sequences(
    shown: Mapping[str, Sequence[tuple[bpy.types.Object, ...]]], first_frame: int
) -> Iterator[list[bpy.types.Object]]:
    """Run a block of code in a temporary scene of objects that show the meshes of others, frame by frame.

    All versions of Blender export each as a single mesh of changing topology, whereas exporters treat objects that are
    shown in turn differently.

    Parameters
    ----------
    shown : mapping of str to sequence of tuple of bpy.types.Object
        Objects at the origin, shown at `first_frame`, the frame after it, and so on, by the name of the object that
        shows them, its mesh and its node group. All sequences have the same length.
    first_frame : int
        The first frame of the scene, and its current one; 0 instead if it is before, where no scene begins.

    Yields
    ------
    list of bpy.types.Object
        The objects that show the sequences.
    """
    first_frame = max(first_frame, 0)
    made = [_sequence(name, groups, first_frame) for name, groups in shown.items()]
    try:
        with scratch_animation(first_frame, first_frame + max(map(len, shown.values())) - 1) as scene:
            for obj in made:
                scene.collection.objects.link(obj)
            scene.frame_set(first_frame)
            yield made
    finally:
        trees = [tree for obj in made for tree in node_trees(obj.modifiers[MODIFIER].node_group)]
        bpy.data.batch_remove([*made, *(obj.data for obj in made), *trees])


def _sequence(name: str, shown: Sequence[tuple[bpy.types.Object, ...]], first_frame: int) -> bpy.types.Object:
    """Create an object that shows the meshes of others from a frame on."""
    tree = frame_group(name)
    time = tree.nodes.new("GeometryNodeInputSceneTime").outputs["Frame"]
    index = nearest(tree, own_geometry(tree), along_x(tree, time))
    meshes = index_switch(f"{name} Frames", {"Geometry": "GEOMETRY"}, shown, _joined_objects)
    output(tree, chosen(tree, meshes, index)["Geometry"], len(shown))
    return table_object(name, [(first_frame + place, 0.0, 0.0) for place in range(len(shown))], tree)


def _joined_objects(tree: bpy.types.NodeTree, objects: tuple[bpy.types.Object, ...]) -> tuple[bpy.types.NodeSocket]:
    """Return the geometry of all objects."""
    return (joined(tree, [object_info(tree, obj).outputs["Geometry"] for obj in reversed(objects)]),)
