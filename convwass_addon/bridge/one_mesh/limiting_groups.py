# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Replace vertex groups that limit shape keys and armatures, which glTF and FBX lack."""

from __future__ import annotations

from itertools import chain, count

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray

from ...geometry.algebra.quotients import quotients
from ..element_values import element_values, write_floats
from ..vertex_groups import group_names, read_group, read_groups, write_group

# Name of the bone that holds vertices, if it is free.
_ANCHOR = "Fixed"
# Smallest influence that is lost.
_LEAST = 1e-6


def apply_key_groups(obj: bpy.types.Object) -> None:
    """Limit the shape keys of a mesh by their vertex groups for good, so that they look the same without these."""
    reference, *keys = obj.data.shape_keys.key_blocks
    if not any(key.vertex_group in obj.vertex_groups for key in keys):
        return
    rest = element_values(reference.data, "co", 3)
    # Keys may refer to each other, so all are read before any is written.
    moves = [limited_moves(obj, key) for key in keys]
    for key, own in zip(keys, moves, strict=True):
        write_floats(key.data, "co", rest + own)
        key.relative_key, key.vertex_group = reference, ""


def limited_moves(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> NDArray[np.float32]:
    """Return how a shape key moves the vertices of an object, (n, 3), as far as its vertex group lets it."""
    moves = element_values(key.data, "co", 3) - element_values(key.relative_key.data, "co", 3)
    if key.vertex_group in obj.vertex_groups:
        moves *= read_group(obj, key.vertex_group).astype(np.float32)[:, None]
    return moves


def anchor_vertices(obj: bpy.types.Object, rig: bpy.types.Object, influences: NDArray[np.float64]) -> None:
    """Let an armature move vertices less, by weights of a new bone that stays where it is.

    Parameters
    ----------
    obj : bpy.types.Object
        The mesh, in the current view layer, as its armature, whose data only it uses.
    rig : bpy.types.Object
        The armature.
    influences : (n,) float64
        How much the armature is to move each vertex, from 0 to 1; where it is 1, weights are kept.
    """
    if (influences > 1.0 - _LEAST).all():
        return
    for group in obj.vertex_groups:
        group.lock_weight = False
    names = [name for name in group_names(obj) if name in rig.data.bones and rig.data.bones[name].use_deform]
    weights = read_groups(obj, names)
    total = weights.sum(axis=0)
    # The bones of other programs mix by their weights without dividing them by the sum in the group.
    shares = quotients(influences, total)
    for name, own in zip(names, weights, strict=True):
        write_group(obj, name, np.minimum(own * shares, 1.0))
    write_group(obj, _new_bone(obj, rig), np.where(total > 0.0, 1.0 - influences, 1.0))


def _new_bone(obj: bpy.types.Object, rig: bpy.types.Object) -> str:
    """Add a bone to an armature that does not move, and return its name, which no group has."""
    taken = {*group_names(obj), *rig.data.bones.keys()}
    name = next(own for own in chain([_ANCHOR], (f"{_ANCHOR}.{number:03d}" for number in count(1))) if own not in taken)
    # Only visible objects can be edited.
    rig.hide_viewport = False
    bpy.context.view_layer.objects.active = rig
    with bpy.context.temp_override(active_object=rig, object=rig):
        bpy.ops.object.mode_set(mode="EDIT")
        try:
            bone = rig.data.edit_bones.new(name)
            bone.tail = bone.head + Vector((0.0, 0.0, _length(rig)))
        finally:
            bpy.ops.object.mode_set(mode="OBJECT")
    return name


def _length(rig: bpy.types.Object) -> float:
    """Return a length for a new bone, which is like that of the others."""
    return min((bone.length for bone in rig.data.edit_bones if bone.length > 0.0), default=1.0)
