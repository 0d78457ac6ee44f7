# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels for choosing what to morph and how."""

from __future__ import annotations

import bpy
from bl_ui.utils import PresetPanel
from bpy.app.translations import pgettext_iface as iface_

from ..applications.memory import available_memory
from ..applications.morphs.memory_needs import estimated_bytes
from ..applications.morphs.morph_settings import MorphSettings
from ..bridge.flat.flat_kinds import looks_flat
from ..bridge.live.running import running_live
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.shape_sources import is_part, is_plain, separate_shapes, shape_sources
from ..operators.morph_bake import CONVWASS_OT_bake_morph
from ..operators.morph_inputs import (
    CONVWASS_OT_add_morph_inputs,
    CONVWASS_OT_check_morph_inputs,
    CONVWASS_OT_clear_morph_inputs,
    CONVWASS_OT_move_morph_input,
    CONVWASS_OT_remove_morph_input,
)
from ..operators.morph_manage import CONVWASS_OT_select_morph_inputs, active_morph
from ..properties.morph_inputs import CONVWASS_PG_morph
from ..properties.morphs import MorphProperties
from ..solver_presets import SUBFOLDER, CONVWASS_OT_add_solver_preset
from ..translations import translated
from .from_schema import draw_settings
from .sidebar import Sidebar, draw_switch, draw_wrapped, large_button, with_labels_beside

# Longest list of selected shapes that is shown in full.
_NAMED = 8
_NEEDED = {"GRID": 4, "TRIANGLE": 3}
# The memory of a bake is shown if it exceeds this many bytes.
_MUCH_MEMORY = 2e9
_ICONS = {
    "FONT": "OUTLINER_OB_FONT",
    "CURVE": "OUTLINER_OB_CURVE",
    "GREASEPENCIL": "OUTLINER_OB_GREASEPENCIL",
    "EMPTY": "IMAGE_DATA",
}


class CONVWASS_UL_inputs(bpy.types.UIList):
    """Shapes to morph: whether enabled, name, weight in a single blend, and problems"""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        named = draw_switch(layout.row(align=True), item)
        if item.object is None:
            named.prop(item, "object", text="")
        else:
            named.prop(item.object, "name", text="", emboss=False, icon=_icon(item.object))
        if item.warns:
            icon = "ERROR" if item.verdict in ("NO_VOLUME", "UNUSABLE") else "INFO"
            named.operator(CONVWASS_OT_check_morph_inputs.bl_idname, text="", icon=icon, emboss=False).index = index
        if data.used_layout == "BLEND":
            weight = named.row(align=True)
            weight.ui_units_x = 3.0
            weight.prop(item, "weight", text="")


class CONVWASS_PT_morph(Sidebar, bpy.types.Panel):
    """Choose shapes, frames and resolution, and bake"""

    bl_label = "Morph"
    bl_idname = "CONVWASS_PT_morph"

    @classmethod
    def poll(cls, context):
        # Hidden in Weight Paint mode, where the Densities panel comes first.
        return context.mode != "PAINT_WEIGHT"

    def draw(self, context):
        layout = with_labels_beside(self.layout)
        settings = context.scene.convwass_morph
        if settings.inputs:
            _draw_list(layout, settings)
            layout.prop(settings, "grouping")
            listed = [item.object for item in settings.enabled_inputs]
        else:
            listed = _draw_selection(layout, context, settings)
        count, shapes = len(listed), [obj for obj in listed if obj is not None]
        flat = 0 < count == len(shapes) and _are_flat(shapes, settings.grouping)

        column = layout.column()
        if settings.output != "SHAPE_KEYS":
            column.prop(settings, "layout")
        if settings.used_layout == "PATH":
            column.prop(settings, "frames")
        elif settings.used_layout != "BLEND":
            column.prop(settings, "steps")
        # The layout does not depend on the selection, so that buttons do not move under the mouse.
        column.prop(settings, "flat_resolution" if flat else "resolution")
        if flat:
            column.prop(settings, "words")
        if not flat:
            _draw_memory(column, context, shapes, settings.resolution)
        draw_settings(column, settings, MorphSettings, "motion")

        needed, problem = _NEEDED.get(settings.used_layout), settings.request().output_problem
        is_ready = problem is None and (count >= 2 if needed is None else count == needed)
        large_button(layout, CONVWASS_OT_bake_morph, "MOD_REMESH", settings, MorphProperties, is_ready)
        if problem is not None:
            draw_wrapped(layout, context, translated(problem), "INFO")
        # For fewer selected shapes, the selection box shows a hint.
        if needed is not None and count != needed and (count >= 2 or settings.inputs):
            text = iface_("This layout requires {:d} shapes, not {:d}").format(needed, count)
            draw_wrapped(layout, context, text, "INFO")
        elif count < 2 and settings.inputs:
            # Without a list, the selection box shows the hint.
            layout.label(text="Add at least two shapes to the list", icon="INFO")


def _draw_list(layout: bpy.types.UILayout, settings: CONVWASS_PG_morph) -> None:
    """Draw the list of inputs with its buttons."""
    row = layout.row()
    row.template_list("CONVWASS_UL_inputs", "", settings, "inputs", settings, "active_input", rows=5)
    column = row.column(align=True)
    column.operator(CONVWASS_OT_add_morph_inputs.bl_idname, text="", icon="ADD")
    column.operator(CONVWASS_OT_remove_morph_input.bl_idname, text="", icon="REMOVE")
    column.separator()
    column.operator(CONVWASS_OT_move_morph_input.bl_idname, text="", icon="TRIA_UP").direction = "UP"
    column.operator(CONVWASS_OT_move_morph_input.bl_idname, text="", icon="TRIA_DOWN").direction = "DOWN"
    column.separator()
    column.operator(CONVWASS_OT_check_morph_inputs.bl_idname, text="", icon="FILE_REFRESH")
    column.operator(CONVWASS_OT_clear_morph_inputs.bl_idname, text="", icon="X")


def _draw_selection(
    layout: bpy.types.UILayout, context: bpy.types.Context, settings: CONVWASS_PG_morph
) -> list[bpy.types.Object]:
    """Draw the selected shapes, which are morphed if there is no list, and return them."""
    names = {own.root: own.name for own in separate_shapes(context.selected_objects, settings.grouping)}
    shapes = settings.sorted_shapes(list(names))
    box = layout.box().column(align=True)
    objects = sum(map(is_part, context.selected_objects))
    if objects > 2 or (shapes and objects != len(shapes)):
        text = iface_("{:d} selected objects: {:d} shapes").format(objects, len(shapes))
        box.label(text=text, icon="INFO", translate=False)
    if len(shapes) < 2:
        box.label(text=_hint(context, settings.used_layout), icon="INFO", translate=False)
        # After a bake, a frame is selected and the shapes are hidden.
        if active_morph(context) is not None:
            box.operator(CONVWASS_OT_select_morph_inputs.bl_idname, icon="RESTRICT_SELECT_OFF")
    for index, obj in enumerate(shapes[:_NAMED]):
        box.label(
            text=names[obj],
            icon=_icon(obj) if index == 0 else "FORWARD",
            translate=False,
        )
    if len(shapes) > _NAMED:
        box.label(text=iface_("and {:d} more").format(len(shapes) - _NAMED), icon="BLANK1", translate=False)
    column = layout.column()
    column.prop(settings, "grouping")
    row = column.row(align=True)
    row.prop(settings, "order")
    row.prop(settings, "reverse", text="", icon="UV_SYNC_SELECT")
    column.operator(CONVWASS_OT_add_morph_inputs.bl_idname, text="Make a List", icon="PRESET_NEW")
    return shapes


def _are_flat(shapes: list[bpy.types.Object], grouping: str) -> bool:
    # Whether they look flat comes first, since it mostly is the answer and needs no other objects.
    return all(map(looks_flat, shapes)) and all(map(is_plain, shape_sources(shapes, grouping)))


def _draw_memory(
    layout: bpy.types.UILayout, context: bpy.types.Context, shapes: list[bpy.types.Object], resolution: int
) -> None:
    """Show how much memory a bake takes, if it is much, with a warning if less is free."""
    if len(shapes) < 2:
        return
    # A bake uses as many threads as fit in memory, at least one.
    needed = estimated_bytes([obj.dimensions for obj in shapes], resolution, workers=1)
    if needed < _MUCH_MEMORY:
        return
    free = available_memory()
    text, icon = iface_("Takes about {:.0f} GB of memory").format(needed / 1e9), "INFO"
    if free is not None and needed > free:
        text = iface_("Takes about {:.0f} GB of memory, {:.0f} GB are free").format(needed / 1e9, free / 1e9)
        icon = "ERROR"
    draw_wrapped(layout, context, text, icon)


def _hint(context: bpy.types.Context, layout: str) -> str:
    """Return a hint how many shapes a layout requires, in the user's language."""
    if context.window_manager.convwass_progress.running or running_live() is not None:
        return iface_("The shapes are hidden meanwhile")
    if layout == "GRID":
        return iface_("Select four shapes")
    if layout == "TRIANGLE":
        return iface_("Select three shapes")
    return iface_("Select at least two shapes")


def _icon(obj: bpy.types.Object) -> str:
    return _ICONS.get(obj.type, "MESH_DATA")


class _Subpanel(Sidebar):
    bl_parent_id = "CONVWASS_PT_morph"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        self.draw_settings(with_labels_beside(self.layout), context.scene.convwass_morph)


class CONVWASS_PT_morph_placement(_Subpanel, bpy.types.Panel):
    """How the shapes are aligned with each other"""

    bl_label = "Matching"
    bl_idname = "CONVWASS_PT_morph_placement"

    def draw_settings(self, layout, settings):
        draw_settings(layout, settings, MorphRequest, "matching")
        draw_settings(layout, settings, MorphSettings, "matching")


class CONVWASS_PT_morph_timing(_Subpanel, bpy.types.Panel):
    """Start of the morph, and how often its mesh changes"""

    bl_label = "Timing"
    bl_idname = "CONVWASS_PT_morph_timing"

    @classmethod
    def poll(cls, context):
        return context.scene.convwass_morph.used_layout == "PATH"

    def draw_settings(self, layout, settings):
        of_frames = settings.output != "SHAPE_KEYS"
        if of_frames:
            layout.prop(settings, "follow")
        layout.prop(settings, "start")
        if settings.start == "CUSTOM":
            layout.prop(settings, "frame_start", text="Frame")
        if of_frames:
            layout.prop(settings, "frame_step")
        layout.prop(settings, "fit_range")


class CONVWASS_PT_morph_output(_Subpanel, bpy.types.Panel):
    """Result of a bake in the scene"""

    bl_label = "Output"
    bl_idname = "CONVWASS_PT_morph_output"

    def draw_settings(self, layout, settings):
        layout.prop(settings, "output", text="Type")
        if settings.output == "OBJECTS":
            layout.prop(settings, "flat_output")
        if settings.output == "PLAYER":
            layout.prop(settings, "between")
        if settings.output == "SHAPE_KEYS":
            layout.prop(settings, "basis")
            layout.prop(settings, "key_error")
            layout.prop(settings, "two_meshes")
            row = layout.row()
            row.active = not settings.two_meshes
            row.prop(settings, "symmetric")
        elif settings.output != "VOLUME":
            layout.prop(settings, "faces")
        pictures = settings.output == "OBJECTS" and settings.flat_output == "PICTURE"
        if pictures:
            layout.prop(settings, "grays")
        if pictures or settings.output in ("VOLUME", "CACHE"):
            layout.prop(settings, "folder")
        if settings.output == "CACHE":
            layout.prop(settings, "cache_format")
        column = layout.column()
        column.prop(settings, "hide_inputs")
        draw_settings(column, settings, MorphSettings, "output")
        row = layout.row()
        row.active = settings.carry
        row.prop(settings, "looks")


class CONVWASS_PT_solver_presets(PresetPanel, bpy.types.Panel):
    """Named settings of the solver"""

    bl_label = "Solver Presets"
    preset_subdir = SUBFOLDER
    preset_operator = "script.execute_preset"
    preset_add_operator = CONVWASS_OT_add_solver_preset.bl_idname


class CONVWASS_PT_morph_solver(_Subpanel, bpy.types.Panel):
    """Settings; the defaults suit most cases"""

    bl_label = "Solver"
    bl_idname = "CONVWASS_PT_morph_solver"

    def draw_header_preset(self, context):
        CONVWASS_PT_solver_presets.draw_panel_header(self.layout)

    def draw_settings(self, layout, settings):
        draw_settings(layout, settings, MorphSettings, "solver")


classes = (
    CONVWASS_UL_inputs,
    CONVWASS_PT_morph,
    CONVWASS_PT_morph_placement,
    CONVWASS_PT_morph_timing,
    CONVWASS_PT_morph_output,
    CONVWASS_PT_solver_presets,
    CONVWASS_PT_morph_solver,
)
