# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Decide which objects are flat, by type or bounds, without evaluating them."""

from __future__ import annotations

import bpy

FLAT_KINDS = ("FONT", "CURVE", "GREASEPENCIL")
"""Object types that are flat, besides image Empties, unless modifiers make them solid."""

# Modifiers that can make a solid of a flat curve or text.
_GIVE_DEPTH = ("NODES", "REMESH", "SCREW", "SOLIDIFY")


def is_shape(obj: bpy.types.Object) -> bool:
    """Return whether an object can be morphed, flat or solid."""
    return obj.type == "MESH" or is_drawn_flat(obj)


def is_drawn_flat(obj: bpy.types.Object) -> bool:
    """Return whether an object is of a flat type."""
    return obj.type in FLAT_KINDS or is_image(obj)


def looks_flat(obj: bpy.types.Object) -> bool:
    """Return whether an object is flat, by its type or its bounds, without evaluating it."""
    sizes = sorted(obj.dimensions)
    is_thin = sizes[2] > 0 and sizes[0] <= 1e-4 * sizes[2]
    if obj.type == "MESH" or (may_become_solid(obj) and not has_own_depth(obj)):
        return is_thin
    return is_drawn_flat(obj)


def may_become_solid(obj: bpy.types.Object) -> bool:
    """Return whether a curve or text has modifiers that can make a solid of it."""
    return obj.type in ("FONT", "CURVE") and any(modifier.type in _GIVE_DEPTH for modifier in obj.modifiers)


def has_own_depth(obj: bpy.types.Object) -> bool:
    """Return whether a curve or text is extruded or beveled."""
    return obj.data.extrude > 0 or obj.data.bevel_depth > 0


def is_image(obj: bpy.types.Object) -> bool:
    """Return whether an object is an image Empty."""
    return obj.type == "EMPTY" and obj.empty_display_type == "IMAGE" and obj.data is not None
