# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of live morphs in a scene, and the position of the handle of the running one."""

from __future__ import annotations

import bpy
from bpy.props import FloatProperty

from ..applications.live.live_settings import LiveSettings
from ..bridge.live.leftovers import ignore_undo
from ..bridge.live.running import running_live, set_running
from .from_schema import values_of, with_properties
from .registration import registration


@with_properties(LiveSettings)
class LiveProperties:
    """Properties of a live morph, mixed into the scene's settings and the operator."""

    def live_settings(self) -> LiveSettings:
        """Return the settings."""
        return LiveSettings(**values_of(self, LiveSettings))


class CONVWASS_PG_live(LiveProperties, bpy.types.PropertyGroup):
    """Settings of live morphs in a scene."""


def _coordinate(axis: int, name: str, description: str) -> object:
    """Return the property for one coordinate of the handle."""

    def read(_own: bpy.types.PropertyGroup) -> float:
        session = running_live()
        return 0.0 if session is None else session.place[axis]

    def move(_own: bpy.types.PropertyGroup, value: float) -> None:
        session = running_live()
        if session is not None:
            place = list(session.place)
            place[axis] = value
            session.move_to(*place)

    return FloatProperty(name=name, description=description, min=0.0, max=1.0, subtype="FACTOR", get=read, set=move)


class CONVWASS_PG_live_handle(bpy.types.PropertyGroup):
    """The handle of the live morph that is running."""

    morph: _coordinate(0, "Morph", "Blend to show: 0 is the first shape, 1 the second")
    across: _coordinate(0, "Across", "Position of the handle on the pad, from left to right")
    up: _coordinate(1, "Up", "Position of the handle on the pad, from bottom to top")


register, _unregister = registration(
    (CONVWASS_PG_live, CONVWASS_PG_live_handle),
    (
        (bpy.types.Scene, "convwass_live", CONVWASS_PG_live),
        (bpy.types.WindowManager, "convwass_live", CONVWASS_PG_live_handle),
    ),
)


def unregister() -> None:
    """Remove the properties."""
    ignore_undo()
    set_running(None)
    _unregister()
