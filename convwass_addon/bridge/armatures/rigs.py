# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigs, either armatures or meshes of edges: their joints, and the body."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from ..mesh_checks import linked_elsewhere
from ..objects import triangle_mesh
from .armature_graphs import armature_graph
from .edge_graphs import edge_graph, move_edge_joints
from .joint_moves import move_armature_joints
from .rig_graphs import RigGraph


def rig_graph(obj: bpy.types.Object, only_deforming: bool = True) -> RigGraph:
    """Return the joint graph of a rig in rest position.

    Parameters
    ----------
    obj : bpy.types.Object
        An armature, or a mesh of edges.
    only_deforming : bool
        Skip bones that do not deform meshes, if there are others.

    Raises
    ------
    InputError
        The rig has no joints, or a scale is zero.
    """
    return armature_graph(obj, only_deforming) if obj.type == "ARMATURE" else edge_graph(obj)


def move_joints(obj: bpy.types.Object, rig: RigGraph, positions: NDArray[np.float64]) -> list[str]:
    """Move the joints of a rig in world space; return the names of bones that would have no length.

    Raises
    ------
    InputError
        The bones or vertices have changed since the joints were read.
    """
    if obj.type == "ARMATURE":
        return move_armature_joints(obj, rig, positions)
    move_edge_joints(obj, rig, positions)
    return []


def resting_body(body: bpy.types.Object, rig: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> TriangleMesh:
    """Read the body with its modifiers in world space, with the rig in rest position.

    Raises
    ------
    InputError
        The object is not a mesh, has no faces, a scale of zero, or coordinates that are not finite.
    """
    with _at_rest(rig):
        return triangle_mesh(body, depsgraph)


@contextmanager
def _at_rest(rig: bpy.types.Object) -> Iterator[None]:
    if rig.type != "ARMATURE" or rig.data.pose_position == "REST":
        yield
        return
    rig.data.pose_position = "REST"
    try:
        yield
    finally:
        rig.data.pose_position = "POSE"


def is_posed(obj: bpy.types.Object) -> bool:
    """Return whether a rig is posed."""
    if obj.type != "ARMATURE" or obj.data.pose_position == "REST":
        return False
    return any(
        not np.allclose(bone.matrix, bone.bone.matrix_local, atol=1e-5 * max(bone.bone.length, 1.0))
        for bone in obj.pose.bones
    )


def require_movable(obj: bpy.types.Object) -> None:
    """Raise InputError if the joints of a rig cannot be moved."""
    if not (obj.is_editable and obj.data.is_editable):
        raise linked_elsewhere(obj)
    if obj.override_library or obj.data.override_library:
        raise InputError(
            "{object} is a library override, whose joints cannot be moved; make it local with its data: "
            "Object > Relations > Make Local.",
            object=obj.name,
        )
    if obj.type == "MESH" and obj.data.shape_keys:
        raise InputError(
            "{object} has shape keys, which hold its joints in place; apply or delete them: Object Data > Shape Keys.",
            object=obj.name,
        )
    shown = obj.name in bpy.context.view_layer.objects and obj.visible_get()
    if obj.type == "ARMATURE" and not shown:
        raise InputError(
            "{object} or its collection is hidden; show it, so that its bones can be moved.", object=obj.name
        )
