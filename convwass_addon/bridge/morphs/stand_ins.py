# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that show a morph instead of its frame objects: players and blend pads."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ...errors import InputError
from ..linked_data import overriding
from ..object_names import without_number
from ..unused_data import remove_if_unused, remove_with_data
from .stored import FRAMES_KEY, frame_objects, hidden_frames

SHOWS_KEY = "convwass_shows"
"""Custom property of everything that shows a morph: the morph's collection."""


FIELDS_KEY = "convwass_fields"
"""Custom property of objects from which only nodes read: the hidden collection in which they are."""


def adopt(collection: bpy.types.Collection, blocks: Iterable[bpy.types.ID]) -> None:
    """Mark data-blocks (objects, collections, node groups) that show a morph and are removed with it."""
    for block in blocks:
        block[SHOWS_KEY] = collection


def marked_by(collection: bpy.types.Collection, blocks: Iterable[bpy.types.ID]) -> list[bpy.types.ID]:
    """Return which data-blocks are marked to show a morph; see `adopt`."""
    return [block for block in blocks if block.get(SHOWS_KEY) == collection]


def adopted(collection: bpy.types.Collection) -> list[bpy.types.ID]:
    """Return the node groups, the objects, their data and their hidden collections that show a morph."""
    read = _read_by_nodes(collection)
    objects = [*stand_ins(collection), *read]
    homes = dict.fromkeys(obj[FIELDS_KEY] for obj in read)
    return [*marked_by(collection, bpy.data.node_groups), *objects, *(obj.data for obj in objects if obj.data), *homes]


def drop_numbers(blocks: Iterable[bpy.types.ID]) -> None:
    """Remove the numbers that Blender has appended to names, because others had these names until now."""
    for block in blocks:
        block.name = without_number(block.name)


def shown_morph(obj: bpy.types.Object | None) -> bpy.types.Collection | None:
    """Return the morph that an object shows, or None."""
    shown = None if obj is None or _was_converted(obj) else obj.get(SHOWS_KEY)
    return overriding(shown, obj) if isinstance(shown, bpy.types.Collection) else None


def stand_ins(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the objects that show a morph, but not meshes to which its user has converted them."""
    # Panels ask this, and of many objects few show a morph.
    marked = [obj for obj in bpy.data.objects if SHOWS_KEY in obj and FIELDS_KEY not in obj]
    return [obj for obj in marked if shown_morph(obj) == collection]


def hide_fields(name: str, objects: Iterable[bpy.types.Object]) -> None:
    """Put objects from which only nodes read into a hidden collection that is in no scene.

    Blender shows appended objects that are in no collection.
    """
    home = bpy.data.collections.new(name)
    home.hide_viewport = home.hide_render = True
    for obj in objects:
        home.objects.link(obj)
        obj[FIELDS_KEY] = home


def _read_by_nodes(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Return the objects from which only nodes that show a morph read."""
    return [obj for obj in bpy.data.objects if FIELDS_KEY in obj and obj.get(SHOWS_KEY) == collection]


def frames_modifier(obj: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """Return the modifier with which an object shows the frames of a morph, whatever its name; None without one."""
    groups = ((modifier, modifier.node_group) for modifier in obj.modifiers if modifier.type == "NODES")
    return next((own for own, group in groups if group is not None and group.get(SHOWS_KEY) is not None), None)


def _was_converted(obj: bpy.types.Object) -> bool:
    """Return whether an object has a mesh of its own in place of the modifier that shows frames.

    Blender keeps the custom properties of objects that it converts. The meshes of objects that show a morph are tables
    and lines, without faces.
    """
    return obj.type == "MESH" and len(obj.data.polygons) > 0 and frames_modifier(obj) is None


def require_none(collection: bpy.types.Collection) -> None:
    """Check that no object in a scene already shows a morph, since both would be visible.

    Raises
    ------
    InputError
        Names the object.
    """
    shown = [obj for obj in stand_ins(collection) if obj.users_scene]
    if shown:
        # What can be seen in renders, rather than the labels of a pad.
        found = min(shown, key=lambda obj: obj.hide_render)
        raise InputError(
            "{name} is already shown by {other}; duplicate that, or remove it first.",
            name=collection.name,
            other=found.name,
        )


def require_no_pad(collection: bpy.types.Collection) -> None:
    """Check that no pad shows a morph, since files cannot contain what follows its handle.

    Raises
    ------
    InputError
        Names the pad.
    """
    handle = next((obj for obj in stand_ins(collection) if obj.users_scene and obj.type == "EMPTY"), None)
    if handle is not None:
        raise InputError(
            "{name} is shown by a pad with the handle {handle}, which files cannot contain; to write its blends, press "
            "Back to Baked Objects first.",
            name=collection.name,
            handle=handle.name,
        )


def remove_stand_ins(collection: bpy.types.Collection) -> None:
    """Remove the objects that show a morph, and show its frame objects again; data with other users is kept."""
    remove_with_data(stand_ins(collection))
    remove_unused(collection)
    for other in marked_by(collection, bpy.data.collections):
        if not other.objects and not other.children:
            bpy.data.collections.remove(other)
    show_frames(collection)


def remove_unused(collection: bpy.types.Collection) -> None:
    """Remove unused node groups and materials that were created to show a morph, and objects that only they read."""
    # Groups use other groups, so nested ones need several passes.
    count = None
    while count != len(groups := marked_by(collection, bpy.data.node_groups)):
        count = len(groups)
        _remove_unused_assets(groups)
    _remove_unread(_read_by_nodes(collection))
    _remove_unused_assets(marked_by(collection, bpy.data.materials))


def hide_frames(collection: bpy.types.Collection) -> None:
    """Hide the frame objects of a morph in all viewports and renders, without changing their own visibility.

    They are moved to a subcollection of the morph, so that the morph can be linked or appended with its player.
    """
    hidden = hidden_frames(collection) or _made_hidden(collection)
    _move(frame_objects(collection), collection, hidden)


def show_frames(collection: bpy.types.Collection) -> None:
    """Show the frame objects of a morph again, as far as their own visibility allows."""
    # Earlier versions hid the collection itself.
    collection.hide_viewport = collection.hide_render = False
    hidden = hidden_frames(collection)
    if hidden is not None:
        _move(list(hidden.objects), hidden, collection)
        bpy.data.collections.remove(hidden)


def shows_frames(collection: bpy.types.Collection) -> bool:
    """Return whether the frame objects of a morph are shown."""
    return hidden_frames(collection) is None and not (collection.hide_viewport or collection.hide_render)


def collections_for_stand_ins(collection: bpy.types.Collection) -> list[bpy.types.Collection]:
    """Return the collections for objects that show a morph: its own, or the scene's if that is in no scene."""
    return [collection] if parents_of(collection) else [bpy.context.scene.collection]


def parents_of(collection: bpy.types.Collection) -> list[bpy.types.Collection]:
    """Return the collections that a collection is in, including those of scenes."""
    roots = [*bpy.data.collections, *(scene.collection for scene in bpy.data.scenes)]
    return [root for root in roots if collection in set(root.children)]


def _made_hidden(collection: bpy.types.Collection) -> bpy.types.Collection:
    hidden = bpy.data.collections.new(f"{collection.name} Frames")
    hidden[FRAMES_KEY] = collection
    hidden.hide_viewport = hidden.hide_render = True
    collection.children.link(hidden)
    return hidden


def _move(objects: Iterable[bpy.types.Object], source: bpy.types.Collection, target: bpy.types.Collection) -> None:
    for obj in objects:
        if obj.name in source.objects:
            source.objects.unlink(obj)
        if obj.name not in target.objects:
            target.objects.link(obj)


def _remove_unread(objects: Iterable[bpy.types.Object]) -> None:
    """Remove objects from which no nodes read any more, and their hidden collections."""
    unread = [obj for obj in objects if obj.users == len(obj.users_collection)]
    homes = dict.fromkeys(obj[FIELDS_KEY] for obj in unread)
    remove_with_data(unread)
    bpy.data.batch_remove([home for home in homes if not home.objects])


def _remove_unused_assets(blocks: Iterable[bpy.types.ID]) -> None:
    blocks = list(blocks)
    for block in blocks:
        # Being an asset counts as a user.
        if block.asset_data is not None and block.users == 1:
            block.asset_clear()
    remove_if_unused(blocks)
