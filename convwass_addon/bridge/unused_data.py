# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove data-blocks that nothing uses any more."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy


def remove_if_unused(blocks: Iterable[bpy.types.ID | None]) -> None:
    """Remove those of some data-blocks that nothing uses; None stands for one that is missing."""
    bpy.data.batch_remove({block for block in blocks if block is not None and not block.users})


def remove_with_data(objects: Sequence[bpy.types.Object]) -> None:
    """Remove objects, with the data and actions that nothing else uses."""
    actions = [obj.animation_data.action for obj in objects if obj.animation_data]
    spare = [*(obj.data for obj in objects), *actions]
    bpy.data.batch_remove(objects)
    remove_if_unused(spare)
