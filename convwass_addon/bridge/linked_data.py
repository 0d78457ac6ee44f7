# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Data of other .blend files."""

from __future__ import annotations

import bpy


def is_linked(block: bpy.types.ID) -> bool:
    """Return whether a data-block, or the one that it overrides, is linked from another file."""
    return block.library is not None or block.override_library is not None
