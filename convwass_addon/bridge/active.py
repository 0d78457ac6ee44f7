# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is active and selected, also where there is no window: in timers and scripts a context has no such members."""

from __future__ import annotations

import bpy


def active_object(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the active object; None where there is none, or no window to look at."""
    return getattr(context, "object", None)


def selected_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the selected objects; none where there is no window to look at."""
    return list(getattr(context, "selected_objects", ()))
