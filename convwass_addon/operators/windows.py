# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators that wait for events leave on windows: a text in the status bar, and another cursor."""

from __future__ import annotations

import bpy


def clear_windows(context: bpy.types.Context) -> None:
    """Give every window its own status bar and cursor back."""
    for window in context.window_manager.windows:
        window.cursor_modal_restore()
        with context.temp_override(window=window):
            context.workspace.status_text_set(None)
