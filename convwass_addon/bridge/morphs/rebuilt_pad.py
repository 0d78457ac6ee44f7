# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the pad of a morph again after a new bake."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import bpy
from mathutils import Matrix, Vector

from ..keyframes import curves_of
from .blend_pad import PLACE_KEY, BlendPad, make_blend_pad, require_all_blends
from .pad_velocity import handle_velocity, key_handle_velocity
from .player import interpolation
from .stand_ins import frames_modifier, remove_stand_ins, stand_ins


@dataclass(frozen=True)
class _Place:
    """Where the handle of a pad is.

    Attributes
    ----------
    location : Vector
        Local space of the pad.
    side : float or None
        Width of the pad; None if the handle is no longer limited to it.
    keys : bpy.types.Action or None
        A copy of its animation.
    slot : str
        Identifier of its slot in the animation.
    name : str
        Name of the animation.
    """

    location: Vector
    side: float | None
    keys: bpy.types.Action | None = None
    slot: str = ""
    name: str = ""

    @classmethod
    def of(cls, handle: bpy.types.Object) -> Self:
        """Return the place of a handle."""
        location, side, data = handle.location.copy(), _side(handle), handle.animation_data
        if data is None or data.action is None or data.action_slot is None:
            return cls(location, side)
        return cls(location, side, data.action.copy(), data.action_slot.identifier, data.action.name)

    def give(self, handle: bpy.types.Object) -> None:
        """Move the handle of a new pad there, in proportion to its size; the old one must be gone."""
        ratio = _side(handle) / self.side if self.side else 1.0
        handle.location = ratio * self.location
        if self.keys is not None:
            own = handle.animation_data_create()
            own.action, own.action_slot = self.keys, self.keys.slots[self.slot]
            self.keys.name = self.name
            _scale_locations(handle, ratio)


def _side(handle: bpy.types.Object) -> float | None:
    """Return the width of the pad to which a handle is limited."""
    return next((own.max_x - own.min_x for own in handle.constraints if own.type == "LIMIT_LOCATION"), None)


def _scale_locations(handle: bpy.types.Object, ratio: float) -> None:
    """Multiply the keyed locations of a handle."""
    for curve in (own for own in curves_of(handle) if own.data_path == "location"):
        for key in curve.keyframe_points:
            # The left and right ends of its tangent are stored as positions.
            left, right = (ratio * end.y for end in (key.handle_left, key.handle_right))
            key.co.y *= ratio
            key.handle_left.y, key.handle_right.y = left, right
        curve.update()


@dataclass(frozen=True)
class _Shift:
    """How an object of a pad was moved by its user.

    Attributes
    ----------
    world : Matrix
        Its transform.
    made_at : Vector or None
        Where it was made; None if that is unknown, because an earlier version made it.
    """

    world: Matrix
    made_at: Vector | None

    @classmethod
    def of(cls, obj: bpy.types.Object) -> Self:
        """Return how an object was moved."""
        made_at = obj.get(PLACE_KEY)
        return cls(obj.matrix_world.copy(), None if made_at is None else Vector(made_at))

    def give(self, obj: bpy.types.Object) -> None:
        """Move a new object in the same way."""
        further = Vector() if self.made_at is None else obj.location - self.made_at
        obj.matrix_world = Matrix.Translation(further) @ self.world


def rebuild_pad(collection: bpy.types.Collection) -> BlendPad:
    """Build the pad of a morph from its current frames; it stays where it was moved, and its handle at its blend.

    Raises
    ------
    InputError
        The morph is no longer a sheet; the pad is kept then.
    """
    require_all_blends(collection)
    shown_by = stand_ins(collection)
    mixed = any(frames_modifier(obj) and interpolation(obj) for obj in shown_by)
    bpy.context.view_layer.update()
    place = next((_Place.of(obj) for obj in shown_by if obj.type == "EMPTY"), None)
    shift = next((_Shift.of(obj.parent) for obj in shown_by if obj.type == "EMPTY" and obj.parent), None)
    remove_stand_ins(collection)
    made = make_blend_pad(collection, between="INTERPOLATED" if mixed else "NEAREST")
    if place is not None:
        place.give(made.handle)
    if shift is not None:
        shift.give(made.pad)
    if handle_velocity(collection) is not None and any(c.data_path == "location" for c in curves_of(made.handle)):
        key_handle_velocity(collection)
    return made
