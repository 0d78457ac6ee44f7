# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups of morphs that were copied, as by *Duplicate Collection* and with a full copy of a scene.

Blender copies players and pads with the frames of their morph, but not their node groups, which go on reading those of
the first morph.
"""

from __future__ import annotations

from collections.abc import Mapping

import bpy

from ..linked_data import overriding
from .stand_ins import SHOWS_KEY, adopt, frames_modifier, shown_morph
from .stored import INDEX_KEY, frame_objects


def separate_copies(collection: bpy.types.Collection) -> None:
    """Give players and pads of copies of a morph, or of a morph that is a copy itself, node groups of their own.

    Required before the frames of the morph change, which others would show, too.
    """
    made: dict[tuple[bpy.types.NodeTree, bpy.types.Collection], bpy.types.NodeTree] = {}
    for obj in [obj for obj in bpy.data.objects if SHOWS_KEY in obj]:
        modifier, own = frames_modifier(obj), shown_morph(obj)
        if modifier is None or own is None:
            continue
        tree = modifier.node_group
        first = overriding(tree[SHOWS_KEY], obj)
        if first != own and collection in (first, own):
            if (tree, own) not in made:
                made[tree, own] = _copied(tree, own, _counterparts(first, own), {})
            modifier.node_group = made[tree, own]


def _counterparts(first: bpy.types.Collection, own: bpy.types.Collection) -> dict[bpy.types.Object, bpy.types.Object]:
    """Return the frames of a copied morph by those of the first one."""
    copies = {obj.get(INDEX_KEY): obj for obj in frame_objects(own)}
    frames = [obj for obj in frame_objects(first) if obj.get(INDEX_KEY) in copies]
    return {obj: copies[obj[INDEX_KEY]] for obj in frames}


def _copied(
    tree: bpy.types.NodeTree,
    own: bpy.types.Collection,
    frames: Mapping[bpy.types.Object, bpy.types.Object],
    done: dict[bpy.types.NodeTree, bpy.types.NodeTree],
) -> bpy.types.NodeTree:
    """Return a copy of a node group, with the groups in it, that reads the frames of a copied morph; `done` grows."""
    if tree in done:
        return done[tree]
    copy = done[tree] = tree.copy()
    adopt(own, [copy])
    for node in copy.nodes:
        nested = getattr(node, "node_tree", None)
        if nested is not None and SHOWS_KEY in nested:
            node.node_tree = _copied(nested, own, frames, done)
        for socket in node.inputs:
            if socket.type == "OBJECT" and socket.default_value in frames:
                socket.default_value = frames[socket.default_value]
    return copy
