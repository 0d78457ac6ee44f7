# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Look at a stored soft map: colors of places, the distribution of one vertex, and how sure the map is."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import IntProperty

from ..bridge.soft_maps.map_view import CONFIDENCE, show_distribution, show_places, write_confidence
from ..bridge.soft_maps.resting_surface import resting_mesh
from ..errors import ConvwassError
from .reporting import refuse, tell
from .soft_map_targets import OnStoredMap, StoredWay, current_way, edit_mode_left, one_selected, reshaped_notices


class _ViewsMap(OnStoredMap):
    """An operator that shows something of the stored map on both objects."""

    def execute(self, context):
        try:
            way = current_way(context)
            # Attributes and groups of what is being edited cannot be written.
            with edit_mode_left(context):
                text = self._show(context, way)
        except ConvwassError as error:
            return refuse(self, error)
        tell(self, text, reshaped_notices(way))
        return {"FINISHED"}

    def _show(self, context: bpy.types.Context, way: StoredWay) -> str:
        """Write it, and return in the user's language what was done."""
        raise NotImplementedError


class CONVWASS_OT_show_soft_map(_ViewsMap, bpy.types.Operator):
    """Color the source by its places and the target by those that it comes from: what has the same color belongs together, and black has no image"""  # noqa: E501

    bl_idname = "convwass.show_soft_map"
    bl_label = "Show Map"

    def _show(self, context, way):
        mesh = resting_mesh(way.source, way.side(way.source).triangles)
        show_places(way.source, way.target, way.stored.found, mesh)
        show_attribute_colors(context)
        return rpt_("{:s} and {:s} show the map as a color attribute").format(way.source.name, way.target.name)


class CONVWASS_OT_show_distribution(_ViewsMap, bpy.types.Operator):
    """Color the target by where the selected vertex of the source may belong, from dark to bright"""

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
    """Let the viewport that an operator is called from show color attributes, where it is shaded solid."""
    space = context.space_data
    if space is not None and space.type == "VIEW_3D" and space.shading.type == "SOLID":
        space.shading.color_type = "VERTEX"


class CONVWASS_OT_map_confidence(_ViewsMap, bpy.types.Operator):
    """Write how sure the map is to a vertex group of both objects, from 0 to 1; it says where to look, and is no probability"""  # noqa: E501

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
