# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The active object and the selection; without a window, as in timers, the context lacks these members."""

from __future__ import annotations

import bpy


def active_object(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the active object, or None."""
    return getattr(context, "object", None)


def selected_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the selected objects; empty without a window."""
    return list(getattr(context, "selected_objects", ()))
