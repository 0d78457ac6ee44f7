# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared methods of the jobs for flat morphs."""

from __future__ import annotations

import bpy

from ...applications.flat.flat_frames import FlatFrame
from ...progress import Progress
from ..morphs.bake import MorphBake


class WritesFlatFrames:
    """Base of jobs that pass frames to a bake; all methods must be called on the main thread.

    Attributes
    ----------
    records : list of dict
        The solver's figures of the frames written so far.
    """

    records: list[dict[str, object]]

    _bake: MorphBake

    def write(self, report: Progress[FlatFrame]) -> None:
        """Add a finished frame to the scene."""
        if report.payload is not None:
            self._bake.add(report.payload)
            self.records.append(report.payload.record)

    def finish(self, hide_inputs: bool) -> bpy.types.Collection:
        """Finish the bake; see :meth:`.bake.MorphBake.finish`."""
        return self._bake.finish(hide_inputs)

    @property
    def span(self) -> tuple[float, float] | None:
        """First and last frame; see :attr:`.bake.MorphBake.span`."""
        return self._bake.span

    def discard(self) -> None:
        """Remove everything written so far."""
        self._bake.discard()
