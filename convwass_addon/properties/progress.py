# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""State of the running job, shown by panels and used by Stop."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, FloatProperty, PointerProperty, StringProperty


class CONVWASS_PG_progress(bpy.types.PropertyGroup):
    """The running job of a window manager, if any."""

    running: BoolProperty(name="Running", description="Whether a job is running")
    fraction: FloatProperty(name="Progress", description="Share of the work that is finished", min=0.0, max=1.0)
    message: StringProperty(name="Message", description="Current step of the job")
    stopping: BoolProperty(name="Stopping", description="Whether the job was asked to stop")


def register() -> None:
    """Add the progress to the window manager."""
    bpy.utils.register_class(CONVWASS_PG_progress)
    bpy.types.WindowManager.convwass_progress = PointerProperty(type=CONVWASS_PG_progress)
    # Values outlive the add-on, but jobs do not.
    progress = bpy.context.window_manager.convwass_progress
    progress.running = progress.stopping = False


def unregister() -> None:
    """Remove it."""
    del bpy.types.WindowManager.convwass_progress
    bpy.utils.unregister_class(CONVWASS_PG_progress)
