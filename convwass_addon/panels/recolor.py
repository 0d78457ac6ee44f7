# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels for recoloring images in the Image Editor and color attributes in the 3D viewport."""

from __future__ import annotations

import bpy

from ..applications.palettes.palette_settings import RecolorSettings
from ..bridge.palettes.image_kinds import is_clip
from ..operators.recolor_attribute import CONVWASS_OT_recolor_attribute
from ..operators.recolor_clip import CONVWASS_OT_recolor_clip
from ..operators.recolor_grade import CONVWASS_OT_build_grade_nodes, CONVWASS_OT_write_cube
from ..operators.recolor_image import CONVWASS_OT_recolor_image
from ..operators.recolor_targets import shown_image
from ..properties.recolor import PALETTES, CONVWASS_PG_recolor, RecolorProperties
from .from_schema import draw_settings
from .sidebar import ImageSidebar, Sidebar, draw_slots, fill_operator, large_button, with_labels_beside


class CONVWASS_PT_recolor_image(ImageSidebar, bpy.types.Panel):
    """Give an image the palette of another image, or a blend of several"""

    bl_label = "Recolor"
    bl_idname = "CONVWASS_PT_recolor_image"

    def draw(self, context):
        layout, own = self.layout, context.scene.convwass_recolor
        column = layout.column(align=True)
        column.label(text="Palette")
        draw_slots(column, own, PALETTES, len(own.chosen_palettes) > 1)
        layout.prop(own, "strength", slider=True)
        draw = _draw_clip if is_clip(shown_image(context)) else _draw_image
        draw(layout, own)


def _draw_image(layout: bpy.types.UILayout, own: CONVWASS_PG_recolor) -> None:
    """Draw the buttons for a still image."""
    large_button(layout, CONVWASS_OT_recolor_image, "COLOR", own, RecolorProperties).output = own.output
    layout.row().prop(own, "output", expand=True)


def _draw_clip(layout: bpy.types.UILayout, own: CONVWASS_PG_recolor) -> None:
    """Draw the buttons for a clip: recolor all frames, or try out the current one."""
    operator = large_button(layout, CONVWASS_OT_recolor_clip, "RENDER_ANIMATION", own, RecolorProperties)
    operator.folder = own.clip_folder
    layout.prop(own, "clip_folder")
    operator = layout.operator(CONVWASS_OT_recolor_image.bl_idname, text="Recolor This Frame", icon="COLOR")
    fill_operator(operator, own, RecolorProperties)
    operator.output = "NEW"


class CONVWASS_PT_recolor_settings(ImageSidebar, bpy.types.Panel):
    """Settings; the defaults suit most cases"""

    bl_label = "Recolor Settings"
    bl_idname = "CONVWASS_PT_recolor_settings"
    bl_parent_id = "CONVWASS_PT_recolor_image"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = with_labels_beside(self.layout), context.scene.convwass_recolor
        for name in ("mask", "palette_mask"):
            layout.prop(own, name)
        draw_settings(layout, own, RecolorSettings, "settings")
        draw_settings(layout, own, RecolorSettings, "image")


class CONVWASS_PT_recolor_grade(ImageSidebar, bpy.types.Panel):
    """Reuse the color map for a whole clip"""

    bl_label = "Grade to Reuse"
    bl_idname = "CONVWASS_PT_recolor_grade"
    bl_parent_id = "CONVWASS_PT_recolor_image"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = self.layout, context.scene.convwass_recolor
        layout.prop(own, "cube_size")
        for kind, icon in ((CONVWASS_OT_write_cube, "EXPORT"), (CONVWASS_OT_build_grade_nodes, "NODE_COMPOSITING")):
            operator = layout.operator(kind.bl_idname, icon=icon)
            fill_operator(operator, own, RecolorProperties)
            operator.cube_size = own.cube_size


class CONVWASS_PT_recolor_attribute(Sidebar, bpy.types.Panel):
    """Give a color attribute the palette of another object"""

    bl_label = "Recolor Attribute"
    bl_idname = "CONVWASS_PT_recolor_attribute"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = with_labels_beside(self.layout), context.scene.convwass_recolor
        layout.prop(own, "palette_object")
        layout.prop(own, "result")
        draw_settings(layout, own, RecolorSettings, "attribute")
        draw_settings(layout, own, RecolorSettings, "settings")
        operator = large_button(layout, CONVWASS_OT_recolor_attribute, "COLOR", own, RecolorProperties)
        # The edge radius is measured in pixels and does not apply to vertices.
        operator.edge_radius = 0
        operator.result = own.result


classes = (
    CONVWASS_PT_recolor_image,
    CONVWASS_PT_recolor_settings,
    CONVWASS_PT_recolor_grade,
    CONVWASS_PT_recolor_attribute,
)
