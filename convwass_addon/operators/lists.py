# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists in the sidebar of which one item is active: it stays so while others are taken off and moved."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, IntProperty

ACTIVE = -1
"""Place on a list that means the active one."""


def index_property() -> object:
    """Return the property by which an operator is told a place on a list."""
    return IntProperty(
        name="Index", description="Place on the list, from 0; -1 is the active one", default=ACTIVE, min=ACTIVE
    )


def direction_property() -> object:
    """Return the property by which an operator is told where to move an item."""
    return EnumProperty(
        name="Direction",
        description="Where to",
        items=(("UP", "Up", "One place towards the beginning"), ("DOWN", "Down", "One place towards the end")),
    )


def taken_off(items: bpy.types.bpy_prop_collection, index: int, active: int) -> int:
    """Take an item off its list; return which one is active then."""
    items.remove(index)
    return max(active - 1, 0) if active >= index else active


def neighbor(items: bpy.types.bpy_prop_collection, index: int, direction: str) -> int | None:
    """Return the next place in a direction; None at the end of the list."""
    target = index + (1 if direction == "DOWN" else -1)
    return target if 0 <= target < len(items) else None


def swapped(items: bpy.types.bpy_prop_collection, index: int, target: int, active: int) -> int:
    """Let an item and its neighbor change places; return which one is active then."""
    items.move(index, target)
    if active not in (index, target):
        return active
    return target if active == index else index
