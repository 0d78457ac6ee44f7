# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels for densities on the active mesh."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..applications.densities.density_settings import DensitySettings
from ..bridge.densities.density_player import density_value, played_densities
from ..bridge.densities.density_request import DensityRequest
from ..bridge.densities.density_store import stored_or_new
from ..errors import ConvwassError
from ..operators.density_changes import lost_inputs
from ..operators.density_manage import (
    CONVWASS_OT_bake_density,
    CONVWASS_OT_rebake_density,
    CONVWASS_OT_remove_density,
    CONVWASS_OT_show_density_material,
)
from ..operators.density_measure import (
    CONVWASS_OT_distance_from_vertices,
    CONVWASS_OT_measure_distance,
    CONVWASS_OT_measure_groups,
)
from ..operators.density_paint import (
    CONVWASS_OT_diffuse_density,
    CONVWASS_OT_drop_density,
    CONVWASS_OT_normalize_density,
    CONVWASS_OT_sharpen_density,
)
from ..operators.density_stops import (
    CONVWASS_OT_add_density_stop,
    CONVWASS_OT_clear_density_stops,
    CONVWASS_OT_move_density_stop,
    CONVWASS_OT_remove_density_stop,
)
from ..operators.density_travel import (
    CONVWASS_OT_blend_densities,
    CONVWASS_OT_interpolate_density,
    CONVWASS_OT_propagate_densities,
)
from ..operators.mesh_targets import length_text
from ..properties.densities import CONVWASS_PG_densities, OutputProperties, PathProperties, TravelProperties
from .from_schema import draw_settings
from .sidebar import Sidebar, draw_switch, draw_wrapped, fill_operator, large_button, with_labels_beside


class CONVWASS_UL_density_stops(bpy.types.UIList):
    """Stops: whether enabled, number, group and frame"""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        named = draw_switch(layout.row(align=True), item)
        number = named.row(align=True)
        number.ui_units_x = 0.9
        count = sum(stop.enabled for stop in list(data.stops)[:index])
        number.label(text=str(count) if item.enabled else "", translate=False)
        split = named.split(factor=0.65, align=True)
        split.prop_search(item, "group", context.object, "vertex_groups", text="")
        split.prop(item, "frame", text="")


class CONVWASS_PT_densities(Sidebar, bpy.types.Panel):
    """Paint densities on the active mesh, measure them, and move them along its surface"""

    bl_label = "Densities"
    bl_idname = "CONVWASS_PT_densities"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"

    def draw(self, context):
        layout, obj = self.layout, context.object
        active = obj.vertex_groups.active
        if active is None:
            layout.label(text="Paint a vertex group first", icon="INFO")
        else:
            layout.label(text=active.name, icon="GROUP_VERTEX", translate=False)
            _draw_figures(layout, context, obj, active.name)
        for name in played_densities(obj):
            _draw_played(layout, context, obj, name)


def _draw_figures(layout: bpy.types.UILayout, context: bpy.types.Context, obj: bpy.types.Object, group: str) -> None:
    """Show the last figures of the active group."""
    found = obj.convwass_density_findings
    if found.group != group:
        return
    column = layout.column(align=True)
    column.scale_y = 0.8
    for text in (
        iface_("Covers {:.1%} of the surface").format(found.covered),
        iface_("Radius {:s}").format(length_text(context.scene, found.radius)),
        iface_("Entropy {:.2f}").format(found.entropy),
    ):
        column.label(text=text, translate=False)


def _draw_played(layout: bpy.types.UILayout, context: bpy.types.Context, obj: bpy.types.Object, name: str) -> None:
    """Show the value of an animated density, and its missing inputs."""
    try:
        value = density_value(obj, name)
    except ConvwassError:
        # Its nodes were edited by hand.
        return
    layout.prop(value.owner, value.path, text=name, translate=False)
    lost = lost_inputs(obj, stored_or_new(obj, name))
    if lost:
        draw_wrapped(layout, context, iface_("Changed since it was made: {:s}").format(", ".join(lost)), "ERROR")


class _Subpanel(Sidebar):
    bl_parent_id = "CONVWASS_PT_densities"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        self.draw_tools(context, with_labels_beside(self.layout), context.object.convwass_density)


class _OfGroups(_Subpanel):
    """Base of panels that require painted groups."""

    @classmethod
    def poll(cls, context):
        return context.object is not None and bool(context.object.vertex_groups)


class CONVWASS_PT_density_paint(_Subpanel, bpy.types.Panel):
    """Tools on the active vertex group"""

    bl_label = "Paint"
    bl_idname = "CONVWASS_PT_density_paint"
    bl_options = set()

    def draw_tools(self, context, layout, own):
        layout.operator(CONVWASS_OT_normalize_density.bl_idname, icon="NORMALIZE_FCURVES")
        for operator, icon, setting in (
            (CONVWASS_OT_diffuse_density, "SMOOTHCURVE", "length"),
            (CONVWASS_OT_sharpen_density, "SHARPCURVE", "share"),
            (CONVWASS_OT_drop_density, "CURSOR", "radius"),
        ):
            column = layout.column(align=True)
            arguments = column.operator(operator.bl_idname, icon=icon)
            if setting == "share":
                arguments.to = "SHARE"
            setattr(arguments, setting, getattr(own, setting))
            column.prop(own, setting)


class CONVWASS_PT_density_measure(_OfGroups, bpy.types.Panel):
    """Distances along the surface"""

    bl_label = "Measure"
    bl_idname = "CONVWASS_PT_density_measure"

    def draw_tools(self, context, layout, own):
        _draw_pair(layout, context, own)
        operator = layout.operator(CONVWASS_OT_measure_distance.bl_idname, icon="DRIVER_DISTANCE")
        operator.first, operator.second = own.first, own.second
        operator.blur, operator.pieces = own.blur, own.pieces
        found = context.object.convwass_density_findings
        if found.first:
            text = iface_("From {:s} to {:s}: {:s}")
            text = text.format(found.first, found.second, length_text(context.scene, found.distance))
            draw_wrapped(layout, context, text, "CHECKMARK")
        layout.operator(CONVWASS_OT_measure_groups.bl_idname, icon="SPREADSHEET").blur = own.blur
        if found.table:
            layout.label(text=found.table, icon="TEXT", translate=False)
        layout.operator(CONVWASS_OT_distance_from_vertices.bl_idname, icon="FORCE_TURBULENCE").blur = own.blur
        layout.prop(own, "blur")


class CONVWASS_PT_density_interpolate(_OfGroups, bpy.types.Panel):
    """Move densities along the surface"""

    bl_label = "Interpolate"
    bl_idname = "CONVWASS_PT_density_interpolate"
    bl_options = set()

    def draw_tools(self, context, layout, own):
        if own.stops:
            _draw_stops(layout, own)
        else:
            _draw_pair(layout, context, own)
            layout.operator(CONVWASS_OT_add_density_stop.bl_idname, text="Make a List", icon="PRESET_NEW").which = "ALL"
        column = layout.column()
        column.prop(own, "density")
        draw_settings(column, own, DensitySettings, "path")
        draw_settings(column, own, DensityRequest, "path")
        column.prop(own, "add_material")
        operator = large_button(layout, CONVWASS_OT_interpolate_density, "ANIM", own, PathProperties)
        if not own.stops:
            operator.first, operator.second = own.first, own.second
        if own.stops:
            fill_operator(
                layout.operator(CONVWASS_OT_blend_densities.bl_idname, icon="MOD_VERTEX_WEIGHT"), own, TravelProperties
            )
            layout.prop(own, "edges")
            operator = layout.operator(CONVWASS_OT_propagate_densities.bl_idname, icon="CON_TRACKTO")
            fill_operator(operator, own, TravelProperties)
            operator.edges = own.edges


class CONVWASS_PT_density_solver(_Subpanel, bpy.types.Panel):
    """Settings; the defaults suit most cases"""

    bl_label = "Solver"
    bl_idname = "CONVWASS_PT_density_solver"
    bl_parent_id = "CONVWASS_PT_density_interpolate"

    def draw_tools(self, context, layout, own):
        draw_settings(layout, own, DensitySettings, "solver")


class CONVWASS_PT_density_output(_Subpanel, bpy.types.Panel):
    """Outputs of an animated density"""

    bl_label = "Output"
    bl_idname = "CONVWASS_PT_density_output"

    @classmethod
    def poll(cls, context):
        obj = context.object
        return obj is not None and obj.type == "MESH" and bool(played_densities(obj))

    def draw_tools(self, context, layout, own):
        layout.prop(own, "output")
        if own.output == "IMAGES":
            for name in ("folder", "size", "margin", "file_format"):
                layout.prop(own, name)
        names = played_densities(context.object)
        for name in names:
            column = layout.column(align=True)
            if len(names) > 1:
                column.label(text=name, translate=False)
            operator = column.operator(CONVWASS_OT_bake_density.bl_idname, icon="EXPORT")
            fill_operator(operator, own, OutputProperties)
            operator.density = name
            row = column.row(align=True)
            for kind, text in (("HEAT", "Heat Map"), ("MOSS", "Moss"), ("FROST", "Frost")):
                operator = row.operator(CONVWASS_OT_show_density_material.bl_idname, text=iface_(text), translate=False)
                operator.kind, operator.density = kind, name
            column.operator(CONVWASS_OT_rebake_density.bl_idname, icon="FILE_REFRESH").density = name
            column.operator(CONVWASS_OT_remove_density.bl_idname, icon="TRASH").density = name


def _draw_pair(layout: bpy.types.UILayout, context: bpy.types.Context, own: CONVWASS_PG_densities) -> None:
    column = layout.column()
    for name in ("first", "second"):
        column.prop_search(own, name, context.object, "vertex_groups")


def _draw_stops(layout: bpy.types.UILayout, own: CONVWASS_PG_densities) -> None:
    """Draw the list of stops with its buttons."""
    row = layout.row()
    row.template_list("CONVWASS_UL_density_stops", "", own, "stops", own, "active_stop", rows=5)
    column = row.column(align=True)
    column.operator_menu_enum(CONVWASS_OT_add_density_stop.bl_idname, "which", text="", icon="ADD")
    column.operator(CONVWASS_OT_remove_density_stop.bl_idname, text="", icon="REMOVE")
    column.separator()
    column.operator(CONVWASS_OT_move_density_stop.bl_idname, text="", icon="TRIA_UP").direction = "UP"
    column.operator(CONVWASS_OT_move_density_stop.bl_idname, text="", icon="TRIA_DOWN").direction = "DOWN"
    column.separator()
    column.operator(CONVWASS_OT_clear_density_stops.bl_idname, text="", icon="X")
    if own.active_stop < len(own.stops):
        layout.prop(own.stops[own.active_stop], "weight")


classes = (
    CONVWASS_UL_density_stops,
    CONVWASS_PT_densities,
    CONVWASS_PT_density_paint,
    CONVWASS_PT_density_measure,
    CONVWASS_PT_density_interpolate,
    CONVWASS_PT_density_solver,
    CONVWASS_PT_density_output,
)
