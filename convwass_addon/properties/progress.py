# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of running work, which panels show and Stop ends."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, FloatProperty, PointerProperty, StringProperty


class CONVWASS_PG_progress(bpy.types.PropertyGroup):
    """The work that is going on in this window manager, if any."""

    running: BoolProperty(name="Running", description="Whether something is being computed")
    fraction: FloatProperty(name="Progress", description="Share of the work that is done", min=0.0, max=1.0)
    message: StringProperty(name="Message", description="What is being done")
    stopping: BoolProperty(name="Stopping", description="Whether the work has been asked to stop")


def register() -> None:
    """Add the progress to the window manager."""
    bpy.utils.register_class(CONVWASS_PG_progress)
    bpy.types.WindowManager.convwass_progress = PointerProperty(type=CONVWASS_PG_progress)
    # Values outlive the add-on, and what was running then runs no more.
    progress = bpy.context.window_manager.convwass_progress
    progress.running = progress.stopping = False


def unregister() -> None:
    """Take it away."""
    del bpy.types.WindowManager.convwass_progress
    bpy.utils.unregister_class(CONVWASS_PG_progress)
