# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blend skies frame by frame: computed on a thread, written on the main thread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...applications.skies.sky_frames import Skies, SkyFrame
from ...applications.skies.sky_settings import SkySettings
from ...drafts import DraftFiles
from ...errors import ConvwassError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..files.numbered_files import file_number, numbered_paths
from ..files.output_paths import checked_folder
from .sky_pixels import write_sky

# Fraction of the work spent on finding the suns.
_PREPARING = 0.1


@dataclass(frozen=True)
class PlacedSky:
    """A finished sky.

    Attributes
    ----------
    place : int
        Index in the sequence, from 0.
    frame : SkyFrame
        The sky.
    """

    place: int
    frame: SkyFrame


def fitting_height(width: int, settings: SkySettings) -> int:
    """Return a height near the requested width, such that the size is a multiple of the grid for the transport."""
    return max(round(width / 2 / settings.rows), 1) * settings.rows


def sky_steps(
    ends: Sequence[NDArray[np.float64]],
    count: int,
    settings: SkySettings,
    control: Control = UNINTERRUPTED,
) -> Work[None]:
    """Interpolate through two or more skies at `count` equidistant times, including both ends.

    Yields
    ------
    Progress
        Payloads are finished skies as :class:`PlacedSky`, in order.

    Raises
    ------
    InputError
        Invalid skies; see :class:`...applications.skies.sky_frames.Skies`.
    """
    leg, skies = -1, None
    for place, time in enumerate(np.linspace(0.0, len(ends) - 1.0, count)):
        control.check()
        before, share = (_PREPARING + (1.0 - _PREPARING) * done / count for done in (place, place + 1))
        if leg != min(int(time), len(ends) - 2):
            leg = min(int(time), len(ends) - 2)
            yield Progress(before if place else 0.0, Sentence("Finding suns"))
            skies = Skies(*ends[leg : leg + 2], settings)
        message = Sentence("Sky {done} of {total}", {"done": place + 1, "total": count})
        yield Progress(share, message, PlacedSky(place, skies.frame(min(float(time) - leg, 1.0))))


class SkyFiles:
    """The files of a sequence, numbered by frame.

    Parameters
    ----------
    folder : str or Path
        Created if missing; a leading // stands for the folder of the saved file.
    first_frame, count : int
        Scene frames.

    Raises
    ------
    InputError
        The folder is not writable.
    """

    def __init__(self, folder: str | Path, first_frame: int, count: int) -> None:
        target = checked_folder(folder)
        first = file_number(first_frame, first_frame)
        self.paths = numbered_paths(target, "sky.", ".exr", range(first, first + count))
        self._drafts = DraftFiles()

    def write(self, sky: PlacedSky) -> None:
        """Write a sky to a temporary file next to its final path; existing files stay until all files are complete.

        Raises
        ------
        ConvwassError
            The folder cannot be created, or the file cannot be written.
        """
        path = self.paths[sky.place]
        try:
            draft = self._drafts.draft_of(path)
        except OSError as error:
            reason = error.strerror or str(error)
            raise ConvwassError("{file} could not be written: {reason}", file=str(path), reason=reason) from error
        write_sky(draft, sky.frame.image)

    def finish(self) -> None:
        """Move all files to their final paths, once all are complete.

        Raises
        ------
        ConvwassError
            The system refuses to replace a file; all files stay unchanged.
        """
        self._drafts.keep()

    def discard(self) -> None:
        """Remove temporary files, and the folder if it was created for them."""
        self._drafts.discard()
