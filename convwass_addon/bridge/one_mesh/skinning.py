# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How the armatures of an object move its vertices, by linear blend skinning."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...sentence import Sentence
from ..armatures.rigs import is_posed
from ..vertex_groups import weights_one_by_one

# Vertices that the pose flattens more than this have no inverse.
_LEAST = 1e-6


def armatures(obj: bpy.types.Object) -> list[bpy.types.Modifier]:
    """Return the first modifier of an object that is a deforming armature, and others that directly follow it."""
    shown = [own for own in obj.modifiers if own.show_viewport]
    first = next((place for place, own in enumerate(shown) if deforms_by_groups(own)), len(shown))
    return list(takewhile(deforms_by_groups, shown[first:]))


def deforms_by_groups(modifier: bpy.types.Modifier) -> bool:
    """Return whether a modifier is an armature whose bones move vertex groups."""
    return modifier.type == "ARMATURE" and modifier.object is not None and modifier.use_vertex_groups


def approximation_notices(obj: bpy.types.Object, rigged: Sequence[bpy.types.Modifier]) -> list[Sentence]:
    """Return notices if posed armatures of an object do not just mix transforms of bones, each notice once."""
    posed = [modifier for modifier in rigged if is_posed(modifier.object)]
    notices = []
    if any(modifier.use_deform_preserve_volume for modifier in posed):
        notices.append(
            Sentence(
                "{name} is posed with Preserve Volume; at joints its keys are approximate. Use the rest pose.",
                {"name": obj.name},
            )
        )
    if any(_bends(obj, modifier) for modifier in posed if not modifier.use_deform_preserve_volume):
        notices.append(
            Sentence(
                "{name} is posed by bendy bones or envelopes; its keys are approximate. Use the rest pose.",
                {"name": obj.name},
            )
        )
    return notices


def _bends(obj: bpy.types.Object, modifier: bpy.types.Modifier) -> bool:
    """Return whether an armature has envelopes or bendy bones."""
    return modifier.use_bone_envelopes or any(
        bone.bbone_segments > 1 and bone.use_deform and bone.name in obj.vertex_groups
        for bone in modifier.object.data.bones
    )


def skinning(obj: bpy.types.Object, rigged: Sequence[bpy.types.Modifier], mesh: bpy.types.Mesh) -> NDArray[np.float64]:
    """Return the transform from local to world space by linear blend skinning for every vertex.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    rigged : sequence of bpy.types.Modifier
        Its armatures, as of `armatures`.
    mesh : bpy.types.Mesh
        With the vertex groups of the object.

    Returns
    -------
    (n, 4, 4) float64
        The transforms.

    Raises
    ------
    InputError
        The pose flattens parts of the mesh.
    """
    own = np.array(obj.matrix_world, dtype=np.float64)
    start = moved = np.tile(np.eye(4), (len(mesh.vertices), 1, 1))
    for modifier in rigged:
        start = start if _mixes(obj, modifier, rigged) else moved
        share = influences(obj, modifier, mesh)
        moved = share * (_bone_motions(obj, modifier, mesh) @ start) + (1.0 - share) * moved
    found = moved @ own
    if (np.linalg.svd(found[:, :3, :3], compute_uv=False)[:, -1] < _LEAST).any():
        raise InputError("The pose of {name} flattens parts of it; use the rest pose.", name=obj.name)
    return found


def _mixes(obj: bpy.types.Object, modifier: bpy.types.Modifier, rigged: Sequence[bpy.types.Modifier]) -> bool:
    """Return whether an armature starts where the one before it does, and is mixed with it."""
    place = list(obj.modifiers).index(modifier)
    return modifier.use_multi_modifier and place > 0 and obj.modifiers[place - 1] in rigged


def _bone_motions(obj: bpy.types.Object, modifier: bpy.types.Modifier, mesh: bpy.types.Mesh) -> NDArray[np.float64]:
    """Return the transform by the bones of an armature for every vertex in world space, (n, 4, 4)."""
    rig = modifier.object
    bones = {
        group.index: np.array(_bone_motion(rig, rig.pose.bones[group.name]), dtype=np.float64)
        for group in obj.vertex_groups
        if group.name in rig.pose.bones and rig.data.bones[group.name].use_deform
    }
    motions = np.tile(np.eye(4), (len(mesh.vertices), 1, 1))
    for vertex in mesh.vertices:
        weights = [(each.weight, bones[each.group]) for each in vertex.groups if each.group in bones]
        total = sum(weight for weight, _ in weights)
        if total > 0.0:
            motions[vertex.index] = sum(weight / total * motion for weight, motion in weights)
    return motions


def influences(obj: bpy.types.Object, modifier: bpy.types.Modifier, mesh: bpy.types.Mesh) -> NDArray[np.float64]:
    """Return how much an armature moves each vertex, by the group that limits its modifier, if any; (n, 1, 1)."""
    group = obj.vertex_groups.get(modifier.vertex_group)
    if group is None:
        return np.ones((len(mesh.vertices), 1, 1))
    weights = weights_one_by_one(mesh, group.index).astype(np.float64)[:, None, None]
    return 1.0 - weights if modifier.invert_vertex_group else weights


def _bone_motion(rig: bpy.types.Object, bone: bpy.types.PoseBone) -> object:
    """Return the world transform that a pose bone applies to points of the rest pose."""
    world = rig.matrix_world
    return world @ bone.matrix @ bone.bone.matrix_local.inverted() @ world.inverted()
