# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The materials of the frames of a morph that is baked again, which its user may have edited."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import bpy

from ..edited_materials import is_edited, made_as
from .materials import drop_unused_groups, is_carrying, release

_IMAGE_USER = ("frame_start", "frame_offset", "frame_duration", "use_auto_refresh", "use_cyclic")


def take_materials(before: Sequence[bpy.types.Object], after: Sequence[bpy.types.Object]) -> list[bpy.types.Material]:
    """Give the new frames of a morph the materials of its old ones where these were made alike.

    Parameters
    ----------
    before, after : sequence of bpy.types.Object
        The old and the new frames.

    Returns
    -------
    list of bpy.types.Material
        Materials of the old frames that are edited and differ from all new ones, because those of the shapes have
        changed, and those of earlier versions, which cannot be compared. They no longer belong to the morph, and have a
        fake user.
    """
    alike = defaultdict(list)
    for material in carried_materials(before):
        alike[made_as(material)].append(material)
    replaced = []
    for material in carried_materials(after):
        if alike[made_as(material)]:
            kept = alike[made_as(material)].pop(0)
            _take_images(kept, material)
            material.user_remap(kept)
            replaced.append(material)
    bpy.data.batch_remove(replaced)
    drop_unused_groups()
    edited = [material for own in alike.values() for material in own if is_edited(material)]
    for material in edited:
        release(material)
        material.use_fake_user = True
    return edited


def carried_materials(frames: Sequence[bpy.types.Object]) -> list[bpy.types.Material]:
    """Return the materials that belong to the frames of a morph."""
    used = (material for obj in frames for material in obj.data.materials if is_carrying(material))
    return list(dict.fromkeys(used))


def _take_images(material: bpy.types.Material, other: bpy.types.Material) -> None:
    """Let a material show the pictures of another one that was made alike."""
    nodes = other.node_tree.nodes if other.node_tree else ()
    for node in [node for node in nodes if node.type == "TEX_IMAGE"]:
        own = material.node_tree.nodes.get(node.name)
        if own is not None and own.type == node.type:
            own.image = node.image
            for name in _IMAGE_USER:
                setattr(own.image_user, name, getattr(node.image_user, name))
