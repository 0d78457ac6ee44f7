# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove the objects of live morphs, including those that undo brings back after a live morph has ended."""

from __future__ import annotations

import bpy

from ..handles import Handle, found
from ..unused_data import remove_if_unused
from ..visibility import layers_with
from .running import running_live

LIVE_KEY = "convwass_live"
"""Custom property of the collection of a live morph: session ids of the inputs that it has hidden, one per line.

Its material has the property, too.
"""


def remove_leftovers() -> None:
    """Remove ended live morphs that undo has restored, and show their inputs."""
    for live in [own for own in bpy.data.collections if LIVE_KEY in own]:
        scenes = [scene for scene in bpy.data.scenes if live in scene.collection.children_recursive]
        # Earlier versions stored names.
        uids = [int(line) for line in str(live[LIVE_KEY]).splitlines() if line.isascii() and line.isdigit()]
        for obj in found([Handle("objects", uid) for uid in uids]):
            for layer in layers_with(obj, scenes):
                obj.hide_set(False, view_layer=layer)
        remove_live_objects(live)


def remove_live_objects(live: bpy.types.Collection | None) -> None:
    """Remove the collection of a live morph with all its objects, their data and their material."""
    if live is None:
        return
    objects = list(live.objects)
    data = [obj.data for obj in objects if obj.data is not None]
    slots = {slot for block in data for slot in block.materials if slot is not None}
    materials = [material for material in slots if LIVE_KEY in material]
    bpy.data.batch_remove([*objects, live])
    for blocks in (data, materials):
        remove_if_unused(blocks)


def watch_undo() -> None:
    """Remove what undo and redo bring back from now on, until another file is opened.

    Blender keeps the undo steps of a live morph after its end, and drops them and this handler with the file.
    """
    for handlers in _handlers():
        if _after_undo not in handlers:
            handlers.append(_after_undo)


def ignore_undo() -> None:
    """Stop what `watch_undo` has started."""
    for handlers in _handlers():
        if _after_undo in handlers:
            handlers.remove(_after_undo)


def _handlers() -> tuple[list[object], ...]:
    return bpy.app.handlers.undo_post, bpy.app.handlers.redo_post


def _after_undo(*_: object) -> None:
    if running_live() is None:
        remove_leftovers()
