# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The materials of the frames of a morph that is baked again, which its user may have edited."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence, Set

import bpy

from ...edited_materials import is_edited, made_as
from ..results import bake_of
from ..stored import WEIGHTS_KEY
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
    alike, elsewhere = defaultdict(list), _of_other_morphs({*before, *after})
    for material in carried_materials(before):
        alike[made_as(material)].append(material)
    replaced = []
    for material in carried_materials(after):
        if alike[made_as(material)]:
            kept = alike[made_as(material)].pop(0)
            if kept in elsewhere and _images(kept) != _images(material):
                kept = kept.copy()
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


def _of_other_morphs(frames: Set[bpy.types.Object]) -> Set[bpy.types.Material]:
    """Return the materials of all frames but these; copies of a morph have the materials of the first one."""
    others = [obj for obj in bpy.data.objects if WEIGHTS_KEY in obj and obj not in frames and bake_of(obj) is not None]
    return set(carried_materials(others))


def _image_nodes(material: bpy.types.Material) -> list[bpy.types.ShaderNodeTexImage]:
    nodes = material.node_tree.nodes if material.node_tree else ()
    return [node for node in nodes if node.type == "TEX_IMAGE"]


def _images(material: bpy.types.Material) -> dict[str, bpy.types.Image | None]:
    """Return the images of a material by the names of their nodes."""
    return {node.name: node.image for node in _image_nodes(material)}


def _take_images(material: bpy.types.Material, other: bpy.types.Material) -> None:
    """Let a material show the pictures of another one that was made alike."""
    for node in _image_nodes(other):
        own = material.node_tree.nodes.get(node.name)
        if own is not None and own.type == node.type:
            own.image = node.image
            for name in _IMAGE_USER:
                setattr(own.image_user, name, getattr(node.image_user, name))
