# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels for soft maps: two objects, pairs of vertices, transfers, inspection."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..applications.soft_maps.soft_map_settings import SoftMapSettings
from ..bridge.soft_maps.soft_map_requests import MapRequest, TransferRequest
from ..bridge.soft_maps.soft_map_store import recounted
from ..operators.soft_map_compute import (
    CONVWASS_OT_compute_soft_map,
    CONVWASS_OT_mirror_map,
    CONVWASS_OT_remove_soft_map,
    CONVWASS_OT_repair_soft_map,
)
from ..operators.soft_map_pairs import (
    CONVWASS_OT_add_map_pair,
    CONVWASS_OT_clear_map_pairs,
    CONVWASS_OT_map_pairs_from_empties,
    CONVWASS_OT_map_pairs_from_groups,
    CONVWASS_OT_remove_map_pair,
    CONVWASS_OT_swap_map_objects,
)
from ..operators.soft_map_targets import mapped_objects
from ..operators.soft_map_transfer import CONVWASS_OT_transfer_by_map
from ..operators.soft_map_view import (
    CONVWASS_OT_map_confidence,
    CONVWASS_OT_show_distribution,
    CONVWASS_OT_show_soft_map,
)
from ..properties.soft_maps import CONVWASS_PG_soft_map, FromGroupsProperties, SoftMapProperties, TransferProperties
from .from_schema import draw_settings
from .sidebar import Sidebar, draw_numbered, draw_wrapped, fill_operator, large_button, with_labels_beside


class CONVWASS_UL_map_pairs(bpy.types.UIList):
    """Corresponding vertices: whether enabled, number, name, and both vertices"""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        row = layout.row(align=True)
        shown = draw_numbered(row, item, index)
        for name, now in zip(("source_vertex", "target_vertex"), data.vertices_now(item), strict=True):
            vertex = shown.row(align=True)
            vertex.ui_units_x = 2.4
            vertex.alert = item.is_complete and now is None
            vertex.prop(item, name, text="")
        row.operator(CONVWASS_OT_remove_map_pair.bl_idname, text="", icon="X", emboss=False).index = index


class CONVWASS_PT_soft_map(Sidebar, bpy.types.Panel):
    """Transfer weights, shape keys, UV maps and colors from one character to another"""

    bl_label = "Soft Map"
    bl_idname = "CONVWASS_PT_soft_map"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = self.layout, context.scene.convwass_soft_map
        row = layout.row(align=True)
        column = row.column(align=True)
        for name in ("source", "target"):
            column.prop(own, name)
        row.operator(CONVWASS_OT_swap_map_objects.bl_idname, text="", icon="UV_SYNC_SELECT")
        _draw_compute(layout, own)
        way = mapped_objects(context)
        if way is not None:
            text = iface_("Map from {:s} to {:s}").format(way[0].name, way[1].name)
            layout.label(text=text, icon="CHECKMARK", translate=False)
            changed = recounted(*way)
            if changed:
                text = iface_("Vertices or faces have changed since the map was computed: {:s}; compute it again")
                draw_wrapped(layout, context, text.format(", ".join(changed)), "ERROR")


def _draw_compute(layout: bpy.types.UILayout, own: CONVWASS_PG_soft_map) -> None:
    """Draw the button for two objects, or for a mirror map of one object."""
    is_mirror = own.source is not None and own.source == own.target
    kind, icon = (
        (CONVWASS_OT_mirror_map, "MOD_MIRROR") if is_mirror else (CONVWASS_OT_compute_soft_map, "MOD_DATA_TRANSFER")
    )
    large_button(layout, kind, icon, own, SoftMapProperties)


class _Subpanel(Sidebar):
    bl_parent_id = "CONVWASS_PT_soft_map"

    def draw(self, context):
        self.draw_tools(context, with_labels_beside(self.layout), context.scene.convwass_soft_map)


class _OfMap(_Subpanel):
    """Base of panels that require a stored map."""

    @classmethod
    def poll(cls, context):
        return mapped_objects(context) is not None


class CONVWASS_PT_map_pairs(_Subpanel, bpy.types.Panel):
    """Corresponding vertices"""

    bl_label = "Pairs"
    bl_idname = "CONVWASS_PT_map_pairs"

    def draw_tools(self, context, layout, own):
        row = layout.row()
        row.template_list("CONVWASS_UL_map_pairs", "", own, "pairs", own, "active_pair", rows=4)
        column = row.column(align=True)
        column.operator(CONVWASS_OT_add_map_pair.bl_idname, text="", icon="ADD")
        column.operator(CONVWASS_OT_remove_map_pair.bl_idname, text="", icon="REMOVE")
        column.separator()
        column.operator(CONVWASS_OT_clear_map_pairs.bl_idname, text="", icon="X")
        layout.operator(CONVWASS_OT_add_map_pair.bl_idname, icon="EYEDROPPER")
        layout.operator(CONVWASS_OT_map_pairs_from_empties.bl_idname, icon="EMPTY_AXIS")
        operator = layout.operator(CONVWASS_OT_map_pairs_from_groups.bl_idname, icon="GROUP_VERTEX")
        fill_operator(operator, own, FromGroupsProperties)
        for name in ("pattern", "largest", "show_labels"):
            layout.prop(own, name)


class CONVWASS_PT_map_solver(_Subpanel, bpy.types.Panel):
    """Settings; the defaults suit most cases"""

    bl_label = "Map Settings"
    bl_idname = "CONVWASS_PT_map_solver"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_tools(self, context, layout, own):
        draw_settings(layout, own, SoftMapSettings, "settings")
        draw_settings(layout, own, MapRequest, "settings")
        row = layout.row()
        row.active = own.use_groups
        row.prop(own, "group_weight")


class CONVWASS_PT_map_transfer(_OfMap, bpy.types.Panel):
    """Transfer data with the map"""

    bl_label = "Transfer"
    bl_idname = "CONVWASS_PT_map_transfer"

    def draw_tools(self, context, layout, own):
        column = layout.column()
        column.prop(own, "what")
        draw_settings(column, own, TransferRequest, "transfer")
        if "GROUPS" in own.what:
            draw_settings(column, own, TransferRequest, "groups")
        draw_settings(column, own, TransferRequest, "names")
        large_button(layout, CONVWASS_OT_transfer_by_map, "PASTEDOWN", own, TransferProperties)


class CONVWASS_PT_map_view(_OfMap, bpy.types.Panel):
    """Inspect the map and correct it"""

    bl_label = "Inspect and Repair"
    bl_idname = "CONVWASS_PT_map_view"

    def draw_tools(self, context, layout, own):
        layout.operator(CONVWASS_OT_show_soft_map.bl_idname, icon="COLOR")
        layout.operator(CONVWASS_OT_show_distribution.bl_idname, icon="RESTRICT_SELECT_OFF")
        layout.operator(CONVWASS_OT_map_confidence.bl_idname, icon="GROUP_VERTEX")
        column = layout.column(align=True)
        column.operator(CONVWASS_OT_repair_soft_map.bl_idname, icon="TOOL_SETTINGS").threshold = own.threshold
        column.prop(own, "threshold")
        layout.operator(CONVWASS_OT_remove_soft_map.bl_idname, icon="TRASH")


classes = (
    CONVWASS_UL_map_pairs,
    CONVWASS_PT_soft_map,
    CONVWASS_PT_map_pairs,
    CONVWASS_PT_map_solver,
    CONVWASS_PT_map_transfer,
    CONVWASS_PT_map_view,
)
