# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove morphs or their frames from the scene."""

from __future__ import annotations

import bpy

from ...sentence import Sentence
from ..unused_data import remove_if_unused, remove_with_data
from .copied_morphs import separate_copies
from .disk.disk_output import remove_disk_outputs
from .inputs.hidden_inputs import hidden_only_by, show_again, unfound_notices
from .looks.kept_materials import carried_materials
from .looks.materials import drop_unused_groups
from .stand_ins import parents_of, remove_stand_ins
from .stored import frame_objects, release_duplicates


def remove_bake(collection: bpy.types.Collection) -> None:
    """Remove a morph with its frames; other contents of its collection move up one level."""
    remove_stand_ins(collection)
    parents = parents_of(collection)
    remove_frames(collection)
    remove_disk_outputs(collection)
    for parent in parents:
        for obj in set(collection.objects) - set(parent.objects):
            parent.objects.link(obj)
        for child in set(collection.children) - set(parent.children):
            parent.children.link(child)
    bpy.data.collections.remove(collection)


def delete_morph(collection: bpy.types.Collection) -> list[Sentence]:
    """Remove a morph with its frames, and show the shapes that it has hidden and no other morph hides.

    Returns
    -------
    list of Sentence
        What the user has to do.
    """
    hidden = hidden_only_by(collection)
    remove_bake(collection)
    show_again(hidden)
    return unfound_notices(hidden)


def remove_frames(collection: bpy.types.Collection) -> None:
    """Remove the frames of a morph that is shown by something else now."""
    separate_copies(collection)
    frames = frame_objects(collection)
    release_duplicates(collection)
    remove_frame_objects(frames)


def remove_frame_objects(frames: list[bpy.types.Object]) -> None:
    """Remove frame objects of a morph, with the materials that only they use."""
    used = carried_materials(frames)
    remove_objects(frames)
    remove_if_unused(used)
    drop_unused_groups()


def remove_objects(objects: list[bpy.types.Object]) -> None:
    """Remove frame objects, with meshes, actions and node groups that nothing else uses."""
    modifiers = [modifier for obj in objects for modifier in obj.modifiers if modifier.type == "NODES"]
    groups = [modifier.node_group for modifier in modifiers]
    remove_with_data(objects)
    remove_if_unused(groups)
