# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on vertices: those that are named, those that are selected, or the one next to a click on the surface."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d

from ..bridge.surfaces import surface_mesh
from ..errors import ConvwassError, InputError
from .background import BackgroundOperator
from .density_targets import numbered_vertices, selected_vertices
from .reporting import refuse


class OnVertices:
    """Long work on vertices; where there is a window and nothing is selected by hand, the operator asks for a click.

    It goes before the other bases.
    """

    vertices: StringProperty(
        name="Vertices",
        description="Numbers of vertices with commas between them; empty for those that are selected, or in Object and "
        "Weight Paint Mode for the one that is clicked on",
        options={"SKIP_SAVE"},
    )

    _picks = False

    def invoke(self, context, event):
        if self.vertices.strip() or bpy.app.background or _shows_selection(context.object):
            return BackgroundOperator.invoke(self, context, event)
        self._picks = True
        context.window_manager.modal_handler_add(self)
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set(rpt_("Click on the surface    Esc: cancel"))
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if not self._picks:
            return BackgroundOperator.modal(self, context, event)
        if context.object is None or context.object.type != "MESH":
            self.cancel(context)
            return {"CANCELLED"}
        if event.type in ("ESC", "RIGHTMOUSE") and event.value == "PRESS":
            self.cancel(context)
            return {"CANCELLED"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        region = view_at(context.window, event.mouse_x, event.mouse_y)
        if region is None:
            return {"PASS_THROUGH"}
        place = event.mouse_x - region.x, event.mouse_y - region.y
        try:
            vertex = vertex_at(context.object, context.evaluated_depsgraph_get(), region, region.data, place)
        except ConvwassError as error:
            self.cancel(context)
            return refuse(self, error)
        if vertex is None:
            self.report({"INFO"}, rpt_("There is nothing of the active object; click on its surface"))
            return {"RUNNING_MODAL"}
        self.cancel(context)
        self.vertices = str(vertex)
        return self._start(context)

    def cancel(self, context):
        if not self._picks:
            BackgroundOperator.cancel(self, context)
            return
        self._picks = False
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)

    def chosen_vertices(self, obj: bpy.types.Object) -> list[int]:
        """Return the vertices that are meant; raises InputError where these are none."""
        chosen = numbered_vertices(self.vertices) or selected_vertices(obj)
        if not chosen:
            raise InputError("No vertex of {object} is selected; select some in Edit Mode.", object=obj.name)
        return chosen


def _shows_selection(obj: bpy.types.Object) -> bool:
    """Tell whether the user sees which vertices are selected."""
    return obj.mode == "EDIT" or (obj.mode == "WEIGHT_PAINT" and obj.data.use_paint_mask_vertex)


def view_at(window: bpy.types.Window, x: int, y: int) -> bpy.types.Region | None:
    """Return the 3D view at a point of a window; None where there is none, or something lies over it."""
    for area in window.screen.areas:
        under = [region for region in area.regions if _holds(region, x, y)] if area.type == "VIEW_3D" else []
        views = [region for region in under if region.type == "WINDOW"]
        if views and not any(region.type in ("UI", "TOOLS") for region in under):
            return views[0]
    return None


def _holds(region: bpy.types.Region, x: int, y: int) -> bool:
    return region.x <= x < region.x + region.width and region.y <= y < region.y + region.height


def vertex_at(
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    region: bpy.types.Region,
    view: bpy.types.RegionView3D,
    place: tuple[int, int],
) -> int | None:
    """Return the vertex with a face that is nearest to what a point of a view shows of an object; None for nothing.

    Raises
    ------
    InputError
        The object has no surface.
    """
    evaluated = obj.evaluated_get(depsgraph)
    inverse = evaluated.matrix_world.inverted_safe()
    origin = inverse @ region_2d_to_origin_3d(region, view, place)
    direction = inverse.to_3x3() @ region_2d_to_vector_3d(region, view, place)
    is_hit, location, _, _ = evaluated.ray_cast(origin, direction)
    if not is_hit:
        return None
    point = np.array(evaluated.matrix_world @ location)
    mesh = surface_mesh(obj, depsgraph)
    used = np.unique(mesh.faces)
    return int(used[np.linalg.norm(mesh.vertices[used] - point, axis=1).argmin()])
