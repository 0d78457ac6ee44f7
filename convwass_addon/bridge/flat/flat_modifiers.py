# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read curves and texts with all of their modifiers."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import bpy

from ...sentence import Sentence
from ..visibility import evaluated_object
from .flat_kinds import has_own_depth
from .flat_meshes import is_flat_mesh, mesh_rings, wire_rings
from .flat_rings import FlatRings
from .flat_splines import check_text, curve_rings, style_of

# Modifiers that Blender applies to the control points of a curve, whatever their "Apply on Spline".
_OF_POINTS = ("HOOK", "MESH_DEFORM", "SOFT_BODY")


def modified_rings(obj: bpy.types.Object, evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> FlatRings:
    """Read a curve or text object with its modifiers, by its mesh if they do not only move control points.

    The mesh has no letters. If it has no outlines in a plane, a notice names a modifier that is left out.

    Parameters and errors are those of :func:`.flat_splines.curve_rings`.
    """
    modifier = _first_of_mesh(obj)
    if modifier is None:
        return curve_rings(obj, evaluated, depsgraph)
    if obj.type == "FONT":
        check_text(obj, evaluated, depsgraph)
    read = _mesh_rings_of(obj, depsgraph)
    if read is not None:
        return read
    notice = Sentence(
        "{name}: blends leave out the modifier {modifier}, because it does not make closed outlines in one plane.",
        {"name": obj.name, "modifier": modifier.name},
    )
    return replace(curve_rings(obj, evaluated, depsgraph), notice=notice)


def _first_of_mesh(obj: bpy.types.Object) -> bpy.types.Modifier | None:
    """Return the first shown modifier of a curve or text that changes its mesh rather than its control points."""
    for modifier in obj.modifiers:
        moves_points = obj.type == "CURVE" and (modifier.use_apply_on_spline or modifier.type in _OF_POINTS)
        if modifier.show_viewport and not moves_points:
            return modifier
    return None


def _mesh_rings_of(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> FlatRings | None:
    """Read the mesh of a curve or text without its depth, or return None if that is not a flat area."""
    with _without_depth(obj), evaluated_object(obj, depsgraph) as evaluated:
        is_filled = is_flat_mesh(evaluated)
        read = mesh_rings(evaluated) if is_filled else wire_rings(evaluated)
    if read is None:
        return None
    style = style_of(obj.data, read.matrix)
    # Geometry Nodes can fill what the curve does not. The outline contains the offset.
    fill_mode = "BOTH" if is_filled and style.fill_mode == "NONE" else style.fill_mode
    return replace(read, style=replace(style, offset=0.0, fill_mode=fill_mode))


@contextmanager
def _without_depth(obj: bpy.types.Object) -> Iterator[None]:
    """Remove the extrusion and the bevel of a curve or text during a block of code."""
    curve = obj.data
    if not has_own_depth(obj):
        yield
        return
    extrude, bevel_depth, bevel_object = curve.extrude, curve.bevel_depth, curve.bevel_object
    curve.extrude, curve.bevel_depth, curve.bevel_object = 0.0, 0.0, None
    try:
        yield
    finally:
        curve.extrude, curve.bevel_depth, curve.bevel_object = extrude, bevel_depth, bevel_object
