# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures as joints and the lines between them, and joints that were moved as bones again.

Bones meet in joints: a connected bone begins in its parent's tail, and ends of bones that lie on each other are one
joint as well. A bone that is not connected hangs on the nearer end of its parent.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ...applications.skeletons.skeleton_graph import JointGraph
from ...errors import InputError
from .rig_graphs import RigGraph, world_matrix

SIDES = ("head", "tail")
"""The two ends of a bone, as they are written behind its name."""

# Shares of the armature's extent: ends that are nearer to each other are one joint, and bones are never made shorter.
_SAME, _SHORTEST = 1e-5, 1e-4


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


@dataclass(frozen=True)
class _Layout:
    """Which ends of bones are one joint.

    Attributes
    ----------
    bones : sequence of RigBone
        All of them, parents before their children.
    joints : (b, 2) int
        The joints of each bone's head and tail.
    extent : float
        Diagonal of the box around all ends.
    """

    bones: Sequence[RigBone]
    joints: NDArray[np.int64]
    extent: float

    @cached_property
    def places(self) -> dict[str, int]:
        """The number of each bone by its name."""
        return {bone.name: place for place, bone in enumerate(self.bones)}

    @cached_property
    def fitted(self) -> NDArray[np.int64]:
        """Numbers of the bones that are fitted, (f,): those that deform meshes, or all where none does."""
        deforming = [place for place, bone in enumerate(self.bones) if bone.is_deforming]
        return np.array(deforming or range(len(self.bones)), dtype=np.int64)

    def points(self) -> NDArray[np.float64]:
        """Where the joints are, (j, 3)."""
        return self._of_joints([bone.ends for bone in self.bones])

    def rest(self) -> NDArray[np.float64]:
        """Where they were before any was pinned elsewhere, (j, 3); where they are, if there are bones that were not."""
        noted = [bone.rest for bone in self.bones]
        return self.points() if any(ends is None for ends in noted) else self._of_joints(noted)

    def _of_joints(self, ends: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        found = np.empty((int(self.joints.max(initial=-1)) + 1, 3))
        # Where ends lie on each other but for rounding, those of parents count.
        for joints, own in reversed([*zip(self.joints, ends, strict=True)]):
            found[joints[::-1]] = own[::-1]
        return found


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


def armature_graph(obj: bpy.types.Object, only_deforming: bool = True) -> RigGraph:
    """Return the joints of an armature as it stands in the scene, at rest.

    Parameters
    ----------
    obj : bpy.types.Object
        An armature, in any mode.
    only_deforming : bool
        Leave out bones that deform no mesh, such as handles of controls, if there are others.

    Raises
    ------
    InputError
        No bones, bones without length, or a scale of zero.
    """
    bones = bone_ends(obj)
    if not bones:
        raise InputError("{object} has no bones; add some in Edit Mode.", object=obj.name)
    layout = _layout(bones)
    kept = layout.fitted if only_deforming else np.arange(len(bones))
    _require_length(layout, kept)
    joints, compact = np.unique(layout.joints[kept], return_inverse=True)
    new = np.full(int(layout.joints.max()) + 1, -1)
    new[joints] = np.arange(len(joints))
    edges = [*compact.reshape(-1, 2).tolist(), *_links(layout, kept, new)]
    ends = _ends_of_joints(layout, kept, new, len(joints))
    matrix = world_matrix(obj)
    state = {f"{bone.name}.{side}": bone for bone in bones for side in SIDES}
    positions, rest = (points[joints] @ matrix[:3, :3].T + matrix[:3, 3] for points in (layout.points(), layout.rest()))
    pinned = [any(_flag(state, end, "pinned") for end in own) for own in ends]
    return RigGraph(
        graph=JointGraph.from_arrays(positions, edges, pinned, tuple(own[0] for own in ends), rest),
        ends=ends,
        selected=np.array([any(_flag(state, end, "selected") for end in own) for own in ends]),
        matrix=matrix,
        parts=tuple(bone.name for bone in bones),
        clashes=tuple(_clashes(state, ends, _SAME * layout.extent)),
    )


def _clashes(
    state: Mapping[str, RigBone], ends: Sequence[Sequence[str]], tolerance: float
) -> Iterator[tuple[str, str]]:
    """Yield pinned ends in one joint that were apart before joints were moved."""
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


def _layout(bones: Sequence[RigBone]) -> _Layout:
    """Find which ends of bones are one joint."""
    points = np.concatenate([bone.ends for bone in bones])
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    pairs = cKDTree(points).query_pairs(_SAME * extent, output_type="ndarray").reshape(-1, 2)
    places = {bone.name: place for place, bone in enumerate(bones)}
    joined = [(2 * places[bone.parent] + 1, 2 * place) for place, bone in enumerate(bones) if bone.is_connected]
    first, second = np.concatenate([pairs, np.array(joined, dtype=np.int64).reshape(-1, 2)]).T
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(len(points), len(points)))
    _, labels = connected_components(graph, directed=False)
    # Numbered in the order in which bones come upon them.
    _, firsts, inverse = np.unique(labels, return_index=True, return_inverse=True)
    order = np.empty(len(firsts), dtype=np.int64)
    order[np.argsort(firsts)] = np.arange(len(firsts))
    return _Layout(bones, order[inverse].reshape(-1, 2), extent)


def _require_length(layout: _Layout, kept: NDArray[np.int64]) -> None:
    """Refuse bones that are points; raises InputError."""
    short = [layout.bones[place].name for place in kept if layout.joints[place, 0] == layout.joints[place, 1]]
    if short:
        raise InputError(
            "The bone {name} has no length; move its tail away from its head in Edit Mode, or delete it.", name=short[0]
        )


def _links(layout: _Layout, kept: NDArray[np.int64], new: NDArray[np.int64]) -> Iterator[tuple[int, int]]:
    """Yield a line from each bone that is not connected to the nearer end of the nearest ancestor that is kept."""
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
    layout: _Layout, kept: NDArray[np.int64], new: NDArray[np.int64], count: int
) -> tuple[tuple[str, ...], ...]:
    """Return the ends of bones in each joint, tails first: a joint is called after the bone that ends there."""
    found: list[list[str]] = [[] for _ in range(count)]
    for side in (1, 0):
        for place, bone in enumerate(layout.bones):
            joint = new[layout.joints[place, side]]
            if joint >= 0:
                found[joint].append(f"{bone.name}.{SIDES[side]}")
    is_kept = {layout.bones[place].name for place in kept}
    # Those of bones that are left out move along, but give no names.
    return tuple(tuple(sorted(own, key=lambda end: end.rpartition(".")[0] not in is_kept)) for own in found)


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


def move_armature_joints(obj: bpy.types.Object, rig: RigGraph, positions: NDArray[np.float64]) -> list[str]:
    """Move the joints of an armature.

    Bones keep their names, parents, connections and settings, and turn the shortest way, their roll with them. Bones
    that were left out of the graph go along with what they begin in, or with the nearest joint.

    Parameters
    ----------
    obj : bpy.types.Object
        The armature, in any mode; it is the same afterwards.
    rig : RigGraph
        Its joints as they were read.
    positions : (v, 3)
        Where they belong, world space.

    Returns
    -------
    list of str
        Bones whose two joints came to lie in one place, and which were left a little length.

    Raises
    ------
    InputError
        There are other bones than when the joints were read.
    """
    inverse = np.linalg.inv(rig.matrix)
    local = positions @ inverse[:3, :3].T + inverse[:3, 3]
    with edited_bones(obj) as bones:
        present = bone_ends(obj)
        if sorted(bone.name for bone in present) != sorted(rig.parts):
            raise InputError("{object} has other bones than when the work on it began; start again.", object=obj.name)
        layout = _layout(present)
        ends = _moved_ends(layout, rig, local)
        short = _lengthen(
            layout, ends, {end for own, pin in zip(rig.ends, rig.graph.pinned, strict=True) if pin for end in own}
        )
        _write_ends(bones, {bone.name: ends[place] for place, bone in enumerate(present)})
    return short


def _moved_ends(layout: _Layout, rig: RigGraph, local: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where the ends of all bones belong, (b, 2, 3)."""
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


def _lengthen(layout: _Layout, ends: NDArray[np.float64], pinned: set[str]) -> list[str]:
    """Give bones that have become points a little length, which Blender asks for; return their names."""
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
def edited_bones(obj: bpy.types.Object) -> Iterator[bpy.types.ArmatureEditBones]:
    """Give the bones of an armature in Edit Mode, without its mirror; modes are as before afterwards."""
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
