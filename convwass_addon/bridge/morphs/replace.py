# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Replace the frames of a morph by those of a new bake."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import TYPE_CHECKING

import bpy

from ..keyframes import take_key_times
from ..objects import take_parent
from .changes import SIGNATURES_KEY
from .copied_morphs import separate_copies
from .disk.disk_output import FOLDER_KEY
from .disk.written_files import WRITTEN_KEY
from .inputs.hidden_inputs import take_hidden
from .looks.kept_materials import take_materials
from .players.player import refresh_player
from .players.player_inputs import is_player
from .players.player_slots import changed_slots, restore_slots
from .players.rebuilt_pad import rebuild_pad
from .removal import remove_frame_objects
from .stand_ins import frames_modifier, remove_stand_ins, stand_ins
from .stored import DIAGNOSTICS_KEY, INDEX_KEY, MORPH_KEY, frame_objects, hidden_frames, release_duplicates

if TYPE_CHECKING:
    from .fields.field_sampling import SampledFields


def replace_bake(
    old: bpy.types.Collection, new: bpy.types.Collection, sampled: SampledFields | None = None
) -> list[bpy.types.Material]:
    """Move frames and description of a new bake to an existing morph, and remove the new collection.

    A player or blend pad keeps its keys, materials and modifiers. If it was deleted, the frames are shown again.
    Objects that read files are kept, and show the frames of the new bake once these are written. New frames have the
    names and parents of the old ones and replace them everywhere, such as in constraints. They are shown when the old
    ones were, wherever their keys were moved, and have their materials, with all edits, unless the materials of the
    shapes have changed.

    Parameters
    ----------
    old : bpy.types.Collection
        Keeps its name and place.
    new : bpy.types.Collection
        A newly baked morph.
    sampled : SampledFields, optional
        Fields of its frames; without them, they are sampled if a player or a pad mixes the blends.

    Returns
    -------
    list of bpy.types.Material
        Edited materials that frames no longer have; see :func:`.kept_materials.take_materials`.
    """
    separate_copies(old)
    shown_by = [obj for obj in stand_ins(old) if obj.users_collection]
    slots = {obj: changed_slots(obj) for obj in shown_by if frames_modifier(obj)}
    parent = hidden_frames(old) or old
    made = frame_objects(new)
    edited = _replace_frames(old, made)
    for obj in set(made).difference(parent.objects):
        parent.objects.link(obj)
    for key in (MORPH_KEY, DIAGNOSTICS_KEY, SIGNATURES_KEY, WRITTEN_KEY, FOLDER_KEY):
        if key in new:
            old[key] = new[key]
    take_hidden(old, new)
    bpy.data.collections.remove(new)
    if any(is_player(obj) for obj in slots):
        refresh_player(old, sampled)
    elif slots:
        rebuild_pad(old, sampled)
    elif hidden_frames(old) is not None:
        # The player or pad was deleted.
        remove_stand_ins(old)
    for obj, changed in slots.items():
        restore_slots(obj, changed)
    return edited


def _replace_frames(morph: bpy.types.Collection, made: Sequence[bpy.types.Object]) -> list[bpy.types.Material]:
    """Replace the frame objects of a morph by new ones with their names and parents, wherever they are used.

    Returns edited materials that frames no longer have.
    """
    release_duplicates(morph)
    gone, places = frame_objects(morph), {obj[INDEX_KEY]: obj for obj in made}
    # Damaged frames may lack an index.
    pairs = [(obj, places[obj[INDEX_KEY]]) for obj in gone if obj.get(INDEX_KEY) in places]
    edited = take_materials(gone, made)
    names = [_names(before, after) for before, after in pairs]
    for before, after in pairs:
        take_parent(before, after)
    # Frames of a bake that was stopped last until the next one there was.
    if len(pairs) == len(gone) == len(made):
        for before, after in pairs:
            take_key_times(before, after)
    for before, after in pairs:
        before.user_remap(after)
    remove_frame_objects(gone)
    for block, name in chain.from_iterable(names):
        block.name = name
    return edited


def _names(before: bpy.types.Object, after: bpy.types.Object) -> list[tuple[bpy.types.ID, str]]:
    """Return a new frame with its data and its action, each with the name of the one that it replaces."""
    pairs = [(before, after), (before.data, after.data), (_action(before), _action(after))]
    return [(new, old.name) for old, new in pairs if old is not None and new is not None]


def _action(obj: bpy.types.Object) -> bpy.types.Action | None:
    return obj.animation_data and obj.animation_data.action
