# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The progress bar of the running job, above all other panels so that it is always visible."""

from __future__ import annotations

import bpy

from ..operators.background import CONVWASS_OT_stop
from .sidebar import ImageSidebar, Sidebar


class _Progress:
    """Progress of the running job, and a button to stop it."""

    # Has a header because Blender would otherwise move the panel and its tab before those of other add-ons.
    bl_label = "Progress"

    @classmethod
    def poll(cls, context):
        return context.window_manager.convwass_progress.running

    def draw(self, context):
        progress = context.window_manager.convwass_progress
        self.layout.progress(factor=progress.fraction, text=progress.message)
        self.layout.operator(CONVWASS_OT_stop.bl_idname, icon="CANCEL")


class CONVWASS_PT_progress(_Progress, Sidebar, bpy.types.Panel):
    """The running job"""

    bl_idname = "CONVWASS_PT_progress"


class CONVWASS_PT_image_progress(_Progress, ImageSidebar, bpy.types.Panel):
    """The running job"""

    bl_idname = "CONVWASS_PT_image_progress"


classes = (CONVWASS_PT_progress, CONVWASS_PT_image_progress)
