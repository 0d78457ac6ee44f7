# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""References to Blender's data that survive undo, renaming and deletion."""

from __future__ import annotations

from dataclasses import dataclass

import bpy


@dataclass(frozen=True)
class Handle:
    """Refers to a data-block by its session id; Python references may become invalid after undo.

    Attributes
    ----------
    kind : str
        Name of the collection in `bpy.data`, such as "objects".
    uid : int
        Session id of the data-block.
    """

    kind: str
    uid: int

    @classmethod
    def of(cls, kind: str, block: bpy.types.ID) -> Handle:
        """Make a handle of a data-block in ``bpy.data.<kind>``."""
        return cls(kind, block.session_uid)

    def find(self) -> bpy.types.ID | None:
        """Return the data-block, or None if it was deleted."""
        return next((block for block in getattr(bpy.data, self.kind) if block.session_uid == self.uid), None)


def found(handles: list[Handle]) -> list[bpy.types.ID]:
    """Return the data-blocks that still exist."""
    return [block for block in (handle.find() for handle in handles) if block is not None]
