# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bones of armatures in rest position, and before joints were moved."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

SIDES = ("head", "tail")
"""Suffixes for the two ends of a bone."""


@dataclass(frozen=True)
class RigBone:
    """The data of a bone.

    Attributes
    ----------
    name : str
        Name of the bone.
    parent : str or None
        Name of its parent.
    is_connected : bool
        Whether it starts at its parent's tail.
    is_deforming : bool
        Whether it deforms meshes.
    ends : (2, 3) float64
        Head and tail in armature space.
    pinned : (bool, bool)
        Whether head and tail are pinned.
    selected : (bool, bool)
        Whether head and tail are selected; false outside Edit Mode.
    rest : (2, 3) float64 or None
        Head and tail before any joint was moved, or None if unknown.
    """

    name: str
    parent: str | None
    is_connected: bool
    is_deforming: bool
    ends: NDArray[np.float64]
    pinned: tuple[bool, bool]
    selected: tuple[bool, bool]
    rest: NDArray[np.float64] | None


def bone_ends(obj: bpy.types.Object) -> list[RigBone]:
    """Read the bones of an armature in rest position, including changes in Edit Mode, parents before their children."""
    if obj.mode == "EDIT":
        return [_edited_bone(bone) for bone in _parents_first(obj.data.edit_bones)]
    return [_resting_bone(bone) for bone in _parents_first(obj.data.bones)]


def _parents_first(bones: bpy.types.bpy_prop_collection) -> list[bpy.types.Bone | bpy.types.EditBone]:
    return sorted(bones, key=lambda bone: len(bone.parent_recursive))


def _resting_bone(bone: bpy.types.Bone) -> RigBone:
    return _rig_bone(bone, np.array([bone.head_local, bone.tail_local], dtype=np.float64), (False, False))


def _edited_bone(bone: bpy.types.EditBone) -> RigBone:
    ends = np.array([bone.head, bone.tail], dtype=np.float64)
    return _rig_bone(bone, ends, (bone.select_head, bone.select_tail))


def _rig_bone(
    bone: bpy.types.Bone | bpy.types.EditBone, ends: NDArray[np.float64], selected: tuple[bool, bool]
) -> RigBone:
    rest = np.array(bone.convwass_rest, dtype=np.float64).reshape(2, 3)
    return RigBone(
        name=bone.name,
        parent=bone.parent.name if bone.parent else None,
        is_connected=bone.use_connect and bone.parent is not None,
        is_deforming=bone.use_deform,
        ends=ends,
        pinned=tuple(bone.convwass_pinned),
        selected=selected,
        # Bones always have a length, so equal ends mean that nothing was stored.
        rest=rest if (rest[0] != rest[1]).any() else None,
    )


def note_rest(obj: bpy.types.Object) -> None:
    """Store the current positions of the bones as the original ones, unless this was already done.

    In Edit Mode, the positions before Edit Mode are stored. Bones added later invalidate the stored positions.
    """
    is_edited = obj.mode == "EDIT"
    bones = current_bones(obj)
    present = bone_ends(obj)
    if all(bone.rest is not None for bone in present):
        return
    ends = {bone.name: bone.ends for bone in present}
    before = {bone.name: np.array([bone.head_local, bone.tail_local]) for bone in obj.data.bones}
    if is_edited and before.keys() >= ends.keys():
        ends = before
    for bone in bones:
        bone.convwass_rest = ends[bone.name].ravel()


def forget_rest(obj: bpy.types.Object) -> None:
    """Remove the stored original positions."""
    for bone in current_bones(obj):
        bone.convwass_rest = np.zeros(6)


def current_bones(obj: bpy.types.Object) -> bpy.types.bpy_prop_collection:
    """Return the bones of an armature; in Edit Mode, those that are edited."""
    return obj.data.edit_bones if obj.mode == "EDIT" else obj.data.bones
