# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tabulate a color map, and write the table to a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..drafts import DraftFiles
from ..progress import UNINTERRUPTED, Control, Progress, Work, within
from ..sentence import Sentence
from .recolor_clip import ClipJob
from .recolor_image import RecolorJob

if TYPE_CHECKING:
    from ..applications.palettes.lookup_table import LookupTable

# Shares of the progress at which the map and the table are finished.
_MAPPED, _TABULATED = 0.5, 0.7


@dataclass(frozen=True)
class CubeFile:
    """A .cube file to write, and the title of its table."""

    path: Path
    title: str


class TableJob:
    """Computes a table. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    job : RecolorJob or ClipJob
        Computes the color map.
    size : int
        Number of colors along an edge.
    target : CubeFile or None
        The file to write; an existing file is only replaced by :meth:`keep`.
    """

    def __init__(self, job: RecolorJob | ClipJob, size: int, target: CubeFile | None) -> None:
        self._job, self._size, self._target = job, size, target
        self._drafts = DraftFiles()
        self.table: LookupTable | None = None

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the color map, tabulate it and write the table."""
        from ..applications.palettes.lookup_table import lookup_table, write_cube

        yield from within(self._job.steps(control), 0.0, _MAPPED)
        yield Progress(_MAPPED, Sentence("Making the table"))
        table = lookup_table(self._job.change, self._size)
        if self._target is not None:
            yield Progress(_TABULATED, Sentence("Writing the table"))
            write_cube(table, self._drafts.draft_of(self._target.path), self._target.title, control)
        self.table = table

    def write(self, report: Progress[object]) -> None:
        """Answer the requests of the job that computes the map."""
        self._job.write(report)

    def keep(self) -> None:
        """Move the file into place; raises ConvwassError if that fails."""
        try:
            self._drafts.keep()
        finally:
            self.discard()

    def discard(self) -> None:
        """Remove drafts and temporary data."""
        self._drafts.discard()
        self._job.discard()
