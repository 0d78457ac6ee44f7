# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels for blending materials and skies."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..applications.reflectance.reflectance_settings import ReflectanceSettings
from ..applications.reflectance.weight_sheets import MOST_ON_PAD
from ..applications.skies.sky_settings import SkySettings
from ..operators.reflectance_blend import CONVWASS_OT_blend_materials
from ..operators.reflectance_import import CONVWASS_OT_import_lobes
from ..operators.sky_blend import CONVWASS_OT_blend_skies
from ..properties.light import MATERIALS, WORLDS, CONVWASS_PG_reflectance, ReflectanceProperties, SkyProperties
from .from_schema import draw_settings
from .sidebar import Sidebar, draw_slots, draw_wrapped, large_button, slots, with_labels_beside

# The properties that each kind of blend uses.
_SPAN = ("blends", "frame_start", "frame_end")
_COUNTED = {"PATH": _SPAN, "KEYED": _SPAN, "WEIGHTS": (), "PAD": ("blends",)}


class CONVWASS_PT_light(Sidebar, bpy.types.Panel):
    """Blend materials and skies, so that highlights and suns move"""

    bl_label = "Light"
    bl_idname = "CONVWASS_PT_light"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw nothing; the subpanels have all the content."""


class CONVWASS_PT_reflectance(Sidebar, bpy.types.Panel):
    """Blend materials"""

    bl_label = "Materials"
    bl_idname = "CONVWASS_PT_reflectance"
    bl_parent_id = "CONVWASS_PT_light"

    def draw(self, context):
        layout, own = self.layout, context.scene.convwass_reflectance
        layout.prop(own, "blend", text="")
        draw_slots(layout.column(align=True), own, MATERIALS, own.blend in ("KEYED", "WEIGHTS"))
        hint = _missing(own)
        large_button(layout, CONVWASS_OT_blend_materials, "MATERIAL", own, ReflectanceProperties, hint is None)
        if hint is not None:
            draw_wrapped(layout, context, hint, "INFO")
        column = layout.column(align=True)
        for name in _COUNTED[own.blend]:
            column.prop(own, name)


def _missing(own: CONVWASS_PG_reflectance) -> str | None:
    """Return a hint what a blend of materials lacks, in the user's language, or None."""
    count = len(own.chosen_materials)
    if count < 2:
        return iface_("Choose at least two materials")
    if own.blend == "PAD" and count < 3:
        return iface_("A pad requires three or four materials, not {:d}").format(count)
    if own.blend == "PAD" and own.blends > MOST_ON_PAD:
        return iface_("A pad can have at most {:d} steps").format(MOST_ON_PAD)
    return None


class CONVWASS_PT_reflectance_settings(Sidebar, bpy.types.Panel):
    """Settings; the defaults suit most cases"""

    bl_label = "Material Settings"
    bl_idname = "CONVWASS_PT_reflectance_settings"
    bl_parent_id = "CONVWASS_PT_reflectance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = with_labels_beside(self.layout), context.scene.convwass_reflectance
        layout.prop(own, "output")
        layout.prop(own, "sun")
        draw_settings(layout, own, ReflectanceSettings, "settings")
        layout.prop(own, "table")
        layout.operator(CONVWASS_OT_import_lobes.bl_idname, icon="IMPORT")


class CONVWASS_PT_sky(Sidebar, bpy.types.Panel):
    """Blend skies"""

    bl_label = "Sky"
    bl_idname = "CONVWASS_PT_sky"
    bl_parent_id = "CONVWASS_PT_light"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = self.layout, context.scene.convwass_sky
        column = layout.column(align=True)
        for name in slots(own, WORLDS, least=2):
            column.prop(own, name, text="")
        is_ready = len(own.chosen_worlds) >= 2
        large_button(layout, CONVWASS_OT_blend_skies, "WORLD", own, SkyProperties, is_ready)
        if not is_ready:
            layout.label(text="Choose at least two worlds", icon="INFO")
        with_labels_beside(layout)
        for name in ("folder", "width", "frame_start", "frame_end"):
            layout.prop(own, name)
        draw_settings(layout, own, SkySettings, "sky")


classes = (CONVWASS_PT_light, CONVWASS_PT_reflectance, CONVWASS_PT_reflectance_settings, CONVWASS_PT_sky)
