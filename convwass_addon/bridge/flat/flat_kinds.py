# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects are flat by their kind or look flat by their bounds, found without evaluating them."""

from __future__ import annotations

import bpy

FLAT_KINDS = ("FONT", "CURVE", "GREASEPENCIL")
"""Types of objects that are flat by their nature, besides empties that show an image."""


def is_shape(obj: bpy.types.Object) -> bool:
    """Tell whether an object can take part in a morph, flat or solid."""
    return obj.type == "MESH" or is_drawn_flat(obj)


def is_drawn_flat(obj: bpy.types.Object) -> bool:
    """Tell whether an object is flat by its nature."""
    return obj.type in FLAT_KINDS or is_image(obj)


def looks_flat(obj: bpy.types.Object) -> bool:
    """Tell by its kind or its bounds, without evaluating anything, whether an object is flat."""
    sizes = sorted(obj.dimensions)
    return is_drawn_flat(obj) or (obj.type == "MESH" and sizes[2] > 0 and sizes[0] <= 1e-4 * sizes[2])


def is_image(obj: bpy.types.Object) -> bool:
    """Tell whether an object is an empty that shows an image."""
    return obj.type == "EMPTY" and obj.empty_display_type == "IMAGE" and obj.data is not None
