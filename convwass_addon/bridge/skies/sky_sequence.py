# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Skies between others, frame by frame: computed on a thread, written on the main one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...applications.skies.sky_frames import Skies, SkyFrame
from ...applications.skies.sky_settings import SkySettings
from ...drafts import DraftFiles
from ...errors import ConvwassError, InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..files import checked_folder
from ..numbered_files import numbered_paths
from .sky_pixels import write_sky

# Share of the work that finding the suns takes.
_PREPARING = 0.1


@dataclass(frozen=True)
class PlacedSky:
    """A finished sky.

    Attributes
    ----------
    place : int
        Its number in the sequence, from 0.
    frame : SkyFrame
        The sky.
    """

    place: int
    frame: SkyFrame


def fitting_height(width: int, settings: SkySettings) -> int:
    """Return the height of skies about so wide: the grid of the transport goes into it without a rest."""
    return max(round(width / 2 / settings.rows), 1) * settings.rows


def sky_steps(
    ends: Sequence[NDArray[np.float64]],
    count: int,
    settings: SkySettings,
    control: Control = UNINTERRUPTED,
) -> Work[None]:
    """Interpolate through two skies or more at `count` even times, the first and the last among them.

    Yields
    ------
    Progress
        The payloads are the finished skies as :class:`PlacedSky`, in their order.

    Raises
    ------
    InputError
        Skies that cannot be used; see :class:`...applications.skies.sky_frames.Skies`.
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
    """The files of a sequence, called by their frames.

    Parameters
    ----------
    folder : str or Path
        Made if missing; a path that starts with two slashes goes from the saved file.
    first_frame, count : int
        Of the scene.

    Raises
    ------
    InputError
        The folder cannot be written to, or the frames have no numbers.
    """

    def __init__(self, folder: str | Path, first_frame: int, count: int) -> None:
        if first_frame < 0:
            raise InputError("Frames before 0 cannot be numbered; start later.")
        target = checked_folder(folder)
        self.paths = numbered_paths(target, "sky.", ".exr", range(first_frame, first_frame + count))
        self._drafts = DraftFiles()

    def write(self, sky: PlacedSky) -> None:
        """Write a sky, beside where it goes: what is there stays until all are whole.

        Raises
        ------
        ConvwassError
            The folder cannot be made, or the file not be written.
        """
        path = self.paths[sky.place]
        try:
            draft = self._drafts.draft_of(path)
        except OSError as error:
            reason = error.strerror or str(error)
            raise ConvwassError("{file} could not be written: {reason}", file=str(path), reason=reason) from error
        write_sky(draft, sky.frame.image)

    def finish(self) -> None:
        """Put what has been written in its place, once all of it is whole.

        Raises
        ------
        ConvwassError
            The system does not let a file be replaced; those that have not been stay as they were.
        """
        self._drafts.keep()

    def discard(self) -> None:
        """Remove what has been written and is not in its place; and the folder, if it was made for it."""
        self._drafts.discard()
