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


def _across(_own: bpy.types.PropertyGroup) -> float:
    session = running_live()
    return 0.0 if session is None else session.place[0]


def _up(_own: bpy.types.PropertyGroup) -> float:
    session = running_live()
    return 0.0 if session is None else session.place[1]


def _set_across(_own: bpy.types.PropertyGroup, value: float) -> None:
    session = running_live()
    if session is not None:
        session.move_to(value, session.place[1])


def _set_up(_own: bpy.types.PropertyGroup, value: float) -> None:
    session = running_live()
    if session is not None:
        session.move_to(session.place[0], value)


class CONVWASS_PG_live_handle(bpy.types.PropertyGroup):
    """The handle of the live morph that is running."""

    morph: FloatProperty(
        name="Morph",
        description="Blend to show: 0 is the first shape, 1 the second",
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        get=_across,
        set=_set_across,
    )
    across: FloatProperty(
        name="Across",
        description="Position of the handle on the pad, from left to right",
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        get=_across,
        set=_set_across,
    )
    up: FloatProperty(
        name="Up",
        description="Position of the handle on the pad, from bottom to top",
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        get=_up,
        set=_set_up,
    )


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
