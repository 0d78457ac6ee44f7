# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Replace the frames of a morph by those of a new bake."""

from __future__ import annotations

import bpy

from .changes import SIGNATURES_KEY
from .disk_output import FOLDER_KEY
from .hidden_inputs import take_hidden
from .player import is_player, refresh_player
from .player_slots import changed_slots, restore_slots
from .rebuilt_pad import rebuild_pad
from .removal import remove_frames
from .stand_ins import stand_ins
from .stored import DIAGNOSTICS_KEY, MORPH_KEY, frame_objects, hidden_frames
from .written_files import WRITTEN_KEY


def replace_bake(old: bpy.types.Collection, new: bpy.types.Collection) -> bpy.types.Collection:
    """Move frames and description of a new bake to an existing morph, and remove the new collection.

    A player keeps its keys, materials and modifiers. A blend pad is rebuilt; its handle keeps its place and keys.
    Objects that read files are kept, and show the frames of the new bake once these are written.

    Parameters
    ----------
    old : bpy.types.Collection
        Keeps its name and place.
    new : bpy.types.Collection
        A newly baked morph.

    Returns
    -------
    bpy.types.Collection
        `old`.
    """
    players = {player: changed_slots(player) for player in stand_ins(old) if is_player(player)}
    remove_frames(old)
    home = hidden_frames(old) or old
    for obj in frame_objects(new):
        home.objects.link(obj)
    for key in (MORPH_KEY, DIAGNOSTICS_KEY, SIGNATURES_KEY, WRITTEN_KEY, FOLDER_KEY):
        if key in new:
            old[key] = new[key]
    take_hidden(old, new)
    bpy.data.collections.remove(new)
    if players:
        refresh_player(old)
        for player, slots in players.items():
            restore_slots(player, slots)
    elif stand_ins(old):
        rebuild_pad(old)
    return old
