# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that show a morph in the place of its own objects: players and blend pads."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ...errors import InputError

SHOWS_KEY = "convwass_shows"
"""Custom property of all that stands in for a morph: the morph's collection."""


def adopt(collection: bpy.types.Collection, blocks: Iterable[bpy.types.ID]) -> None:
    """Note that data-blocks (objects, collections, node groups) stand in for a morph and go with it."""
    for block in blocks:
        block[SHOWS_KEY] = collection


def shown_morph(obj: bpy.types.Object | None) -> bpy.types.Collection | None:
    """Return the morph that an object stands in for, or None."""
    shown = None if obj is None else obj.get(SHOWS_KEY)
    return shown if isinstance(shown, bpy.types.Collection) else None


def stand_ins(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the objects that stand in for a morph."""
    return [obj for obj in bpy.data.objects if obj.get(SHOWS_KEY) == collection]


def require_none(collection: bpy.types.Collection) -> None:
    """Refuse a morph that something in a scene stands in for, since two would be seen at once.

    Raises
    ------
    InputError
        It names what stands in.
    """
    found = next((obj for obj in stand_ins(collection) if obj.users_scene), None)
    if found is not None:
        raise InputError(
            "{name} is shown by {other} already; duplicate that, or remove it first.",
            name=collection.name,
            other=found.name,
        )


def remove_stand_ins(collection: bpy.types.Collection) -> None:
    """Remove what stands in for a morph, and show its own objects again; what something else uses, too, is kept."""
    objects = stand_ins(collection)
    spare = [obj.data for obj in objects if obj.data]
    spare += [obj.animation_data.action for obj in objects if obj.animation_data and obj.animation_data.action]
    bpy.data.batch_remove(objects)
    _remove_unused(spare)
    # In this order: node groups use materials.
    for blocks in (bpy.data.node_groups, bpy.data.materials):
        _remove_unused([block for block in blocks if block.get(SHOWS_KEY) == collection])
    for other in [other for other in bpy.data.collections if other.get(SHOWS_KEY) == collection]:
        if not other.objects and not other.children:
            bpy.data.collections.remove(other)
    set_shown(collection, True)


def set_shown(collection: bpy.types.Collection, shown: bool) -> None:
    """Show or hide the objects of a morph in all viewports and renders; their own visibility is left alone."""
    collection.hide_viewport = collection.hide_render = not shown


def homes(collection: bpy.types.Collection) -> list[bpy.types.Collection]:
    """Return the collections that a morph's collection is in; the context's scene where there is none."""
    roots = [*bpy.data.collections, *(scene.collection for scene in bpy.data.scenes)]
    return [root for root in roots if collection in set(root.children)] or [bpy.context.scene.collection]


def _remove_unused(blocks: Iterable[bpy.types.ID]) -> None:
    bpy.data.batch_remove({block for block in blocks if block.users == 0})
