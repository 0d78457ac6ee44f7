# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inspect a stored soft map: corresponding colors, the distribution of a vertex, and the confidence."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import IntProperty

from ..bridge.soft_maps.map_view import CONFIDENCE, show_distribution, show_places, write_confidence
from ..bridge.soft_maps.mapped_meshes import resting_mesh
from .reporting import reporting_errors, tell
from .soft_map_targets import OnStoredMap, StoredWay, current_way, edit_mode_left, one_selected, reshaped_notices


class _ViewsMap(OnStoredMap):
    """Base of operators that show the stored map on both objects."""

    @reporting_errors
    def execute(self, context):
        way = current_way(context)
        # Attributes and groups cannot be written in Edit Mode.
        with edit_mode_left(context):
            text = self._show(context, way)
        tell(self, text, reshaped_notices(way))
        return {"FINISHED"}

    def _show(self, context: bpy.types.Context, way: StoredWay) -> str:
        """Write the result, and return a message in the user's language."""
        raise NotImplementedError


class CONVWASS_OT_show_soft_map(_ViewsMap, bpy.types.Operator):
    """Color corresponding points of source and target alike; black points have no image"""

    bl_idname = "convwass.show_soft_map"
    bl_label = "Show Map"

    def _show(self, context, way):
        mesh = resting_mesh(way.source, way.side(way.source).triangles)
        show_places(way.source, way.target, way.stored.found, mesh)
        show_attribute_colors(context)
        return rpt_("{:s} and {:s} show the map as a color attribute").format(way.source.name, way.target.name)


class CONVWASS_OT_show_distribution(_ViewsMap, bpy.types.Operator):
    """Color the target by the distribution of the selected source vertex, from dark to bright"""

    bl_idname = "convwass.show_distribution"
    bl_label = "Show Distribution"

    vertex: IntProperty(
        name="Vertex",
        description="Number of a vertex of the source; -1 for the selected one",
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
    )

    def _show(self, context, way):
        vertex = self.vertex if self.vertex >= 0 else one_selected(way.source)
        mesh = resting_mesh(way.source, way.side(way.source).triangles)
        show_distribution(way.source, way.target, way.stored.found, mesh, vertex)
        show_attribute_colors(context)
        spread = float(way.stored.found.forward.spread[vertex])
        text = rpt_("Vertex {:d} of {:s} goes to {:s}, with a spread of {:.3g}")
        return text.format(vertex, way.source.name, way.target.name, spread)


def show_attribute_colors(context: bpy.types.Context) -> None:
    """Show color attributes in the viewport of an operator, if it uses solid shading."""
    space = context.space_data
    if space is not None and space.type == "VIEW_3D" and space.shading.type == "SOLID":
        space.shading.color_type = "VERTEX"


class CONVWASS_OT_map_confidence(_ViewsMap, bpy.types.Operator):
    """Write the confidence of the map, from 0 to 1, to a vertex group of both objects. It shows where to check the map, and is not a probability"""  # noqa: E501

    bl_idname = "convwass.map_confidence"
    bl_label = "Confidence as Group"

    def _show(self, context, way):
        write_confidence(way.source, way.target, way.stored.found)
        median = float(np.median(way.stored.found.forward.confidence))
        return rpt_("{:s} of {:s} has the median {:.2f}").format(CONFIDENCE, way.source.name, median)


classes = (
    CONVWASS_OT_show_soft_map,
    CONVWASS_OT_show_distribution,
    CONVWASS_OT_map_confidence,
)
