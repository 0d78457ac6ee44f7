# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Dots on the joints of a rig, drawn over the 3D viewport: pinned ones green and larger, free ones blue."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import bmesh
import bpy
import gpu
from bpy_extras.view3d_utils import location_3d_to_region_2d
from gpu_extras.batch import batch_for_shader
from mathutils import Vector

from .edge_graphs import pinned_vertices

# Pixels at a scale of 1.
_PINNED_RADIUS, _FREE_RADIUS, _RIM = 6.0, 4.0, 1.0
_CORNERS = 16
_INK = (0.05, 0.05, 0.05, 1.0)
# Told apart by everybody: Okabe and Ito, "Color Universal Design", 2008.
_GREEN, _BLUE = (0.0, 0.75, 0.5, 1.0), (0.34, 0.71, 0.91, 1.0)


@dataclass(frozen=True)
class JointDot:
    """A joint in space.

    Attributes
    ----------
    point : mathutils.Vector
        Where, world space.
    is_pinned : bool
        Whether it is pinned.
    """

    point: Vector
    is_pinned: bool


class JointDots:
    """Draws dots while it is registered.

    Parameters
    ----------
    wanted : callable
        ``wanted(context)`` returns the rig that is to have dots at that moment, or None.
    """

    def __init__(self, wanted: Callable[[bpy.types.Context], bpy.types.Object | None]) -> None:
        self._wanted = wanted
        self._handle: object | None = None

    def register(self) -> None:
        """Begin to draw."""
        if self._handle is None:
            self._handle = bpy.types.SpaceView3D.draw_handler_add(self._draw, (), "WINDOW", "POST_PIXEL")

    def unregister(self) -> None:
        """Draw no more."""
        if self._handle is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handle, "WINDOW")
            self._handle = None

    def _draw(self) -> None:
        context = bpy.context
        rig = self._wanted(context) if context.space_data.overlay.show_overlays else None
        if rig is None:
            return
        dots = dots_of(rig)
        gpu.state.blend_set("ALPHA")
        for is_pinned, radius, color in ((False, _FREE_RADIUS, _BLUE), (True, _PINNED_RADIUS, _GREEN)):
            _draw_dots([dot.point for dot in dots if dot.is_pinned == is_pinned], radius, color, context)
        gpu.state.blend_set("NONE")


def dots_of(rig: bpy.types.Object) -> list[JointDot]:
    """Return where the joints of a rig are, as they are drawn in its mode; none where it is hidden."""
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
        _fill_discs(centers, (radius + _RIM) * scale, _INK)
        _fill_discs(centers, radius * scale, color)


def _fill_discs(centers: Sequence[Vector], radius: float, color: tuple[float, ...]) -> None:
    """Fill discs, all in one go: rigs have hundreds of joints."""
    angles = [2.0 * math.pi * corner / _CORNERS for corner in range(_CORNERS)]
    rim = [Vector((radius * math.cos(angle), radius * math.sin(angle))) for angle in angles]
    points = [center + corner for center in centers for corner in rim]
    fan = [(0, corner, corner + 1) for corner in range(1, _CORNERS - 1)]
    triangles = [
        tuple(first + corner for corner in triangle) for first in range(0, len(points), _CORNERS) for triangle in fan
    ]
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    shader.uniform_float("color", color)
    batch_for_shader(shader, "TRIS", {"pos": points}, indices=triangles).draw(shader)
