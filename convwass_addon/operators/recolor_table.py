# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The work of making a table of a map of colors, and a file of the table."""

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

# Shares of the job that are done once the map is there, and once the table is.
_MAPPED, _TABULATED = 0.5, 0.7


@dataclass(frozen=True)
class CubeFile:
    """A .cube file to write: where, and what other programs call its table."""

    path: Path
    title: str


class TableJob:
    """One table. Everything but :meth:`steps` belongs on the main thread.

    Parameters
    ----------
    job : RecolorJob or ClipJob
        What finds the map, and ends with it.
    size : int
        Colors along an edge.
    target : CubeFile or None
        The file that the table becomes; what is there already stays until :meth:`keep`.
    """

    def __init__(self, job: RecolorJob | ClipJob, size: int, target: CubeFile | None) -> None:
        self._job, self._size, self._target = job, size, target
        self._drafts = DraftFiles()
        self.table: LookupTable | None = None

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Find the map, and make and write its table."""
        from ..applications.palettes.lookup_table import lookup_table, write_cube

        yield from within(self._job.steps(control), 0.0, _MAPPED)
        yield Progress(_MAPPED, Sentence("Making the table"))
        table = lookup_table(self._job.change, self._size)
        if self._target is not None:
            yield Progress(_TABULATED, Sentence("Writing the table"))
            write_cube(table, self._drafts.draft_of(self._target.path), self._target.title, control)
        self.table = table

    def write(self, report: Progress[object]) -> None:
        """Answer the requests of the job that finds the map."""
        self._job.write(report)

    def keep(self) -> None:
        """Put the file into its place; raises ConvwassError where the system refuses."""
        try:
            self._drafts.keep()
        finally:
            self.discard()

    def discard(self) -> None:
        """Leave everything as it was."""
        self._drafts.discard()
        self._job.discard()
