# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists in the sidebar: remove and move items while another one stays active, and clear them."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.props import EnumProperty, IntProperty

from ..errors import InputError
from .reporting import reporting_errors

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


@dataclass(frozen=True)
class SidebarList:
    """A list and its active item.

    Attributes
    ----------
    owner : bpy.types.PropertyGroup
        The settings with the list.
    items_name, active_name : str
        Names of the properties for the list and for the index of its active item.
    """

    owner: bpy.types.PropertyGroup
    items_name: str
    active_name: str

    @property
    def items(self) -> bpy.types.bpy_prop_collection:
        """The items."""
        return getattr(self.owner, self.items_name)

    def place(self, index: int) -> int:
        """Return an index on the list, of the active item for `ACTIVE`; raises InputError if there is no such item."""
        place = self._active if index == ACTIVE else index
        if not 0 <= place < len(self.items):
            raise InputError("The list has no item {index}; the first one is item 0.", index=place)
        return place

    def remove(self, place: int) -> None:
        """Remove an item."""
        self.items.remove(place)
        if self._active >= place:
            self._activate(max(self._active - 1, 0))

    def clear(self) -> None:
        """Remove all items."""
        self.items.clear()
        self._activate(0)

    def swap(self, place: int, target: int) -> None:
        """Swap two neighbors."""
        self.items.move(place, target)
        self._activate({place: target, target: place}.get(self._active, self._active))

    @property
    def _active(self) -> int:
        return getattr(self.owner, self.active_name)

    def _activate(self, place: int) -> None:
        setattr(self.owner, self.active_name, place)


class _OnList:
    def _list(self, context: bpy.types.Context) -> SidebarList:
        """Return the list to edit."""
        raise NotImplementedError


class ClearsList(_OnList):
    """Base of operators that remove all items of a list."""

    def execute(self, context):
        """Clear the list."""
        self._list(context).clear()
        return {"FINISHED"}


class _OnItem(_OnList):
    index: index_property()

    @reporting_errors
    def execute(self, context):
        own = self._list(context)
        place = own.place(self.index)
        return {"FINISHED"} if self._edit(own, place) else {"CANCELLED"}

    def _edit(self, own: SidebarList, place: int) -> bool:
        """Edit the list; return whether it has changed."""
        raise NotImplementedError


class RemovesItem(_OnItem):
    """Base of operators that remove an item of a list."""

    def _edit(self, own: SidebarList, place: int) -> bool:
        own.remove(place)
        return True


class MovesItem(_OnItem):
    """Base of operators that swap an item of a list with the one before or after it, if there is one."""

    direction: direction_property()

    def _edit(self, own: SidebarList, place: int) -> bool:
        target = place + (1 if self.direction == "DOWN" else -1)
        if not 0 <= target < len(own.items):
            return False
        self._swap(own, place, target)
        return True

    def _swap(self, own: SidebarList, place: int, target: int) -> None:
        own.swap(place, target)
