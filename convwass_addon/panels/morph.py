# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The morph panel in the sidebar of the 3D viewport."""

from __future__ import annotations

import bpy

from ..operators.bake_morph import CONVWASS_OT_bake_morph
from ..operators.manage_morph import (
    CONVWASS_OT_delete_morph,
    CONVWASS_OT_select_morph_inputs,
    active_morph,
)
from ..properties import MorphProperties


class _Sidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Convwass"


class CONVWASS_PT_morph(_Sidebar, bpy.types.Panel):
    """Select shapes, set frames and resolution, bake"""

    bl_label = "Morph"
    bl_idname = "CONVWASS_PT_morph"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.convwass_morph
        shapes = settings.sorted_shapes([obj for obj in context.selected_objects if obj.type == "MESH"])

        box = layout.box().column(align=True)
        if len(shapes) < 2:
            box.label(text="Select two or more meshes", icon="INFO")
        for index, obj in enumerate(shapes):
            box.label(text=obj.name, icon="MESH_DATA" if index == 0 else "FORWARD")

        column = layout.column()
        row = column.row(align=True)
        row.prop(settings, "order")
        row.prop(settings, "reverse", text="", icon="UV_SYNC_SELECT")
        column.prop(settings, "layout")
        column.prop(settings, "frames" if settings.layout == "PATH" else "steps")
        column.prop(settings, "resolution")
        column.prop(settings, "parts")
        column.prop(settings, "hide_inputs")

        progress = context.window_manager.convwass_progress
        if progress.running:
            layout.progress(factor=progress.fraction, text=progress.message)
            layout.label(text="Esc in the viewport stops it", icon="CANCEL")
            return
        row = layout.row()
        row.scale_y = 1.6
        operator = row.operator(CONVWASS_OT_bake_morph.bl_idname, icon="MOD_REMESH")
        for name in MorphProperties.__annotations__:
            setattr(operator, name, getattr(settings, name))


class CONVWASS_PT_morph_solver(_Sidebar, bpy.types.Panel):
    """Settings with good defaults"""

    bl_label = "Solver"
    bl_idname = "CONVWASS_PT_morph_solver"
    bl_parent_id = "CONVWASS_PT_morph"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.convwass_morph
        for switch, value in (("use_custom_blur", "blur"), ("use_custom_sharpness", "sharpness")):
            row = layout.row(align=True, heading=settings.bl_rna.properties[value].name)
            row.prop(settings, switch, text="")
            field = row.row(align=True)
            field.active = getattr(settings, switch)
            field.prop(settings, value, text="")
        layout.prop(settings, "locality")
        layout.prop(settings, "entropy_limit")
        if settings.entropy_limit == "NUMBER":
            layout.prop(settings, "entropy_bound")
        layout.prop(settings, "level")
        column = layout.column(heading="Surface")
        column.active = settings.level == "volume"
        column.prop(settings, "thin_parts")
        column.prop(settings, "mend")
        layout.prop(settings, "thickness")


class CONVWASS_PT_baked_morph(_Sidebar, bpy.types.Panel):
    """The morph that the active object belongs to"""

    bl_label = "Baked Morph"
    bl_idname = "CONVWASS_PT_baked_morph"

    @classmethod
    def poll(cls, context):
        return active_morph(context) is not None

    def draw(self, context):
        layout = self.layout
        layout.label(text=active_morph(context).name, icon="OUTLINER_COLLECTION")
        column = layout.column(align=True)
        column.operator(CONVWASS_OT_select_morph_inputs.bl_idname, icon="RESTRICT_SELECT_OFF")
        column.operator(CONVWASS_OT_delete_morph.bl_idname, icon="TRASH")


classes = (CONVWASS_PT_morph, CONVWASS_PT_morph_solver, CONVWASS_PT_baked_morph)
