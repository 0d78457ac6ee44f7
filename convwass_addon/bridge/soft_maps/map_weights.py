# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights that come along a map: which of them deform, how many a vertex may have, and what locked groups leave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..mesh_checks import writable_mesh
from ..vertex_groups import group_names, read_groups, write_group

# Of the vertices: so many have weights of sum 1 where groups are weights of bones that nobody has named.
_MOST_OF_THEM, _SUM_TOLERANCE = 0.99, 1e-3
# Less is none: noise of interpolation.
_LEAST_WEIGHT = 1e-4
# Longest name of a vertex group, in bytes.
_LONGEST_NAME = 63


@dataclass(frozen=True)
class WeightRules:
    """How many groups a vertex may be in.

    Attributes
    ----------
    limit : int
        Most deforming groups of a vertex; 0 for any number.
    normalize : bool
        Whether the weights of deforming groups are to sum to 1.
    """

    limit: int = 4
    normalize: bool = True


def bone_names(obj: bpy.types.Object) -> set[str]:
    """Return the names of the bones that deform an object by its Armature modifiers."""
    armatures = [modifier.object for modifier in obj.modifiers if modifier.type == "ARMATURE" and modifier.object]
    return {bone.name for armature in armatures for bone in armature.data.bones if bone.use_deform}


def deforming_groups(
    giver: bpy.types.Object, receiver: bpy.types.Object, names: Sequence[str], weights: NDArray[np.float64]
) -> set[str]:
    """Return which groups of the giver are weights of bones.

    Those named after deforming bones of either object; where neither has an armature, all of them if they sum to 1
    everywhere, as weights of bones do, and otherwise none.

    Parameters
    ----------
    giver, receiver : bpy.types.Object
        Mesh objects.
    names : sequence of str
        Of all groups of the giver.
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
    rules: WeightRules,
) -> NDArray[np.float64]:
    """Return weights of deforming groups that keep to the rules, beside those that stay.

    Parameters
    ----------
    weights : (g, m) float64
        Of the groups that are written.
    total : (m,) float64
        Sum of all deforming groups that the giver has there: the written groups get their share of 1.
    fixed : (l, m) float64
        Weights of deforming groups that stay.
    rules : WeightRules
        How many groups.

    Returns
    -------
    (g, m) float64
        From 0 to 1. With more groups than allowed the largest stay, with the sum that all had.
    """
    kept, sums = np.where(weights < _LEAST_WEIGHT, 0.0, weights), weights.sum(axis=0)
    if rules.limit:
        allowed = np.maximum(rules.limit - (fixed > 0).sum(axis=0), 0)
        ranks = np.argsort(np.argsort(-kept, axis=0, kind="stable"), axis=0, kind="stable")
        kept = np.where(ranks < allowed, kept, 0.0)
    wanted = sums
    if rules.normalize:
        shares = np.divide(sums, total, out=np.zeros_like(sums), where=total > 0)
        wanted = np.minimum(shares, np.maximum(1.0 - fixed.sum(axis=0), 0.0))
    left = kept.sum(axis=0)
    scale = np.divide(wanted, left, out=np.zeros_like(left), where=left > 0)
    return np.clip(kept * scale, 0.0, 1.0)


def require_group_names(obj: bpy.types.Object, names: Sequence[str]) -> None:
    """Refuse names that groups cannot have, before anything is written; raises InputError."""
    for name in names:
        if len(name.encode()) > _LONGEST_NAME:
            raise InputError("{name} is too long for the name of a vertex group; choose a shorter one.", name=name)
    writable_mesh(obj)


def locked_groups(obj: bpy.types.Object, names: Sequence[str]) -> list[str]:
    """Return which of these groups an object has and has locked."""
    return [name for name in names if name in obj.vertex_groups and obj.vertex_groups[name].lock_weight]


def staying_weights(obj: bpy.types.Object, names: Sequence[str]) -> NDArray[np.float64]:
    """Return the weights of those of these groups that an object has, (l, n)."""
    known = [name for name in group_names(obj) if name in names]
    return read_groups(obj, known) if known else np.zeros((0, len(obj.data.vertices)))


def write_weights(
    obj: bpy.types.Object, names: Sequence[str], weights: NDArray[np.float64], found: NDArray[np.bool_]
) -> None:
    """Write groups, (g, m); vertices without an image, those not in `found`, (m,), keep the weights that they have."""
    before = {name: row for name, row in zip(names, _weights_before(obj, names), strict=True)}
    for name, row in zip(names, weights, strict=True):
        write_group(obj, name, np.where(found, row, before[name]))


def _weights_before(obj: bpy.types.Object, names: Sequence[str]) -> NDArray[np.float64]:
    before = np.zeros((len(names), len(obj.data.vertices)))
    places = [place for place, name in enumerate(names) if name in obj.vertex_groups]
    if places:
        before[places] = read_groups(obj, [names[place] for place in places])
    return before
