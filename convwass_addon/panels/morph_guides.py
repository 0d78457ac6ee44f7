# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel for the guides of a morph."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..operators.morph_guides import (
    CONVWASS_OT_add_morph_guide,
    CONVWASS_OT_clear_morph_guides,
    CONVWASS_OT_morph_guides_from_names,
    CONVWASS_OT_remove_morph_guide,
)
from ..properties.morph_inputs import CONVWASS_PG_morph
from ..translations import translated
from .sidebar import Sidebar, draw_numbered, draw_wrapped, with_labels_beside


class CONVWASS_UL_morph_guides(bpy.types.UIList):
    """Guides: whether enabled, number, name, and the shapes they are on"""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        row = layout.row(align=True)
        shown = draw_numbered(row, item, index)
        if problem := item.problem:
            shown.label(text=translated(problem), icon="ERROR", translate=False)
        else:
            shown.label(text=", ".join(item.named.points), translate=False)
        row.operator(CONVWASS_OT_remove_morph_guide.bl_idname, text="", icon="X", emboss=False).index = index


class CONVWASS_PT_morph_guides(Sidebar, bpy.types.Panel):
    """Corresponding points of the shapes"""

    bl_label = "Guides"
    bl_idname = "CONVWASS_PT_morph_guides"
    bl_parent_id = "CONVWASS_PT_morph"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, own = with_labels_beside(self.layout), context.scene.convwass_guides
        if own.items:
            row = layout.row()
            row.template_list("CONVWASS_UL_morph_guides", "", own, "items", own, "active", rows=3)
            column = row.column(align=True)
            column.operator(CONVWASS_OT_add_morph_guide.bl_idname, text="", icon="ADD")
            column.operator(CONVWASS_OT_remove_morph_guide.bl_idname, text="", icon="REMOVE")
            column.separator()
            column.operator(CONVWASS_OT_clear_morph_guides.bl_idname, text="", icon="X")
        layout.operator(CONVWASS_OT_add_morph_guide.bl_idname, icon="EYEDROPPER")
        layout.operator_menu_enum(CONVWASS_OT_morph_guides_from_names.bl_idname, "kind", icon="GROUP_VERTEX")
        if own.items:
            layout.prop(own, "show_labels")
            if unheeded := _unheeded(context.scene.convwass_morph):
                draw_wrapped(layout, context, unheeded, "INFO")


def _unheeded(settings: CONVWASS_PG_morph) -> str:
    """Return why guides have no effect, or an empty text."""
    if settings.motion in ("WARP", "TRANSPORT"):
        return iface_("Guides only have an effect if Motion is Automatic or Guided")
    return iface_("Guides have no effect at a coherence of 0") if settings.coherence == 0.0 else ""


classes = (CONVWASS_UL_morph_guides, CONVWASS_PT_morph_guides)
