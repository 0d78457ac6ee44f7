# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs of players in the modifier, as other modules, panels and operators read and set them."""

from __future__ import annotations

import bpy

from ....errors import InputError
from ...nodes.node_inputs import NodeInput, node_input
from ..fields.mixed_frames import DETAIL, INTERPOLATE
from ..fields.path_mixture import SPEED, VALUE
from ..stand_ins import SHOWS_KEY, frames_modifier

PLAYBACK = "Playback"
"""The modifier's input for values beyond the last shape and before the first: one of `PLAYBACKS`."""

PLAYBACKS = {"ONCE": "Once", "LOOP": "Loop", "PING_PONG": "Ping-Pong"}
"""The items of that menu in the user interface."""

OVERRIDE = "Override Material"

MATERIAL = "Material"

SAME_MOMENT = 1e-4
"""Largest difference of values that counts as the same moment, far below the step from frame to frame."""


def is_player(obj: bpy.types.Object | None) -> bool:
    """Return whether an object plays a morph."""
    if obj is None or obj.get(SHOWS_KEY) is None or frames_modifier(obj) is None:
        return False
    try:
        morph_value(obj)
    except InputError:
        return False
    return True


def morph_value(player: bpy.types.Object) -> NodeInput:
    """Return the value of a player to animate; draw it with ``layout.prop(value.owner, value.path, text="Morph")``."""
    return node_input(frames_modifier(player), VALUE)


def interpolation(player: bpy.types.Object) -> NodeInput | None:
    """Return the input of a player that enables interpolation; None if there are only baked blends."""
    try:
        return node_input(frames_modifier(player), INTERPOLATE)
    except InputError:
        return None


def can_mix(obj: bpy.types.Object) -> bool:
    """Return whether an object that shows a morph can mix its blends."""
    return frames_modifier(obj) is not None and interpolation(obj) is not None


def detail(player: bpy.types.Object) -> NodeInput | None:
    """Return the input that projects mixtures onto the baked meshes; None if there are only baked blends."""
    return None if interpolation(player) is None else node_input(frames_modifier(player), DETAIL)


def speed(player: bpy.types.Object) -> NodeInput | None:
    """Return the factor for velocities; None if there are only baked blends."""
    return None if interpolation(player) is None else node_input(frames_modifier(player), SPEED)


def override(player: bpy.types.Object) -> NodeInput:
    """Return the input of a player that makes it show a single material."""
    return node_input(frames_modifier(player), OVERRIDE)


def playback(player: bpy.types.Object) -> NodeInput:
    """Return the input of a player for values beyond the last shape and before the first."""
    return node_input(frames_modifier(player), PLAYBACK)


def playback_item(player: bpy.types.Object) -> str:
    """Return the key of `PLAYBACKS` of a player."""
    stored = playback(player).get()
    names = list(PLAYBACKS.values())
    return list(PLAYBACKS)[stored if isinstance(stored, int) else names.index(stored)]


def shown_value(value: float, item: str, last: float) -> float:
    """Map a value to the range from 0 to `last` by an item of `PLAYBACKS`."""
    if item == "ONCE" or 0.0 <= value <= last:
        return min(max(value, 0.0), last)
    return value % last if item == "LOOP" else last - abs(value % (2.0 * last) - last)


def last_value(player: bpy.types.Object) -> int:
    """Return the value of a player's last shape."""
    return round(max(vertex.co.x for vertex in player.data.vertices))
