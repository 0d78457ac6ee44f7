# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""References to Blender's data that survive undo, renaming and deletion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..errors import ConvwassError


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

    def living(self, gone: ConvwassError) -> bpy.types.ID:
        """Return the data-block; raises the given error if it was deleted."""
        block = self.find()
        if block is None:
            raise gone
        return block


def found(handles: Sequence[Handle]) -> list[bpy.types.ID]:
    """Return the data-blocks that still exist."""
    return [block for block in found_or_none(handles) if block is not None]


def found_or_none(handles: Sequence[Handle]) -> list[bpy.types.ID | None]:
    """Return the data-block of every handle, or None if it was deleted; each list of the file is searched once."""
    there = {kind: _by_uid(kind, {own.uid for own in handles}) for kind in {own.kind for own in handles}}
    return [there[handle.kind].get(handle.uid) for handle in handles]


def _by_uid(kind: str, uids: set[int]) -> dict[int, bpy.types.ID]:
    """Return the data-blocks in ``bpy.data.<kind>`` that have one of these session ids."""
    return {uid: block for block in getattr(bpy.data, kind) if (uid := block.session_uid) in uids}
