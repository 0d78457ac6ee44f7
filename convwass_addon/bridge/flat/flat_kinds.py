# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Decide which objects are flat, by type or bounds, without evaluating them."""

from __future__ import annotations

import bpy

FLAT_KINDS = ("FONT", "CURVE", "GREASEPENCIL")
"""Object types that are always flat, besides image Empties."""


def is_shape(obj: bpy.types.Object) -> bool:
    """Return whether an object can be morphed, flat or solid."""
    return obj.type == "MESH" or is_drawn_flat(obj)


def is_drawn_flat(obj: bpy.types.Object) -> bool:
    """Return whether an object is of a flat type."""
    return obj.type in FLAT_KINDS or is_image(obj)


def looks_flat(obj: bpy.types.Object) -> bool:
    """Return whether an object is flat, by its type or its bounds, without evaluating it."""
    sizes = sorted(obj.dimensions)
    return is_drawn_flat(obj) or (obj.type == "MESH" and sizes[2] > 0 and sizes[0] <= 1e-4 * sizes[2])


def is_image(obj: bpy.types.Object) -> bool:
    """Return whether an object is an image Empty."""
    return obj.type == "EMPTY" and obj.empty_display_type == "IMAGE" and obj.data is not None
