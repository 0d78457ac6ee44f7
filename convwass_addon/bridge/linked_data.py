# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Data of other .blend files."""

from __future__ import annotations

from typing import TypeVar

import bpy

Block = TypeVar("Block", bpy.types.Collection, bpy.types.Object)


def is_linked(block: bpy.types.ID) -> bool:
    """Return whether a data-block, or the one that it overrides, is linked from another file."""
    return block.library is not None or block.override_library is not None


def overriding(block: Block, owner: bpy.types.ID) -> Block:
    """Return the library override of an object or collection that belongs together with another override.

    Blender loses it in custom properties: in a file that is opened, they refer to what is linked.

    Parameters
    ----------
    block : bpy.types.Object or bpy.types.Collection
        What a custom property refers to; returned itself if there is no such override.
    owner : bpy.types.ID
        What has the custom property.
    """
    own = owner.override_library
    if own is None or block.library is None:
        return block
    there = bpy.data.collections if isinstance(block, bpy.types.Collection) else bpy.data.objects
    overrides = ((one, one.override_library) for one in there if one.override_library is not None)
    alike = (one for one, how in overrides if how.reference == block and how.hierarchy_root == own.hierarchy_root)
    return next(alike, block)
