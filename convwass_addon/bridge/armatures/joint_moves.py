# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write moved joints back to the bones of an armature."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...errors import InputError
from ...geometry.algebra.affine import transformed_points
from .joint_layout import JointLayout, joint_layout
from .rig_bones import SIDES, bone_ends
from .rig_graphs import RigGraph

# Minimal length of a bone, relative to the extent of the armature.
_SHORTEST = 1e-4


def move_armature_joints(obj: bpy.types.Object, rig: RigGraph, positions: NDArray[np.float64]) -> list[str]:
    """Move the joints of an armature.

    Bones keep their names, parents, connections and settings, and rotate by the smallest angle together with their
    roll. Bones that are not in the graph move with the joint that they start at, or with the nearest joint.

    Parameters
    ----------
    obj : bpy.types.Object
        The armature; its mode is restored afterwards.
    rig : RigGraph
        The joints as they were read.
    positions : (v, 3)
        New positions in world space.

    Returns
    -------
    list of str
        Bones whose joints coincide; they get a small length.

    Raises
    ------
    InputError
        The bones have changed since the joints were read.
    """
    local = transformed_points(positions, np.linalg.inv(rig.matrix))
    with _edited_bones(obj) as bones:
        present = bone_ends(obj)
        if sorted(bone.name for bone in present) != sorted(rig.parts):
            raise InputError("The bones of {object} have changed since the start; start again.", object=obj.name)
        layout = joint_layout(present)
        ends = _moved_ends(layout, rig, local)
        short = _lengthen(
            layout, ends, {end for own, pin in zip(rig.ends, rig.graph.pinned, strict=True) if pin for end in own}
        )
        _write_ends(bones, {bone.name: ends[place] for place, bone in enumerate(present)})
    return short


def _moved_ends(layout: JointLayout, rig: RigGraph, local: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the new ends of all bones, (b, 2, 3)."""
    target = {end: local[joint] for joint, own in enumerate(rig.ends) for end in own}
    old = np.stack([bone.ends for bone in layout.bones])
    new, found = old.copy(), np.zeros(old.shape[:2], dtype=bool)
    for place, bone in enumerate(layout.bones):
        for side, name in enumerate(SIDES):
            if f"{bone.name}.{name}" in target:
                new[place, side], found[place, side] = target[f"{bone.name}.{name}"], True
    moves = new - old
    near = cKDTree(old[found])
    for place, bone in enumerate(layout.bones):
        if bone.is_connected and not found[place, 0]:
            moves[place, 0] = moves[layout.places[bone.parent], 1]
        elif not found[place, 0]:
            moves[place, 0] = moves[found][near.query(old[place, 0])[1]]
        if not found[place, 1]:
            moves[place, 1] = moves[place, 0]
    return old + moves


def _lengthen(layout: JointLayout, ends: NDArray[np.float64], pinned: set[str]) -> list[str]:
    """Give bones without length a small one, as Blender requires; return their names."""
    least = _SHORTEST * layout.extent
    short = []
    for place, bone in enumerate(layout.bones):
        if np.linalg.norm(ends[place, 1] - ends[place, 0]) >= least:
            continue
        old = bone.ends[1] - bone.ends[0]
        way = least * old / max(np.linalg.norm(old), np.finfo(float).tiny)
        side = 0 if f"{bone.name}.tail" in pinned else 1
        ends[layout.joints == layout.joints[place, side]] = ends[place, 1 - side] + (way if side else -way)
        short.append(bone.name)
    return short


def _write_ends(bones: bpy.types.ArmatureEditBones, ends: Mapping[str, NDArray[np.float64]]) -> None:
    axes = {name: (bones[name].tail - bones[name].head, bones[name].z_axis.copy()) for name in ends}
    for name, (head, tail) in ends.items():
        bones[name].head, bones[name].tail = head, tail
    for name, (old, axis) in axes.items():
        bone = bones[name]
        turn = Vector(old).rotation_difference(bone.tail - bone.head)
        bone.align_roll(turn @ axis)


@contextmanager
def _edited_bones(obj: bpy.types.Object) -> Iterator[bpy.types.ArmatureEditBones]:
    """Provide the edit bones of an armature, with mirroring switched off; modes are restored afterwards."""
    mirrored = obj.data.use_mirror_x
    with _edit_mode(obj):
        obj.data.use_mirror_x = False
        try:
            yield obj.data.edit_bones
        finally:
            obj.data.use_mirror_x = mirrored


@contextmanager
def _edit_mode(obj: bpy.types.Object) -> Iterator[None]:
    if obj.mode == "EDIT":
        yield
        return
    objects = bpy.context.view_layer.objects
    active = objects.active
    mode = "OBJECT" if active is None else active.mode
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        yield
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
        objects.active = active
        if mode != "OBJECT":
            bpy.ops.object.mode_set(mode=mode)
