# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which kind of morph some objects ask for."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...errors import InputError
from ..objects import MESHED
from .flat_kinds import is_drawn_flat, is_shape
from .flat_objects import is_flat


def asks_for_flat(inputs: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph, thickness: float) -> bool:
    """Tell whether objects ask for a flat morph: all of them are flat, and no mesh of them is to be given a thickness.

    Raises
    ------
    InputError
        Flat shapes beside solid ones that have no depth of their own and are to be given none.
    """
    if not all(is_shape(obj) for obj in inputs):
        # Whoever reads them says what is wrong with those.
        return False
    flat = [is_flat(obj, depsgraph) for obj in inputs]
    if all(flat):
        return thickness <= 0 or not all(obj.type == "MESH" for obj in inputs)
    if not any(flat):
        return False
    solid = inputs[flat.index(False)]
    for obj in (obj for obj, is_one in zip(inputs, flat, strict=True) if is_one):
        if obj.type not in MESHED:
            raise InputError(
                "{flat} is flat and {solid} is solid, and a drawing or an image cannot be made solid; choose shapes of "
                "one kind.",
                flat=obj.name,
                solid=solid.name,
            )
        if thickness <= 0 and not (is_drawn_flat(obj) and (obj.data.extrude > 0 or obj.data.bevel_depth > 0)):
            raise InputError(
                "{flat} is flat and {solid} is solid; choose shapes of one kind, or set Thickness to make flat ones "
                "solid.",
                flat=obj.name,
                solid=solid.name,
            )
    return False


def refuse_volumes(wanted: bool) -> None:
    """Refuse to make volumes of a flat morph where they are wanted; raises InputError."""
    if wanted:
        raise InputError("Flat shapes have no volume; choose another output: objects, a player or a cache.")
