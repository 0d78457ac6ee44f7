# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices for operators: named, selected, or picked with a click on the surface."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..errors import InputError
from .background import BackgroundOperator
from .mesh_targets import numbered_vertices, selected_vertices
from .picking import PicksPoints, vertex_at
from .windows import write_status


class OnVertices(PicksPoints):
    """Base of operators on vertices. In a window without a visible selection, the operator waits for a click.

    Must precede the other base classes.
    """

    vertices: StringProperty(
        name="Vertices",
        description="Vertex numbers separated by commas. Empty: the selected vertices or, in Object and Weight Paint "
        "Mode, a clicked vertex",
        options={"SKIP_SAVE"},
    )

    _picks = False
    # One click is needed, so Enter does not end the operator.
    _ending_keys = frozenset({"ESC", "RIGHTMOUSE"})

    def invoke(self, context, event):
        if self.vertices.strip() or bpy.app.background or _shows_selection(context.object):
            return BackgroundOperator.invoke(self, context, event)
        self._picks = True
        write_status(context, rpt_("Click on the surface    Esc: cancel"))
        return self._wait(context)

    def modal(self, context, event):
        return (PicksPoints if self._picks else BackgroundOperator).modal(self, context, event)

    def cancel(self, context):
        if not self._picks:
            BackgroundOperator.cancel(self, context)
            return
        self._picks = False
        PicksPoints.cancel(self, context)

    def _is_over(self, context):
        return context.object is None or context.object.type != "MESH"

    def _take(self, context, region, place):
        vertex = vertex_at(context.object, context.evaluated_depsgraph_get(), region, place)
        if vertex is None:
            self.report({"INFO"}, rpt_("This is not on the active object; click on its surface"))
            return {"RUNNING_MODAL"}
        self.cancel(context)
        self.vertices = str(vertex)
        return self._start(context)

    def chosen_vertices(self, obj: bpy.types.Object) -> list[int]:
        """Return the vertices to use; raises InputError if there are none."""
        chosen = numbered_vertices(self.vertices) or selected_vertices(obj)
        if not chosen:
            raise InputError("No vertex of {object} is selected; select some in Edit Mode.", object=obj.name)
        return chosen


def _shows_selection(obj: bpy.types.Object) -> bool:
    """Return whether the selection of vertices is visible to the user."""
    return obj.mode == "EDIT" or (obj.mode == "WEIGHT_PAINT" and obj.data.use_paint_mask_vertex)
