# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh and the groups that operators on densities work on, and how they tell of lengths."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy
import numpy as np
from bpy.props import StringProperty

from ..bridge.active import active_object
from ..bridge.densities.density_player import played_densities
from ..errors import InputError
from ..sentence import Sentence
from .background import is_idle

MODES = {"OBJECT", "PAINT_WEIGHT", "EDIT_MESH"}
"""Modes in which densities are read and painted."""


def group_property() -> object:
    """Return the property by which a script names a group."""
    return StringProperty(
        name="Group", description="Name of the vertex group; empty for the active one", options={"SKIP_SAVE"}
    )


def density_property() -> object:
    """Return the property by which a script names an animated density."""
    return StringProperty(
        name="Density",
        description="Name of the animated density; empty for the first one of the object",
        options={"SKIP_SAVE"},
    )


class OnMesh:
    """An operator on the active mesh."""

    bl_options = {"REGISTER", "UNDO"}
    modes = frozenset(MODES)

    @classmethod
    def poll(cls, context):
        active = active_object(context)
        if active is None or active.type != "MESH":
            cls.poll_message_set("Make a mesh object active")
            return False
        if context.mode not in cls.modes:
            # Here and below two literals, which translations are found for.
            if "EDIT_MESH" in cls.modes:
                cls.poll_message_set("Go to Object, Weight Paint or Edit Mode first")
            else:
                cls.poll_message_set("Go to Object or Weight Paint Mode first")
            return False
        return is_idle(cls, context)


class OnGroups(OnMesh):
    """An operator on vertex groups of the active mesh."""

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not context.object.vertex_groups:
            cls.poll_message_set("Paint a vertex group first")
            return False
        return True


class OnDensity(OnMesh):
    """An operator on an animated density of the active mesh."""

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
    """Return the name of a group: the one given, or the active one; raises InputError where there is none."""
    if name:
        return name
    active = obj.vertex_groups.active
    if active is None:
        raise InputError("{object} has no active vertex group; paint one first.", object=obj.name)
    return active.name


def chosen_pair(obj: bpy.types.Object) -> list[str]:
    """Return the groups chosen in the panel, empty where they are not; of two groups there is nothing to choose."""
    own = obj.convwass_density
    if not (own.first or own.second) and len(obj.vertex_groups) == 2:
        return [group.name for group in obj.vertex_groups]
    return [own.first, own.second]


def chosen_density(obj: bpy.types.Object, name: str) -> str:
    """Return the name of a density: the one given, or the first that the object plays."""
    return name or next(iter(played_densities(obj)), "")


@contextmanager
def out_of_edit_mode(context: bpy.types.Context, obj: bpy.types.Object) -> Iterator[None]:
    """Leave Edit Mode, in which groups cannot be written, for a moment."""
    if obj.mode != "EDIT":
        yield
        return
    bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        bpy.ops.object.mode_set(mode="EDIT")


def numbered_vertices(text: str) -> list[int]:
    """Read the numbers of vertices; raises InputError where they are none."""
    try:
        return [int(word) for word in text.replace(",", " ").split()]
    except ValueError as error:
        raise InputError("Vertices are whole numbers with commas between them, not {text!r}.", text=text) from error


def selected_vertices(obj: bpy.types.Object) -> list[int]:
    """Return the vertices that are selected, or that were when Edit Mode was left.

    Raises
    ------
    InputError
        All of them, which tells nothing.
    """
    if obj.data.is_editmode:
        obj.update_from_editmode()
    selected = np.empty(len(obj.data.vertices), dtype=bool)
    obj.data.vertices.foreach_get("select", selected)
    if selected.all() and len(selected) > 1:
        raise InputError("All vertices of {object} are selected; select fewer.", object=obj.name)
    return np.flatnonzero(selected).tolist()


def length_text(scene: bpy.types.Scene, length: float) -> str:
    """Write a length in the units of a scene."""
    units = scene.unit_settings
    if not np.isfinite(length):
        return "-"
    meters = length * units.scale_length if units.system != "NONE" else length
    return bpy.utils.units.to_string(units.system, "LENGTH", meters, precision=4).strip()


def ignored_notice(ignored: Sequence[str]) -> list[Sentence]:
    """Say which modifiers a surface does without."""
    if not ignored:
        return []
    return [Sentence("Without the modifiers that make other vertices: {names}.", {"names": ", ".join(ignored)})]
