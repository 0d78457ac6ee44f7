# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Status bar texts, cursors and redraws for operators that wait for events."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy

from ..bridge.handles import Handle

# Editors with panels of the add-on.
_WITH_SIDEBAR = ("VIEW_3D", "IMAGE_EDITOR")

# Workspaces whose status bar shows a text of an operator; every workspace has its own.
_WRITTEN: set[Handle] = set()


def write_status(context: bpy.types.Context, text: str) -> None:
    """Show a text in the status bar of the current workspace, and remove it from others."""
    now = Handle.of("workspaces", context.workspace)
    _clear_others(context, _WRITTEN - {now})
    _WRITTEN.add(now)
    context.workspace.status_text_set(text)


def clear_status(context: bpy.types.Context) -> None:
    """Restore the status bar of all workspaces."""
    if context.workspace:
        context.workspace.status_text_set(None)
        _WRITTEN.discard(Handle.of("workspaces", context.workspace))
    _clear_others(context, _WRITTEN)


def _clear_others(context: bpy.types.Context, workspaces: Iterable[Handle]) -> None:
    for handle in tuple(workspaces):
        _WRITTEN.discard(handle)
        workspace = handle.find()
        if workspace is not None:
            # Blender sets the text of the context's workspace, whichever workspace is called.
            with context.temp_override(workspace=workspace):
                workspace.status_text_set(None)


def clear_windows(context: bpy.types.Context) -> None:
    """Restore the status bar and cursor of every window."""
    for window in context.window_manager.windows:
        window.cursor_modal_restore()
        with context.temp_override(window=window):
            clear_status(context)


def redraw_sidebars(context: bpy.types.Context) -> None:
    """Redraw the sidebars of a window: redrawing shapes may be slow, and changed data triggers it anyway."""
    for area in context.window.screen.areas:
        for region in area.regions if area.type in _WITH_SIDEBAR else ():
            if region.type == "UI":
                region.tag_redraw()


def redraw_window(context: bpy.types.Context) -> None:
    """Redraw a window, if there is one."""
    for area in context.window.screen.areas if context.window else ():
        area.tag_redraw()


@contextmanager
def busy_cursor(context: bpy.types.Context) -> Iterator[None]:
    """Show a busy cursor during short work, if there is a window."""
    window = context.window
    if window is None:
        yield
        return
    window.cursor_modal_set("WAIT")
    try:
        yield
    finally:
        window.cursor_modal_restore()
