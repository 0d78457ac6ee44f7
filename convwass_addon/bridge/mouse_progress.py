# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Show the progress of work that blocks Blender's window, at the mouse pointer."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bpy


@contextmanager
def progress_at_mouse() -> Iterator[Callable[[float], None]]:
    """Provide a function that shows a fraction, 0 to 1, until the block is left."""
    manager = bpy.context.window_manager
    manager.progress_begin(0, 100)
    try:
        yield lambda fraction: manager.progress_update(int(100 * fraction))
    finally:
        manager.progress_end()
