# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Replace the frames of a morph by those of a new bake."""

from __future__ import annotations

import bpy

from ..sequence import MODIFIER
from .blend_pad import make_blend_pad
from .changes import SIGNATURES_KEY
from .disk_output import FOLDER_KEY, remove_disk_outputs
from .hidden_inputs import take_hidden
from .player import interpolation, is_player, refresh_player
from .removal import remove_frames
from .stand_ins import remove_stand_ins, stand_ins
from .stored import DIAGNOSTICS_KEY, MORPH_KEY, frame_objects, hidden_frames
from .written_files import WRITTEN_KEY


def replace_bake(old: bpy.types.Collection, new: bpy.types.Collection) -> bpy.types.Collection:
    """Move frames and description of a new bake to an existing morph, and remove the new collection.

    A player keeps its keys, materials and modifiers. A blend pad is rebuilt. Objects that read files are removed.

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
    remove_frames(old)
    remove_disk_outputs(old)
    home = hidden_frames(old) or old
    for obj in frame_objects(new):
        home.objects.link(obj)
    for key in (MORPH_KEY, DIAGNOSTICS_KEY, SIGNATURES_KEY, WRITTEN_KEY, FOLDER_KEY):
        if key in new:
            old[key] = new[key]
    take_hidden(old, new)
    bpy.data.collections.remove(new)
    shown_by = stand_ins(old)
    if any(is_player(obj) for obj in shown_by):
        refresh_player(old)
    elif shown_by:
        mixed = any(MODIFIER in obj.modifiers and interpolation(obj) for obj in shown_by)
        remove_stand_ins(old)
        make_blend_pad(old, between="INTERPOLATED" if mixed else "NEAREST")
    return old
