# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the jobs of flat morphs do alike with frames that are computed."""

from __future__ import annotations

import bpy

from ...applications.flat.flat_frames import FlatFrame
from ...progress import Progress
from ..morphs.bake import MorphBake


class WritesFlatFrames:
    """A job that hands its frames to a bake; everything here belongs on the main thread.

    Attributes
    ----------
    records : list of dict
        Figures of the frames that have been written.
    """

    records: list[dict[str, object]]

    _bake: MorphBake

    def write(self, report: Progress[FlatFrame]) -> None:
        """Put a finished frame into the scene."""
        if report.payload is not None:
            self._bake.add(report.payload)
            self.records.append(report.payload.record)

    def finish(self, hide_inputs: bool) -> bpy.types.Collection:
        """Make what has been written a morph; see :meth:`.bake.MorphBake.finish`."""
        return self._bake.finish(hide_inputs)

    @property
    def span(self) -> tuple[float, float] | None:
        """When it plays; see :attr:`.bake.MorphBake.span`."""
        return self._bake.span

    def discard(self) -> None:
        """Remove everything that has been written."""
        self._bake.discard()
