# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Skies between two, frame by frame: computed on a thread, written on the main one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.skies.sky_frames import Skies, SkyFrame
from ...applications.skies.sky_settings import SkySettings
from ...errors import InputError
from ...sentence import Sentence
from ..files import checked_target
from .sky_pixels import write_sky

# Share of the work that finding the suns takes.
_PREPARING = 0.1


@dataclass(frozen=True)
class SkyStep:
    """One step: the done share, what is being done, and a finished sky with its place."""

    fraction: float
    message: Sentence
    place: int = 0
    frame: SkyFrame | None = None


def fitting_height(width: int, settings: SkySettings) -> int:
    """Return the height of skies about so wide: the grid of the transport goes into it without a rest."""
    return max(round(width / 2 / settings.rows), 1) * settings.rows


def sky_steps(
    first: NDArray[np.float64],
    last: NDArray[np.float64],
    count: int,
    settings: SkySettings,
    check: Callable[[], None] | None = None,
) -> Iterator[SkyStep]:
    """Interpolate between two skies at `count` even times, both ends among them.

    Raises
    ------
    InputError
        Skies that cannot be used; see :class:`...applications.skies.sky_frames.Skies`.
    """
    yield SkyStep(0.0, Sentence("Finding suns"))
    skies = Skies(first, last, settings)
    for place, time in enumerate(np.linspace(0.0, 1.0, count)):
        if check is not None:
            check()
        share = _PREPARING + (1.0 - _PREPARING) * (place + 1) / count
        message = Sentence("Sky {done} of {total}", {"done": place + 1, "total": count})
        yield SkyStep(share, message, place, skies.frame(float(time)))


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
        text = str(folder)
        if text.startswith("//") and not bpy.data.filepath:
            raise InputError("Save the file first: {folder} is relative to it. Or choose a whole path.", folder=text)
        target = Path(bpy.path.abspath(text)).expanduser().absolute()
        if target.exists() and not target.is_dir():
            raise InputError("{folder} is a file; choose a folder.", folder=str(target))
        checked_target(target / "x" if target.is_dir() else target)
        self.paths = [target / f"sky.{first_frame + place:04d}.exr" for place in range(count)]
        self._written: list[Path] = []

    def write(self, step: SkyStep) -> None:
        """Write the sky that a step has brought."""
        if step.frame is None:
            return
        path = self.paths[step.place]
        path.parent.mkdir(exist_ok=True)
        write_sky(path, step.frame.image)
        self._written.append(path)

    def discard(self) -> None:
        """Remove what has been written."""
        for path in self._written:
            path.unlink(missing_ok=True)
        self._written = []
