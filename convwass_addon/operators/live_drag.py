# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drag the handle of a live morph with the mouse in any 3D viewport."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy
from mathutils import Vector, geometry

if TYPE_CHECKING:
    from ..bridge.live.live_pad import LivePad

# Radius around the handle in which it can be grabbed, in pixels at a UI scale of 1.
_NEAR = 16.0
# If the view direction is in the plane of the pad, dragging is impossible: minimum sine of their angle.
_ALONG = 0.02


@dataclass(frozen=True)
class _View:
    """A region of a 3D viewport and its view."""

    region: bpy.types.Region
    view: bpy.types.RegionView3D

    def place_of(self, event: bpy.types.Event) -> Vector:
        return Vector((event.mouse_x - self.region.x, event.mouse_y - self.region.y))


class HandleDrag:
    """Handles mouse events from pressing the left button near the handle until it is released.

    Parameters
    ----------
    pad : LivePad
        The live morph with the handle.
    """

    def __init__(self, pad: LivePad) -> None:
        self._pad = pad
        self._view: _View | None = None

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

    def _view_on_handle(self, context: bpy.types.Context, event: bpy.types.Event) -> _View | None:
        """Return the view in which the mouse is over the handle."""
        from bpy_extras.view3d_utils import location_3d_to_region_2d

        handle, view = self._pad.handle, _view_under(context, event)
        if handle is None or view is None:
            return None
        seen = location_3d_to_region_2d(view.region, view.view, handle.matrix_world.translation)
        near = _NEAR * context.preferences.system.ui_scale
        return view if seen is not None and (seen - view.place_of(event)).length < near else None

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
        mouse = view.place_of(event)
        along = region_2d_to_vector_3d(view.region, view.view, mouse)
        normal = pad.matrix_world.to_3x3() @ Vector((0.0, 1.0, 0.0))
        origin = pad.matrix_world.translation
        point = None
        if abs(along.dot(normal)) > _ALONG and self._pad.count > 2:
            start = region_2d_to_origin_3d(view.region, view.view, mouse)
            point = geometry.intersect_line_plane(start, start + along, origin, normal)
        if point is None:
            # A line can be dragged in any view.
            point = region_2d_to_location_3d(view.region, view.view, mouse, handle.matrix_world.translation)
        self._pad.move_to(*self._pad.place_at(pad.matrix_world.inverted() @ point))


def _view_under(context: bpy.types.Context, event: bpy.types.Event) -> _View | None:
    """Return the 3D viewport under the mouse, unless another of its regions covers it."""
    for area in context.window.screen.areas if context.window else ():
        if area.type != "VIEW_3D" or not _is_in(area, event):
            continue
        others = [region for region in area.regions if region.type != "WINDOW" and region.width > 1]
        if any(_is_in(region, event) for region in others):
            return None
        for region in area.regions:
            if region.type == "WINDOW" and _is_in(region, event):
                return _View(region, region.data or area.spaces.active.region_3d)
    return None


def _is_in(part: bpy.types.Area | bpy.types.Region, event: bpy.types.Event) -> bool:
    return 0 <= event.mouse_x - part.x < part.width and 0 <= event.mouse_y - part.y < part.height
