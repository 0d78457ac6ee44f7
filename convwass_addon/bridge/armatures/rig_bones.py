# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bones of armatures as they are at rest, and as they were before any was moved."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

SIDES = ("head", "tail")
"""The two ends of a bone, as they are written behind its name."""


@dataclass(frozen=True)
class RigBone:
    """What is to be known of a bone.

    Attributes
    ----------
    name : str
        Of the bone.
    parent : str or None
        Name of its parent.
    is_connected : bool
        Whether it begins in its parent's tail.
    is_deforming : bool
        Whether it takes part in deforming meshes.
    ends : (2, 3) float64
        Head and tail, in the armature's space.
    pinned : (bool, bool)
        Whether head and tail are pinned.
    selected : (bool, bool)
        Whether head and tail are selected; none of them outside of Edit Mode.
    rest : (2, 3) float64 or None
        Head and tail before any end was moved to where it belongs; None where that has not been noted.
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
    """Read the bones of an armature at rest, parents before their children; in Edit Mode as they are there."""
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
        # Bones have some length.
        rest=rest if (rest[0] != rest[1]).any() else None,
    )


def note_rest(obj: bpy.types.Object) -> None:
    """Note where the bones are before any joint is moved to where it belongs, unless that has been noted.

    In Edit Mode it is where they were when that was entered. Bones that were added since put an end to what was noted.
    """
    is_edited = obj.mode == "EDIT"
    bones = obj.data.edit_bones if is_edited else obj.data.bones
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
    """Let bones be as long as they are."""
    for bone in obj.data.edit_bones if obj.mode == "EDIT" else obj.data.bones:
        bone.convwass_rest = np.zeros(6)
