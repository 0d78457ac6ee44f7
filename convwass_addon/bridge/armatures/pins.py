# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pins of rigs: joints that fitting does not move. Fast enough for panels."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import bmesh
import bpy
import numpy as np
from bpy.props import BoolVectorProperty, FloatVectorProperty
from numpy.typing import NDArray

from ...errors import InputError
from .rig_bones import SIDES, current_bones, forget_rest, note_rest

if TYPE_CHECKING:
    from .rig_graphs import RigGraph

KINDS = ("ARMATURE", "MESH")
"""Object types of rigs."""

PINNED = "Pinned"
"""Attribute of the pinned vertices of a mesh of edges."""


def register_pins() -> None:
    """Add pin properties to bones, which are saved with them, and survive renaming, undo and editing."""
    for kind in (bpy.types.Bone, bpy.types.EditBone):
        kind.convwass_pinned = BoolVectorProperty(
            name="Pinned", description="Whether fitting keeps the positions of head and tail", size=2
        )
        kind.convwass_rest = FloatVectorProperty(
            name="Rest", description="Head and tail at the time when a joint of the armature was first pinned", size=6
        )


def unregister_pins() -> None:
    """Remove the properties; values stored in files are kept."""
    for kind in (bpy.types.Bone, bpy.types.EditBone):
        del kind.convwass_pinned, kind.convwass_rest


@contextmanager
def with_pins() -> Iterator[None]:
    """Register the properties temporarily if the add-on is not registered."""
    if hasattr(bpy.types.Bone, "convwass_pinned"):
        yield
        return
    register_pins()
    try:
        yield
    finally:
        unregister_pins()


def pin_joints(obj: bpy.types.Object, rig: RigGraph, joints: Iterable[int]) -> None:
    """Pin joints of a rig at their positions; bones keep the lengths that they had before the first pin."""
    if obj.type == "ARMATURE":
        note_rest(obj)
    _set_pins(obj, rig, joints, True)


def unpin_joints(obj: bpy.types.Object, rig: RigGraph, joints: Iterable[int]) -> None:
    """Unpin joints of a rig."""
    _set_pins(obj, rig, joints, False)


def _set_pins(obj: bpy.types.Object, rig: RigGraph, joints: Iterable[int], pinned: bool) -> None:
    chosen = [rig.ends[joint] for joint in joints]
    if obj.type != "ARMATURE":
        pin_vertices(obj, [int(own[0]) for own in chosen], pinned)
        return
    bones = current_bones(obj)
    for own in chosen:
        for end in own:
            _pin_end(bones, end, pinned and end == own[0])


def _pin_end(bones: bpy.types.bpy_prop_collection, end: str, pinned: bool) -> None:
    # Only the end that the joint is named after is pinned, so that every pin is unique.
    name, _, side = end.rpartition(".")
    flags = list(bones[name].convwass_pinned)
    if flags[SIDES.index(side)] != pinned:
        flags[SIDES.index(side)] = pinned
        bones[name].convwass_pinned = flags


def clear_pins(obj: bpy.types.Object) -> None:
    """Unpin all joints of a rig; the current lengths of its bones become the original ones."""
    if obj.type == "ARMATURE":
        forget_rest(obj)
        for end in pinned_ends(obj):
            _pin_end(current_bones(obj), end, False)
        return
    pin_vertices(obj, list(range(len(obj.data.vertices))), False)


def pinned_ends(obj: bpy.types.Object) -> list[str]:
    """Return the names of the pinned joints. Fast enough for a panel."""
    if obj.type == "ARMATURE":
        return [
            f"{bone.name}.{side}"
            for bone in current_bones(obj)
            for side, pinned in zip(SIDES, bone.convwass_pinned, strict=True)
            if pinned
        ]
    return [str(vertex) for vertex in np.flatnonzero(pinned_vertices(obj.data))]


def pin_vertices(obj: bpy.types.Object, vertices: list[int], pinned: bool) -> None:
    """Pin or unpin vertices of a mesh, in any mode.

    Raises
    ------
    InputError
        Another attribute has the same name.
    """
    mesh = obj.data
    _require_own(mesh)
    if mesh.is_editmode:
        edited = bmesh.from_edit_mesh(mesh)
        edited.verts.ensure_lookup_table()
        layer = edited.verts.layers.bool.get(PINNED) or edited.verts.layers.bool.new(PINNED)
        edited.verts.ensure_lookup_table()
        for vertex in vertices:
            edited.verts[vertex][layer] = pinned
        bmesh.update_edit_mesh(mesh)
        return
    values = pinned_vertices(mesh)
    values[vertices] = pinned
    attribute = mesh.attributes.get(PINNED) or mesh.attributes.new(PINNED, "BOOLEAN", "POINT")
    attribute.data.foreach_set("value", values)


def pinned_vertices(mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    """Return which vertices of a mesh are pinned, (n,), including changes in Edit Mode."""
    if mesh.is_editmode:
        edited = bmesh.from_edit_mesh(mesh)
        layer = edited.verts.layers.bool.get(PINNED)
        return np.array([layer is not None and vertex[layer] for vertex in edited.verts], dtype=bool)
    values = np.zeros(len(mesh.vertices), dtype=bool)
    attribute = mesh.attributes.get(PINNED)
    # The user may have an attribute of the same name.
    if attribute is not None and (attribute.data_type, attribute.domain) == ("BOOLEAN", "POINT"):
        attribute.data.foreach_get("value", values)
    return values


def _require_own(mesh: bpy.types.Mesh) -> None:
    attribute = mesh.attributes.get(PINNED)
    if attribute is not None and (attribute.data_type, attribute.domain) != ("BOOLEAN", "POINT"):
        raise InputError(
            "An attribute named {name} already exists but does not hold pinned joints; rename it first.", name=PINNED
        )
