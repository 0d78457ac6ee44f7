# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights transferred along a map: which of them deform, how many per vertex, and the room left by locked groups."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.algebra.quotients import quotients
from ..mesh_checks import writable_mesh
from ..vertex_groups import group_names, read_groups, write_group
from .soft_map_requests import TransferRequest

# If no armature names the groups, they are weights of bones if this fraction of the vertices has a weight sum of 1.
_MOST_OF_THEM, _SUM_TOLERANCE = 0.99, 1e-3
# Smaller weights are noise of the interpolation.
_LEAST_WEIGHT = 1e-4
# Maximum length of the name of a vertex group, in bytes.
_LONGEST_NAME = 63


def bone_names(obj: bpy.types.Object) -> set[str]:
    """Return the names of the bones that deform an object through Armature modifiers."""
    armatures = [modifier.object for modifier in obj.modifiers if modifier.type == "ARMATURE" and modifier.object]
    return {bone.name for armature in armatures for bone in armature.data.bones if bone.use_deform}


def deforming_groups(
    giver: bpy.types.Object, receiver: bpy.types.Object, names: Sequence[str], weights: NDArray[np.float64]
) -> set[str]:
    """Return which groups of the giver are weights of bones.

    These are groups named after deforming bones of either object. If neither object has an armature, all groups are
    weights of bones if they sum to 1 everywhere; otherwise none is.

    Parameters
    ----------
    giver, receiver : bpy.types.Object
        Mesh objects.
    names : sequence of str
        All groups of the giver.
    weights : (g, n) float64
        Their weights.
    """
    bones = bone_names(giver) | bone_names(receiver)
    if bones:
        return bones & set(names)
    sums = weights.sum(axis=0)
    is_whole = len(names) > 0 and (np.abs(sums - 1.0) < _SUM_TOLERANCE).mean() >= _MOST_OF_THEM
    return set(names) if is_whole else set()


def fitted_weights(
    weights: NDArray[np.float64],
    total: NDArray[np.float64],
    fixed: NDArray[np.float64],
    request: TransferRequest,
) -> NDArray[np.float64]:
    """Return weights of deforming groups within the limits, next to weights that are kept.

    Parameters
    ----------
    weights : (g, m) float64
        Weights of the groups to be written.
    total : (m,) float64
        Sum of all deforming groups of the giver at each vertex; the written groups get their share of 1.
    fixed : (l, m) float64
        Weights of the deforming groups that are kept.
    request : TransferRequest
        The limit per vertex, and whether weights must sum to 1.

    Returns
    -------
    (g, m) float64
        From 0 to 1. If there are too many groups, the largest ones get the weights of all.
    """
    kept, sums = np.where(weights < _LEAST_WEIGHT, 0.0, weights), weights.sum(axis=0)
    if request.limit:
        allowed = np.maximum(request.limit - (fixed > 0).sum(axis=0), 0)
        ranks = np.argsort(np.argsort(-kept, axis=0, kind="stable"), axis=0, kind="stable")
        kept = np.where(ranks < allowed, kept, 0.0)
    wanted = sums
    if request.normalize:
        shares = quotients(sums, total)
        wanted = np.minimum(shares, np.maximum(1.0 - fixed.sum(axis=0), 0.0))
    left = kept.sum(axis=0)
    scale = quotients(wanted, left)
    return np.clip(kept * scale, 0.0, 1.0)


def require_group_names(obj: bpy.types.Object, names: Sequence[str]) -> None:
    """Raise InputError if names are invalid for groups, before anything is written."""
    for name in names:
        if len(name.encode()) > _LONGEST_NAME:
            raise InputError("{name} is too long for the name of a vertex group; choose a shorter one.", name=name)
    writable_mesh(obj)


def locked_groups(obj: bpy.types.Object, names: Sequence[str]) -> list[str]:
    """Return which of these groups an object has locked."""
    return [name for name in names if name in obj.vertex_groups and obj.vertex_groups[name].lock_weight]


def staying_weights(obj: bpy.types.Object, names: Sequence[str]) -> NDArray[np.float64]:
    """Return the weights of those of these groups that an object has, (l, n)."""
    known = [name for name in group_names(obj) if name in names]
    return read_groups(obj, known) if known else np.zeros((0, len(obj.data.vertices)))


def write_weights(
    obj: bpy.types.Object, names: Sequence[str], weights: NDArray[np.float64], found: NDArray[np.bool_]
) -> None:
    """Write groups, (g, m); vertices without an image, those not in `found`, (m,), keep their weights."""
    before = {name: row for name, row in zip(names, _weights_before(obj, names), strict=True)}
    for name, row in zip(names, weights, strict=True):
        write_group(obj, name, np.where(found, row, before[name]))


def _weights_before(obj: bpy.types.Object, names: Sequence[str]) -> NDArray[np.float64]:
    before = np.zeros((len(names), len(obj.data.vertices)))
    places = [place for place, name in enumerate(names) if name in obj.vertex_groups]
    if places:
        before[places] = read_groups(obj, [names[place] for place in places])
    return before
