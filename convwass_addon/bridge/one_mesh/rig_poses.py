# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses of armatures over time, as their constraints, drivers and animations of any kind make them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ..animation_time import returning, show_time
from ..keyframes import curves_of, interpolate, use_action
from ..objects import is_sheared

# Smallest change of a matrix that is a movement.
_LEAST = 1e-6


@dataclass(frozen=True)
class RigPoses:
    """Poses of an armature, one per frame.

    Attributes
    ----------
    places : list of Matrix
        Where the object is, in world space.
    bones : list of dict of str to Matrix
        Where each bone is, in the space of the object.
    """

    places: list[Matrix]
    bones: list[dict[str, Matrix]]

    @property
    def is_still(self) -> bool:
        """Whether nothing moves."""
        return _are_equal(self.places) and all(_are_equal(own) for own in self._of_each_bone())

    def _of_each_bone(self) -> Iterable[Sequence[Matrix]]:
        return zip(*(pose.values() for pose in self.bones), strict=True)


def rig_poses(rigs: Sequence[bpy.types.Object], frames: range) -> dict[bpy.types.Object, RigPoses]:
    """Read the poses of armatures in frames of the scene; restores its current frame.

    Parameters
    ----------
    rigs : sequence of bpy.types.Object
        Armatures that visible objects use.
    frames : range
        The frames.
    """
    scene, found = bpy.context.scene, {rig: RigPoses([], []) for rig in rigs}
    with returning(scene):
        for frame in frames:
            show_time(scene, frame)
            depsgraph = bpy.context.evaluated_depsgraph_get()
            for rig, poses in found.items():
                evaluated = rig.evaluated_get(depsgraph)
                poses.places.append(evaluated.matrix_world.copy())
                poses.bones.append({bone.name: bone.matrix.copy() for bone in evaluated.pose.bones})
    return found


def key_poses(rig: bpy.types.Object, poses: RigPoses, action: bpy.types.Action) -> None:
    """Key the poses of an armature in every frame from 0 on, in place of its animation and constraints.

    Parameters
    ----------
    rig : bpy.types.Object
        An armature without parent, or one that its parent places with a shear; then it stays in place.
    poses : RigPoses
        The poses.
    action : bpy.types.Action
        Gets the keys.
    """
    rig.animation_data_clear()
    _remove_constraints(rig)
    use_action(rig, action)
    if not any(map(is_sheared, poses.places)):
        rig.rotation_mode = "QUATERNION"
        key_matrices(rig, "matrix_world", poses.places)
    for bone in rig.pose.bones:
        _remove_constraints(bone)
        # Bones that hold vertices for other programs are in none of the poses.
        if bone.name in poses.bones[0]:
            bone.rotation_mode = "QUATERNION"
            key_matrices(bone, "matrix_basis", [_basis(bone.bone, pose) for pose in poses.bones])
    interpolate(curves_of(rig))


def _remove_constraints(block: bpy.types.Object | bpy.types.PoseBone) -> None:
    for constraint in list(block.constraints):
        block.constraints.remove(constraint)


def key_matrices(block: bpy.types.Object | bpy.types.PoseBone, name: str, matrices: Sequence[Matrix]) -> None:
    """Set a matrix of an object or a bone, which is rotated by quaternions, and key it in every frame if it changes."""
    setattr(block, name, matrices[0])
    if _are_equal(matrices):
        return
    for number, matrix in enumerate(matrices):
        before = block.rotation_quaternion.copy()
        setattr(block, name, matrix)
        block.rotation_quaternion.make_compatible(before)
        for path in ("location", "rotation_quaternion", "scale"):
            block.keyframe_insert(path, frame=number)


def _basis(bone: bpy.types.Bone, pose: dict[str, Matrix]) -> Matrix:
    """Return the transform that brings a bone to where it is in a pose."""
    if bone.parent is None:
        return bone.convert_local_to_pose(pose[bone.name], bone.matrix_local, invert=True)
    own, parent = bone.matrix_local, bone.parent
    around = {"parent_matrix": pose[parent.name], "parent_matrix_local": parent.matrix_local}
    return bone.convert_local_to_pose(pose[bone.name], own, **around, invert=True)


def _are_equal(matrices: Sequence[Matrix]) -> bool:
    return np.allclose(matrices, matrices[0], atol=_LEAST)
