# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the pad of a morph again after a new bake."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import bpy
from mathutils import Vector

from ..keyframes import curves_of
from ..sequence import MODIFIER
from .blend_pad import BlendPad, make_blend_pad
from .pad_velocity import handle_velocity, key_handle_velocity
from .player import interpolation
from .stand_ins import remove_stand_ins, stand_ins


@dataclass(frozen=True)
class _Place:
    """Where the handle of a pad is.

    Attributes
    ----------
    location : Vector
        Local space of the pad.
    keys : bpy.types.Action or None
        A copy of its animation.
    slot : str
        Identifier of its slot in the animation.
    name : str
        Name of the animation.
    """

    location: Vector
    keys: bpy.types.Action | None = None
    slot: str = ""
    name: str = ""

    @classmethod
    def of(cls, handle: bpy.types.Object) -> Self:
        """Return the place of a handle."""
        data = handle.animation_data
        if data is None or data.action is None or data.action_slot is None:
            return cls(handle.location.copy())
        return cls(handle.location.copy(), data.action.copy(), data.action_slot.identifier, data.action.name)

    def give(self, handle: bpy.types.Object) -> None:
        """Move a new handle there; the old one must be gone."""
        handle.location = self.location
        if self.keys is not None:
            own = handle.animation_data_create()
            own.action, own.action_slot = self.keys, self.keys.slots[self.slot]
            self.keys.name = self.name


def rebuild_pad(collection: bpy.types.Collection) -> BlendPad:
    """Build the pad of a morph from its current frame objects; its handle keeps its place and keys.

    Raises
    ------
    InputError
        As :func:`.blend_pad.make_blend_pad`, if the morph is no longer a sheet.
    """
    shown_by = stand_ins(collection)
    mixed = any(MODIFIER in obj.modifiers and interpolation(obj) for obj in shown_by)
    place = next((_Place.of(obj) for obj in shown_by if obj.type == "EMPTY"), None)
    remove_stand_ins(collection)
    made = make_blend_pad(collection, between="INTERPOLATED" if mixed else "NEAREST")
    if place is not None:
        place.give(made.handle)
    if handle_velocity(collection) is not None and any(c.data_path == "location" for c in curves_of(made.handle)):
        key_handle_velocity(collection)
    return made
