# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of live morphs."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..bridge.live.running import running_live
from ..operators.live_morph import (
    CONVWASS_OT_bake_live_morph,
    CONVWASS_OT_end_live_morph,
    CONVWASS_OT_keep_live_shape,
    CONVWASS_OT_live_morph,
)
from ..properties.live import LiveProperties
from ..properties.morphs import MorphProperties
from ..translations import translated
from .sidebar import Sidebar, draw_wrapped, fill_operator, large_button, with_labels_beside


class CONVWASS_PT_live(Sidebar, bpy.types.Panel):
    """Blend shapes live"""

    bl_label = "Live Morph"
    bl_idname = "CONVWASS_PT_live"

    @classmethod
    def poll(cls, context):
        return context.mode != "PAINT_WEIGHT"

    def draw(self, context):
        layout = with_labels_beside(self.layout)
        session = running_live()
        if session is None:
            settings = context.scene.convwass_live
            column = layout.column()
            column.prop(settings, "live_resolution")
            column.prop(settings, "live_memory")
            own = context.scene.convwass_morph
            operator = large_button(layout, CONVWASS_OT_live_morph, "PLAY", own, MorphProperties)
            fill_operator(operator, settings, LiveProperties)
            return
        handle = context.window_manager.convwass_live
        column = layout.column(align=True)
        if session.count == 2:
            column.prop(handle, "morph", slider=True)
        else:
            column.prop(handle, "across", slider=True)
            column.prop(handle, "up", slider=True)
            for name, weight in zip(session.names, session.weights, strict=True):
                column.label(text=f"{name}: {weight:.0%}", translate=False)
        layout.progress(factor=session.fraction, text=translated(session.message))
        for notice in session.notices:
            draw_wrapped(layout, context, translated(notice), "INFO")
        column = layout.column(align=True)
        column.operator(CONVWASS_OT_keep_live_shape.bl_idname, icon="DUPLICATE")
        column.operator(CONVWASS_OT_bake_live_morph.bl_idname, icon="MOD_REMESH")
        column.operator(CONVWASS_OT_end_live_morph.bl_idname, icon="X", text=iface_("End"))


classes = (CONVWASS_PT_live,)
