# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drag the handle of a live morph with the mouse in any 3D viewport."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from mathutils import Vector, geometry

from .picking import view_at

if TYPE_CHECKING:
    from ..bridge.live.live_pad import LivePad

# Radius around the handle in which it can be grabbed, in pixels at a UI scale of 1.
_NEAR = 16.0
# If the view direction is in the plane of the pad, dragging is impossible: minimum sine of their angle.
_ALONG = 0.02


class HandleDrag:
    """Handles mouse events from pressing the left button near the handle until it is released.

    Parameters
    ----------
    pad : LivePad
        The live morph with the handle.
    """

    def __init__(self, pad: LivePad) -> None:
        self._pad = pad
        self._view: bpy.types.Region | None = None

    def takes(self, context: bpy.types.Context, event: bpy.types.Event) -> bool:
        """Process an event, and return whether to consume it."""
        if event.type == "LEFTMOUSE" and event.value == "PRESS":
            self._view = self._view_on_handle(context, event)
            return self._view is not None
        if self._view is None:
            return False
        if event.type == "LEFTMOUSE" and event.value == "RELEASE":
            self._view = None
            return True
        if event.type == "MOUSEMOVE":
            self._move(event)
        return event.type in ("MOUSEMOVE", "INBETWEEN_MOUSEMOVE")

    def _view_on_handle(self, context: bpy.types.Context, event: bpy.types.Event) -> bpy.types.Region | None:
        """Return the view in which the mouse is over the handle."""
        from bpy_extras.view3d_utils import location_3d_to_region_2d

        handle, view = self._pad.handle, view_at(context.window, event.mouse_x, event.mouse_y)
        if handle is None or view is None:
            return None
        seen = location_3d_to_region_2d(view, view.data, handle.matrix_world.translation)
        near = _NEAR * context.preferences.system.ui_scale
        return view if seen is not None and (seen - _place_in(view, event)).length < near else None

    def _move(self, event: bpy.types.Event) -> None:
        """Move the handle to the mouse position, in the plane of the pad."""
        from bpy_extras.view3d_utils import (
            region_2d_to_location_3d,
            region_2d_to_origin_3d,
            region_2d_to_vector_3d,
        )

        pad, handle, view = self._pad.pad, self._pad.handle, self._view
        if pad is None or handle is None:
            return
        mouse = _place_in(view, event)
        along = region_2d_to_vector_3d(view, view.data, mouse)
        normal = pad.matrix_world.to_3x3() @ Vector((0.0, 1.0, 0.0))
        origin = pad.matrix_world.translation
        point = None
        if abs(along.dot(normal)) > _ALONG and self._pad.count > 2:
            start = region_2d_to_origin_3d(view, view.data, mouse)
            point = geometry.intersect_line_plane(start, start + along, origin, normal)
        if point is None:
            # A line can be dragged in any view.
            point = region_2d_to_location_3d(view, view.data, mouse, handle.matrix_world.translation)
        self._pad.move_to(*self._pad.place_at(pad.matrix_world.inverted() @ point))


def _place_in(view: bpy.types.Region, event: bpy.types.Event) -> Vector:
    """Return the position of the mouse in a view, in pixels."""
    return Vector((event.mouse_x - view.x, event.mouse_y - view.y))
