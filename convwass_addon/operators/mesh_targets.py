# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The vertices of a mesh that operators work on, and what they tell of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy
import numpy as np

from ..errors import InputError
from ..sentence import Sentence


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
