# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The bar of what is being computed, above all other panels: it is there whichever of them are closed."""

from __future__ import annotations

import bpy

from ..operators.background import CONVWASS_OT_stop
from .sidebar import ImageSidebar, Sidebar


class _Progress:
    """How far it is, and a button that ends it."""

    # With a header: Blender would put a panel without one, and its tab, before those of everybody else.
    bl_label = "Progress"

    @classmethod
    def poll(cls, context):
        return context.window_manager.convwass_progress.running

    def draw(self, context):
        progress = context.window_manager.convwass_progress
        self.layout.progress(factor=progress.fraction, text=progress.message)
        self.layout.operator(CONVWASS_OT_stop.bl_idname, icon="CANCEL")


class CONVWASS_PT_progress(_Progress, Sidebar, bpy.types.Panel):
    """What is being computed"""

    bl_idname = "CONVWASS_PT_progress"


class CONVWASS_PT_image_progress(_Progress, ImageSidebar, bpy.types.Panel):
    """What is being computed"""

    bl_idname = "CONVWASS_PT_image_progress"


classes = (CONVWASS_PT_progress, CONVWASS_PT_image_progress)
