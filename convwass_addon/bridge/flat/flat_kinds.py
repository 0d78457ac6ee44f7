# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Decide which objects are flat, by type or bounds, without evaluating them."""

from __future__ import annotations

import bpy

FLAT_KINDS = ("FONT", "CURVE", "GREASEPENCIL")
"""Object types that are flat, besides image Empties, unless modifiers or a bevel make them solid."""

TOUCHING = 1e-5
"""Distance relative to the extent below which the ends of an open spline touch."""

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
    return is_drawn_flat(obj) and not is_tube(obj)


def may_become_solid(obj: bpy.types.Object) -> bool:
    """Return whether a curve or text has modifiers that can make a solid of it."""
    return obj.type in ("FONT", "CURVE") and any(modifier.type in _GIVE_DEPTH for modifier in obj.modifiers)


def has_own_depth(obj: bpy.types.Object) -> bool:
    """Return whether a curve or text is extruded or beveled."""
    return obj.data.extrude > 0 or _is_beveled(obj.data)


def _is_beveled(curve: bpy.types.Curve) -> bool:
    return curve.bevel_object is not None if curve.bevel_mode == "OBJECT" else curve.bevel_depth > 0


def is_tube(obj: bpy.types.Object) -> bool:
    """Return whether an object is a curve of open splines with a bevel, which fills no area but has a volume."""
    splines = obj.data.splines if obj.type == "CURVE" and _is_beveled(obj.data) else ()
    reach = TOUCHING * max(obj.dimensions)
    return len(splines) > 0 and all(_is_open(spline, reach) for spline in splines)


def _is_open(spline: bpy.types.Spline, reach: float) -> bool:
    points = spline.bezier_points if spline.type == "BEZIER" else spline.points
    return not spline.use_cyclic_u and (len(points) < 4 or (points[0].co - points[-1].co).length > reach)


def is_image(obj: bpy.types.Object) -> bool:
    """Return whether an object is an image Empty."""
    return obj.type == "EMPTY" and obj.empty_display_type == "IMAGE" and obj.data is not None
