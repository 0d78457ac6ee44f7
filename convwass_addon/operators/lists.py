# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists in the sidebar: keep the active item while others are removed and moved."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, IntProperty

ACTIVE = -1
"""The index that stands for the active item."""


def index_property() -> object:
    """Return the property for an index on a list."""
    return IntProperty(
        name="Index", description="Position on the list, from 0; -1 is the active item", default=ACTIVE, min=ACTIVE
    )


def direction_property() -> object:
    """Return the property for the direction in which an item moves."""
    return EnumProperty(
        name="Direction",
        description="Direction of the move",
        items=(("UP", "Up", "One position towards the start"), ("DOWN", "Down", "One position towards the end")),
    )


def taken_off(items: bpy.types.bpy_prop_collection, index: int, active: int) -> int:
    """Remove an item from its list; return the new active index."""
    items.remove(index)
    return max(active - 1, 0) if active >= index else active


def neighbor(items: bpy.types.bpy_prop_collection, index: int, direction: str) -> int | None:
    """Return the next index in a direction, or None at the end of the list."""
    target = index + (1 if direction == "DOWN" else -1)
    return target if 0 <= target < len(items) else None


def swapped(items: bpy.types.bpy_prop_collection, index: int, target: int, active: int) -> int:
    """Swap an item with its neighbor; return the new active index."""
    items.move(index, target)
    if active not in (index, target):
        return active
    return target if active == index else index
