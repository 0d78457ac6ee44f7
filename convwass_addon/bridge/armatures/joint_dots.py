# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Dots on the joints of a rig in the 3D viewport: large green dots for pinned joints, blue dots for free joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bmesh
import bpy
import gpu
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from ..viewport_overlay import ViewportOverlay, fill_discs
from .pins import pinned_vertices

# Pixels at UI scale 1.
_PINNED_RADIUS, _FREE_RADIUS, _RIM = 6.0, 4.0, 1.0
_INK = (0.05, 0.05, 0.05, 1.0)
# Distinguishable with all kinds of color vision: Okabe and Ito, "Color Universal Design", 2008.
_GREEN, _BLUE = (0.0, 0.75, 0.5, 1.0), (0.34, 0.71, 0.91, 1.0)


@dataclass(frozen=True)
class JointDot:
    """A joint and its position.

    Attributes
    ----------
    point : mathutils.Vector
        World space.
    is_pinned : bool
        Whether it is pinned.
    """

    point: Vector
    is_pinned: bool


class JointDots(ViewportOverlay[bpy.types.Object | None]):
    """Draws dots while registered.

    Parameters
    ----------
    wanted : callable
        ``wanted(context)`` returns the rig to draw dots for, or None.
    """

    def _draw(self, wanted: bpy.types.Object | None, context: bpy.types.Context) -> None:
        if wanted is None:
            return
        dots = dots_of(wanted)
        gpu.state.blend_set("ALPHA")
        for is_pinned, radius, color in ((False, _FREE_RADIUS, _BLUE), (True, _PINNED_RADIUS, _GREEN)):
            _draw_dots([dot.point for dot in dots if dot.is_pinned == is_pinned], radius, color, context)
        gpu.state.blend_set("NONE")


def dots_of(rig: bpy.types.Object) -> list[JointDot]:
    """Return the visible joints of a rig in its current mode; empty if it is hidden."""
    if not rig.visible_get():
        return []
    return _bone_dots(rig) if rig.type == "ARMATURE" else _vertex_dots(rig)


def _bone_dots(rig: bpy.types.Object) -> list[JointDot]:
    matrix = rig.matrix_world
    if rig.mode == "EDIT":
        shown = [(bone, bone) for bone in rig.data.edit_bones if not bone.hide]
    else:
        shown = [(bone, bone.bone) for bone in rig.pose.bones]
    return [
        JointDot(matrix @ point, pinned)
        for bone, own in shown
        for point, pinned in zip((bone.head, bone.tail), own.convwass_pinned, strict=True)
    ]


def _vertex_dots(rig: bpy.types.Object) -> list[JointDot]:
    mesh = rig.data
    vertices = bmesh.from_edit_mesh(mesh).verts if mesh.is_editmode else mesh.vertices
    pinned = pinned_vertices(mesh)
    return [JointDot(rig.matrix_world @ vertex.co, bool(pinned[place])) for place, vertex in enumerate(vertices)]


def _draw_dots(points: Sequence[Vector], radius: float, color: tuple[float, ...], context: bpy.types.Context) -> None:
    region, view, scale = context.region, context.region_data, context.preferences.system.ui_scale
    places = [location_3d_to_region_2d(region, view, point) for point in points]
    centers = [place for place in places if place is not None]
    if centers:
        fill_discs(centers, (radius + _RIM) * scale, _INK)
        fill_discs(centers, radius * scale, color)
