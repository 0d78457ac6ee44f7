# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The objects whose surfaces are the shapes of a morph."""

from __future__ import annotations

import bpy

from ..shape_sources import OBJECTS, shape_sources
from .stored import stored_inputs, stored_settings


def stored_parts(block: bpy.types.Collection | bpy.types.Object) -> list[bpy.types.Object]:
    """Return all objects whose surfaces a morph was baked from.

    Raises
    ------
    InputError
        As `stored_inputs`.
    """
    grouping = stored_settings(block).get("grouping", OBJECTS)
    return [part for source in shape_sources(stored_inputs(block), grouping) for part in source.parts]
