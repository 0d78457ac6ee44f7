# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The vertices that operators work on, and messages about them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from ..bridge.element_values import element_values
from ..errors import InputError


@contextmanager
def out_of_edit_mode(context: bpy.types.Context, obj: bpy.types.Object) -> Iterator[None]:
    """Leave Edit Mode temporarily, since vertex groups cannot be written in it."""
    if obj.mode != "EDIT":
        yield
        return
    bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        bpy.ops.object.mode_set(mode="EDIT")


def numbered_vertices(text: str) -> list[int]:
    """Parse vertex numbers; raises InputError if the text is invalid."""
    try:
        return [int(word) for word in text.replace(",", " ").split()]
    except ValueError as error:
        raise InputError("Vertices must be whole numbers separated by commas, not {text!r}.", text=text) from error


def selected_vertices(obj: bpy.types.Object) -> list[int]:
    """Return the selected vertices; outside Edit Mode, those selected when it was left.

    Raises
    ------
    InputError
        All vertices are selected, which identifies none.
    """
    if obj.data.is_editmode:
        obj.update_from_editmode()
    selected = element_values(obj.data.vertices, "select", kind=bool)
    if selected.all() and len(selected) > 1:
        raise InputError("All vertices of {object} are selected; select fewer.", object=obj.name)
    return np.flatnonzero(selected).tolist()


def length_text(scene: bpy.types.Scene, length: float) -> str:
    """Format a length in the units of a scene."""
    units = scene.unit_settings
    if not np.isfinite(length):
        return "-"
    meters = length * units.scale_length if units.system != "NONE" else length
    return bpy.utils.units.to_string(units.system, "LENGTH", meters, precision=4).strip()
