# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigs of either kind, armatures and meshes of edges: their joints, their pins, and the body that they go into."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy
import numpy as np
from bpy.props import BoolVectorProperty, FloatVectorProperty
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from ..objects import triangle_mesh
from .armature_graphs import armature_graph
from .edge_graphs import edge_graph, move_edge_joints, pin_vertices, pinned_vertices
from .joint_moves import move_armature_joints
from .rig_bones import SIDES, forget_rest, note_rest
from .rig_graphs import RigGraph

KINDS = ("ARMATURE", "MESH")
"""Types of objects that can be rigs."""


def register_pins() -> None:
    """Let bones have pins, which are saved with them, and follow when bones are renamed, undone and edited."""
    for kind in (bpy.types.Bone, bpy.types.EditBone):
        kind.convwass_pinned = BoolVectorProperty(
            name="Pinned", description="Whether head and tail stay where they are when the armature is fitted", size=2
        )
        kind.convwass_rest = FloatVectorProperty(
            name="Rest", description="Head and tail when a joint of the armature was first pinned", size=6
        )


def unregister_pins() -> None:
    """Take that away; what is saved in files stays there."""
    for kind in (bpy.types.Bone, bpy.types.EditBone):
        del kind.convwass_pinned, kind.convwass_rest


@contextmanager
def with_pins() -> Iterator[None]:
    """Let bones have pins for a while, where the add-on is not registered."""
    if hasattr(bpy.types.Bone, "convwass_pinned"):
        yield
        return
    register_pins()
    try:
        yield
    finally:
        unregister_pins()


def rig_graph(obj: bpy.types.Object, only_deforming: bool = True) -> RigGraph:
    """Return the joints of a rig as it stands in the scene, at rest.

    Parameters
    ----------
    obj : bpy.types.Object
        An armature, or a mesh of edges.
    only_deforming : bool
        Leave out bones that deform no mesh, if there are others.

    Raises
    ------
    InputError
        No joints, or a scale of zero.
    """
    return armature_graph(obj, only_deforming) if obj.type == "ARMATURE" else edge_graph(obj)


def move_joints(obj: bpy.types.Object, rig: RigGraph, positions: NDArray[np.float64]) -> list[str]:
    """Move the joints of a rig, world space; return names of bones that would have no length.

    Raises
    ------
    InputError
        The rig has other bones or vertices than when its joints were read.
    """
    if obj.type == "ARMATURE":
        return move_armature_joints(obj, rig, positions)
    move_edge_joints(obj, rig, positions)
    return []


def pin_joints(obj: bpy.types.Object, rig: RigGraph, joints: Iterable[int]) -> None:
    """Pin joints of a rig where they are; bones keep the lengths that they have had so far."""
    if obj.type == "ARMATURE":
        note_rest(obj)
    _set_pins(obj, rig, joints, True)


def unpin_joints(obj: bpy.types.Object, rig: RigGraph, joints: Iterable[int]) -> None:
    """Let go of joints of a rig."""
    _set_pins(obj, rig, joints, False)


def _set_pins(obj: bpy.types.Object, rig: RigGraph, joints: Iterable[int], pinned: bool) -> None:
    chosen = [rig.ends[joint] for joint in joints]
    if obj.type != "ARMATURE":
        pin_vertices(obj, [int(own[0]) for own in chosen], pinned)
        return
    bones = obj.data.edit_bones if obj.mode == "EDIT" else obj.data.bones
    for own in chosen:
        for end in own:
            _pin_end(bones, end, pinned and end == own[0])


def _pin_end(bones: bpy.types.bpy_prop_collection, end: str, pinned: bool) -> None:
    # The joint's name has the pin, so that there is one of it.
    name, _, side = end.rpartition(".")
    flags = list(bones[name].convwass_pinned)
    if flags[SIDES.index(side)] != pinned:
        flags[SIDES.index(side)] = pinned
        bones[name].convwass_pinned = flags


def clear_pins(obj: bpy.types.Object) -> None:
    """Let go of all joints of a rig; its bones are as long then as they are."""
    if obj.type == "ARMATURE":
        forget_rest(obj)
        for end in pinned_ends(obj):
            _pin_end(obj.data.edit_bones if obj.mode == "EDIT" else obj.data.bones, end, False)
        return
    pin_vertices(obj, list(range(len(obj.data.vertices))), False)


def pinned_ends(obj: bpy.types.Object) -> list[str]:
    """Return what is pinned of a rig, as its joints are called. Quick enough for a panel."""
    if obj.type == "ARMATURE":
        bones = obj.data.edit_bones if obj.mode == "EDIT" else obj.data.bones
        return [
            f"{bone.name}.{side}"
            for bone in bones
            for side, pinned in zip(SIDES, bone.convwass_pinned, strict=True)
            if pinned
        ]
    return [str(vertex) for vertex in np.flatnonzero(pinned_vertices(obj.data))]


def resting_body(body: bpy.types.Object, rig: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> TriangleMesh:
    """Read the body as it stands in the scene when the rig is not posed: modifiers applied, world space.

    Raises
    ------
    InputError
        Not a mesh, no faces, a scale of zero, or coordinates that are not numbers.
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
    """Tell whether a rig stands otherwise than at rest."""
    if obj.type != "ARMATURE" or obj.data.pose_position == "REST":
        return False
    return any(
        not np.allclose(bone.matrix, bone.bone.matrix_local, atol=1e-5 * max(bone.bone.length, 1.0))
        for bone in obj.pose.bones
    )


def require_movable(obj: bpy.types.Object) -> None:
    """Refuse a rig whose joints cannot be moved; raises InputError."""
    if not (obj.is_editable and obj.data.is_editable):
        raise InputError(
            "{object} is linked from another file and cannot be changed here; make it local with its data: "
            "Object > Relations > Make Local.",
            object=obj.name,
        )
    if obj.override_library or obj.data.override_library:
        raise InputError(
            "{object} is a library override, whose joints cannot be moved; make it local with its data: "
            "Object > Relations > Make Local.",
            object=obj.name,
        )
    shown = obj.name in bpy.context.view_layer.objects and obj.visible_get()
    if obj.type == "ARMATURE" and not shown:
        raise InputError(
            "{object} is hidden, or in a collection that is; show it, so that its bones can be moved.", object=obj.name
        )
