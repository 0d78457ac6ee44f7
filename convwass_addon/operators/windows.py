# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Status bar texts and cursors of operators that wait for events."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy

from ..bridge.handles import Handle

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
