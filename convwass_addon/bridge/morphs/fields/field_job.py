# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sample the blends of a morph for a player or a pad on another thread; the file is only changed at the end."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from ....errors import InputError
from ....progress import Control, Progress
from ...handles import Handle
from ..stored import frame_objects, interpolates
from .field_sampling import SampledFields, read_blends, sample_fields


class FieldJob:
    """Work on the fields of a morph, which may be edited or deleted in the meantime.

    Parameters
    ----------
    morph : bpy.types.Collection
        The morph.
    between : "NEAREST" or "INTERPOLATED"
        What to show between two blends; there is nothing to do for the nearest one, nor for flat shapes.

    Attributes
    ----------
    sampled : SampledFields or None
        The result.
    """

    def __init__(self, morph: bpy.types.Collection, between: str) -> None:
        frames = frame_objects(morph)
        self._morph, self._frames = Handle.of("collections", morph), _uids(frames)
        self._blends = read_blends(morph, frames) if interpolates(morph, between) else None
        self.sampled: SampledFields | None = None

    def steps(self, control: Control) -> Iterator[Progress[Any]]:
        """Sample the fields."""
        if self._blends is not None:
            self.sampled = yield from sample_fields(self._blends, control)

    def write(self, report: Progress[Any]) -> None:
        """Do nothing; the file is only changed at the end."""

    def discard(self) -> None:
        """Do nothing; nothing was written."""

    def morph(self) -> bpy.types.Collection:
        """Return the morph; raises InputError if it, or one of its frames, was deleted in the meantime."""
        if not self.is_current:
            raise InputError("The morph was deleted or changed during the computation; start again.")
        return self._morph.find()

    @property
    def is_current(self) -> bool:
        """Whether the morph still has the same frames."""
        found = self._morph.find()
        return found is not None and _uids(frame_objects(found)) == self._frames


def _uids(frames: list[bpy.types.Object]) -> list[int]:
    return [obj.session_uid for obj in frames]
