# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh, groups and densities that density operators act on."""

from __future__ import annotations

import bpy
from bpy.props import StringProperty

from ..bridge.active import active_object
from ..bridge.densities.density_player import played_densities
from ..errors import InputError
from .background import is_idle

MODES = {"OBJECT", "PAINT_WEIGHT", "EDIT_MESH"}
"""Modes in which densities can be read and painted."""


def group_property() -> object:
    """Return the property that names a group in scripts."""
    return StringProperty(
        name="Group", description="Name of the vertex group; empty for the active one", options={"SKIP_SAVE"}
    )


def density_property() -> object:
    """Return the property that names an animated density in scripts."""
    return StringProperty(
        name="Density",
        description="Name of the animated density; empty for the first one of the object",
        options={"SKIP_SAVE"},
    )


class OnMesh:
    """Base of operators on the active mesh."""

    bl_options = {"REGISTER", "UNDO"}
    modes = frozenset(MODES)

    @classmethod
    def poll(cls, context):
        active = active_object(context)
        if active is None or active.type != "MESH":
            cls.poll_message_set("Make a mesh object active")
            return False
        if context.mode not in cls.modes:
            # Two literals, here and below, so that translations are found.
            if "EDIT_MESH" in cls.modes:
                cls.poll_message_set("Go to Object, Weight Paint or Edit Mode first")
            else:
                cls.poll_message_set("Go to Object or Weight Paint Mode first")
            return False
        return is_idle(cls, context)


class OnGroups(OnMesh):
    """Base of operators on vertex groups of the active mesh."""

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not context.object.vertex_groups:
            cls.poll_message_set("Paint a vertex group first")
            return False
        return True


class OnDensity(OnMesh):
    """Base of operators on an animated density of the active mesh."""

    modes = frozenset({"OBJECT", "PAINT_WEIGHT"})

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not played_densities(context.object):
            cls.poll_message_set("Interpolate a density first")
            return False
        return True


def chosen_group(obj: bpy.types.Object, name: str) -> str:
    """Return the given name of a group, else the active group; raises InputError if there is none."""
    if name:
        return name
    active = obj.vertex_groups.active
    if active is None:
        raise InputError("{object} has no active vertex group; paint one first.", object=obj.name)
    return active.name


def chosen_pair(obj: bpy.types.Object) -> list[str]:
    """Return the groups chosen in the panel, possibly empty; an object with exactly two groups needs no choice."""
    own = obj.convwass_density
    if not (own.first or own.second) and len(obj.vertex_groups) == 2:
        return [group.name for group in obj.vertex_groups]
    return [own.first, own.second]


def chosen_density(obj: bpy.types.Object, name: str) -> str:
    """Return the given name of a density, else the first density of the object."""
    return name or next(iter(played_densities(obj)), "")
