# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on vertices: those that are named, those that are selected, or the one next to a click on the surface."""

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
    # There is one click to wait for, and nothing that Enter could end early.
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
            self.report({"INFO"}, rpt_("There is nothing of the active object; click on its surface"))
            return {"RUNNING_MODAL"}
        self.cancel(context)
        self.vertices = str(vertex)
        return self._start(context)

    def chosen_vertices(self, obj: bpy.types.Object) -> list[int]:
        """Return the vertices that are meant; raises InputError where these are none."""
        chosen = numbered_vertices(self.vertices) or selected_vertices(obj)
        if not chosen:
            raise InputError("No vertex of {object} is selected; select some in Edit Mode.", object=obj.name)
        return chosen


def _shows_selection(obj: bpy.types.Object) -> bool:
    """Tell whether the user sees which vertices are selected."""
    return obj.mode == "EDIT" or (obj.mode == "WEIGHT_PAINT" and obj.data.use_paint_mask_vertex)
