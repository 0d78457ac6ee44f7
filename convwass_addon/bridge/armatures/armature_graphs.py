# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert armatures to graphs of joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.skeletons.skeleton_graph import JointGraph
from ...errors import InputError
from ...geometry.algebra.affine import transformed_points
from .joint_layout import JointLayout, joint_layout
from .rig_bones import SIDES, RigBone, bone_ends
from .rig_graphs import RigGraph, world_matrix


def armature_graph(obj: bpy.types.Object, only_deforming: bool = True) -> RigGraph:
    """Return the joint graph of an armature in rest position.

    Parameters
    ----------
    obj : bpy.types.Object
        An armature, in any mode.
    only_deforming : bool
        Skip bones that do not deform meshes, such as control handles, if there are others.

    Raises
    ------
    InputError
        The armature has no bones, a bone has no length, or a scale is zero.
    """
    bones = bone_ends(obj)
    if not bones:
        raise InputError("{object} has no bones; add some in Edit Mode.", object=obj.name)
    layout = joint_layout(bones)
    kept = layout.fitted if only_deforming else np.arange(len(bones))
    _require_length(layout, kept)
    joints, compact = np.unique(layout.joints[kept], return_inverse=True)
    new = np.full(int(layout.joints.max()) + 1, -1)
    new[joints] = np.arange(len(joints))
    edges = [*compact.reshape(-1, 2).tolist(), *_links(layout, kept, new)]
    ends = _ends_of_joints(layout, kept, new, len(joints))
    matrix = world_matrix(obj)
    state = {f"{bone.name}.{side}": bone for bone in bones for side in SIDES}
    positions, rest = (transformed_points(points[joints], matrix) for points in (layout.points(), layout.rest()))
    pinned = [any(_flag(state, end, "pinned") for end in own) for own in ends]
    return RigGraph(
        graph=JointGraph.from_arrays(positions, edges, pinned, tuple(own[0] for own in ends), rest),
        ends=ends,
        selected=np.array([any(_flag(state, end, "selected") for end in own) for own in ends]),
        matrix=matrix,
        parts=tuple(bone.name for bone in bones),
        clashes=tuple(_clashes(state, ends, layout.tolerance)),
    )


def _clashes(
    state: Mapping[str, RigBone], ends: Sequence[Sequence[str]], tolerance: float
) -> Iterator[tuple[str, str]]:
    """Yield pairs of pinned ends in one joint that were apart before joints were moved."""
    for own in ends:
        noted = [
            (end, state[end].rest[SIDES.index(end.rpartition(".")[2])])
            for end in own
            if _flag(state, end, "pinned") and state[end].rest is not None
        ]
        for end, place in noted[1:]:
            if np.linalg.norm(place - noted[0][1]) > tolerance:
                yield noted[0][0], end


def _flag(state: Mapping[str, RigBone], end: str, kind: str) -> bool:
    return getattr(state[end], kind)[SIDES.index(end.rpartition(".")[2])]


def _require_length(layout: JointLayout, kept: NDArray[np.int64]) -> None:
    """Raise InputError if a bone has no length."""
    short = [layout.bones[place].name for place in kept if layout.joints[place, 0] == layout.joints[place, 1]]
    if short:
        raise InputError(
            "The bone {name} has no length; move its tail away from its head in Edit Mode, or delete it.", name=short[0]
        )


def _links(layout: JointLayout, kept: NDArray[np.int64], new: NDArray[np.int64]) -> Iterator[tuple[int, int]]:
    """Yield an edge from the head of each unconnected bone to the nearer end of its nearest kept ancestor."""
    is_kept = set(kept.tolist())
    for place in kept:
        bone = layout.bones[place]
        parent = bone.parent
        while parent is not None and layout.places[parent] not in is_kept:
            parent = layout.bones[layout.places[parent]].parent
        if parent is None:
            continue
        number = layout.places[parent]
        head, ends = layout.joints[place, 0], layout.joints[number]
        if head not in ends:
            near = np.linalg.norm(layout.bones[number].ends - bone.ends[0], axis=1).argmin()
            yield int(new[ends[near]]), int(new[head])


def _ends_of_joints(
    layout: JointLayout, kept: NDArray[np.int64], new: NDArray[np.int64], count: int
) -> tuple[tuple[str, ...], ...]:
    """Return the bone ends at each joint, tails first: a joint is named after a bone that ends there."""
    found: list[list[str]] = [[] for _ in range(count)]
    for side in (1, 0):
        for place, bone in enumerate(layout.bones):
            joint = new[layout.joints[place, side]]
            if joint >= 0:
                found[joint].append(f"{bone.name}.{SIDES[side]}")
    is_kept = {layout.bones[place].name for place in kept}
    # Ends of skipped bones move with the joint but do not name it.
    return tuple(tuple(sorted(own, key=lambda end: end.rpartition(".")[0] not in is_kept)) for own in found)
