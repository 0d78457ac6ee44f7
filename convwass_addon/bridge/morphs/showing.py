# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The object with which a morph is handled."""

from __future__ import annotations

import bpy

from .disk.disk_output import disk_outputs
from .players.player_inputs import is_player
from .stand_ins import stand_ins
from .stored import frame_objects


def main_object(morph: bpy.types.Collection) -> bpy.types.Object | None:
    """Return the player of a morph, the handle of its pad, the mesh that reads its files, or else its first frame."""
    shown_by = [obj for obj in stand_ins(morph) if obj.users_scene]
    players = [obj for obj in shown_by if is_player(obj)]
    handles = [obj for obj in shown_by if obj.type == "EMPTY"]
    readers = [obj for obj in disk_outputs(morph) if obj.type == "MESH"]
    return next(iter([*players, *handles, *readers, *frame_objects(morph)]), None)
