# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators that wait for events leave on windows: a text in the status bar, and another cursor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy

from ..bridge.handles import Handle

# Workspaces whose status bar shows a text of an operator here: every workspace has its own.
_WRITTEN: set[Handle] = set()


def write_status(context: bpy.types.Context, text: str) -> None:
    """Show a text in the status bar of the workspace that is seen, and no longer in one that the user has left."""
    now = Handle.of("workspaces", context.workspace)
    _clear_others(context, _WRITTEN - {now})
    _WRITTEN.add(now)
    context.workspace.status_text_set(text)


def clear_status(context: bpy.types.Context) -> None:
    """Give the status bar back, in all workspaces."""
    if context.workspace:
        context.workspace.status_text_set(None)
        _WRITTEN.discard(Handle.of("workspaces", context.workspace))
    _clear_others(context, _WRITTEN)


def _clear_others(context: bpy.types.Context, workspaces: Iterable[Handle]) -> None:
    for handle in tuple(workspaces):
        _WRITTEN.discard(handle)
        workspace = handle.find()
        if workspace is not None:
            # Whichever workspace is asked, Blender sets the text of the context's.
            with context.temp_override(workspace=workspace):
                workspace.status_text_set(None)


def clear_windows(context: bpy.types.Context) -> None:
    """Give every window its own status bar and cursor back."""
    for window in context.window_manager.windows:
        window.cursor_modal_restore()
        with context.temp_override(window=window):
            clear_status(context)


@contextmanager
def busy_cursor(context: bpy.types.Context) -> Iterator[None]:
    """Show that Blender is busy, where there is a window, while something takes a few seconds."""
    window = context.window
    if window is None:
        yield
        return
    window.cursor_modal_set("WAIT")
    try:
        yield
    finally:
        window.cursor_modal_restore()
