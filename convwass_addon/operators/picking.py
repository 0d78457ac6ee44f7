# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Picking points on surfaces in 3D views."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d
from mathutils import Vector
from numpy.typing import NDArray

from ..bridge.surface_marks import nearest_vertex
from ..bridge.surfaces import surface_mesh
from ..errors import ConvwassError
from .reporting import refuse
from .windows import clear_status, clear_windows

# Ids of the operators that are waiting for clicks.
_WAITING: set[int] = set()


class PicksPoints:
    """Base of operators that wait for clicks in 3D views; must precede the other base classes.

    Everything else in the window stays usable.
    """

    _ending_keys = frozenset({"ESC", "RIGHTMOUSE", "RET"})

    def modal(self, context, event):
        if self._is_over(context) or (event.type in self._ending_keys and event.value == "PRESS"):
            self.cancel(context)
            # Every picked point already has its own undo step.
            return {"CANCELLED"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        region = view_at(context.window, event.mouse_x, event.mouse_y)
        if region is None:
            return {"PASS_THROUGH"}
        try:
            return self._take(context, region, (event.mouse_x - region.x, event.mouse_y - region.y))
        except ConvwassError as error:
            self.cancel(context)
            return refuse(self, error)

    def cancel(self, context):
        _WAITING.discard(id(self))
        context.window.cursor_modal_restore()
        clear_status(context)

    def _wait(self, context: bpy.types.Context) -> set[str]:
        """Start waiting for clicks."""
        context.window_manager.modal_handler_add(self)
        context.window.cursor_modal_set("EYEDROPPER")
        _WAITING.add(id(self))
        return {"RUNNING_MODAL"}

    # Hooks for operators.

    def _is_over(self, context: bpy.types.Context) -> bool:
        """Return whether the objects to click on no longer exist."""
        raise NotImplementedError

    def _take(self, context: bpy.types.Context, region: bpy.types.Region, place: tuple[int, int]) -> set[str]:
        """Handle a click at a position of a view, in pixels; return the result of a modal operator.

        Raises
        ------
        ConvwassError
            The operator cannot continue.
        """
        raise NotImplementedError


def stop_waiting(context: bpy.types.Context) -> None:
    """Stop waiting for clicks before the operators are unregistered; picked points are kept."""
    if _WAITING:
        _WAITING.clear()
        clear_windows(context)


def view_at(window: bpy.types.Window, x: int, y: int) -> bpy.types.Region | None:
    """Return the 3D view at a position in a window; None if there is none, or it is covered."""
    for area in window.screen.areas:
        under = [region for region in area.regions if _holds(region, x, y)] if area.type == "VIEW_3D" else []
        if under and all(region.type == "WINDOW" for region in under):
            return under[0]
    return None


def _holds(region: bpy.types.Region, x: int, y: int) -> bool:
    return region.x <= x < region.x + region.width and region.y <= y < region.y + region.height


def surface_point_at(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, region: bpy.types.Region, place: tuple[int, int]
) -> NDArray[np.float64] | None:
    """Return the surface point of an object at a position of a view, (3,) in world space, or None."""
    evaluated = obj.evaluated_get(depsgraph)
    matrix = evaluated.matrix_world
    inverse = matrix.inverted_safe()
    origin = inverse @ region_2d_to_origin_3d(region, region.data, place)
    direction = inverse.to_3x3() @ region_2d_to_vector_3d(region, region.data, place)
    is_hit, location, _, _ = evaluated.ray_cast(origin, direction)
    return np.array(matrix @ location, dtype=np.float64) if is_hit else None


def vertex_at(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, region: bpy.types.Region, place: tuple[int, int]
) -> int | None:
    """Return the vertex of a face that is nearest to the surface point at a position of a view, or None.

    Raises
    ------
    InputError
        The object has no surface.
    """
    point = surface_point_at(obj, depsgraph, region, place)
    return None if point is None else nearest_vertex(surface_mesh(obj, depsgraph), point)


def nearest_hit(
    objects: Iterable[bpy.types.Object],
    depsgraph: bpy.types.Depsgraph,
    region: bpy.types.Region,
    place: tuple[int, int],
) -> tuple[bpy.types.Object, int] | None:
    """Return the visible object that is nearest to the viewer at a position of a view, and its vertex there, or None.

    Raises
    ------
    InputError
        An object has no surface.
    """
    hits = []
    for obj in objects:
        vertex = vertex_at(obj, depsgraph, region, place) if obj.visible_get() else None
        if vertex is not None:
            hits.append((_depth_of(obj, vertex, depsgraph, region.data), obj, vertex))
    return min(hits, key=lambda hit: hit[0])[1:] if hits else None


def redraw_views(context: bpy.types.Context) -> None:
    """Redraw the 3D viewports of a window."""
    for area in context.window.screen.areas:
        if area.type == "VIEW_3D":
            area.tag_redraw()


def _depth_of(
    obj: bpy.types.Object, vertex: int, depsgraph: bpy.types.Depsgraph, view: bpy.types.RegionView3D
) -> float:
    """Return the distance of a vertex from the viewer, along the view direction."""
    evaluated = obj.evaluated_get(depsgraph)
    is_kept = len(evaluated.data.vertices) == len(obj.data.vertices)
    point: Vector = evaluated.matrix_world @ (evaluated.data if is_kept else obj.data).vertices[vertex].co
    return -(view.view_matrix @ point).z
