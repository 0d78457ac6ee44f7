# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grading a clip as a job of steps: one map from the palette of all frames together, so that nothing flickers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ...sentence import Sentence
from ..desk import Desk
from .palette_settings import RecolorSettings
from .palette_statistics import pooled_palette
from .pixel_blocks import recolored_blocks
from .recolor_job import Picture, matched
from .recoloring import Recoloring

# Shares of the job that measuring takes, where the frames are written too, and where they are not.
_MEASURED, _ONLY_MEASURED = 0.3, 0.9


@dataclass(frozen=True)
class ClipStep:
    """What has been done last.

    Attributes
    ----------
    fraction : float
        Done share of the whole job.
    message : Sentence
        What is being done.
    wanted : int or None
        Place of a frame that the job waits for: to be read, and handed over by :meth:`.desk.Desk.hand_over`.
    place : int
        Of the frame that is done.
    pixels : (height, width, 4) float32 or None
        A recolored frame.
    change : Recoloring or None
        The map, from the step on where it is known.
    """

    fraction: float
    message: Sentence
    wanted: int | None = None
    place: int = 0
    pixels: NDArray[np.float32] | None = None
    change: Recoloring | None = None


class FrameDesk(Desk[Picture]):
    """Where frames are handed over by the thread that may read them to the one that works on them."""


def clip_steps(
    count: int,
    desk: FrameDesk,
    palettes: Sequence[Picture],
    weights: Sequence[float],
    settings: RecolorSettings,
    control: Control = UNINTERRUPTED,
    *,
    only_map: bool = False,
) -> Iterator[ClipStep]:
    """Measure all frames of a clip, solve once, and recolor every frame by the same map.

    Parameters
    ----------
    count : int
        Frames.
    desk : FrameDesk
        Where the frames come from; each is asked for twice, and no more than one is held.
    palettes, weights, settings, control, only_map
        See :func:`.recolor_job.recolor_steps`.

    Raises
    ------
    InputError
        Pictures without colors, or weights that do not fit.
    """
    measured, share = [], _ONLY_MEASURED if only_map else _MEASURED
    for place in range(count):
        message = Sentence("Measuring frame {done} of {total}", {"done": place + 1, "total": count})
        yield ClipStep(share * place / count, message, wanted=place)
        measured.append(desk.take(control).palette())
    yield ClipStep(share, Sentence("Matching palettes"))
    change = matched(pooled_palette(measured), palettes, weights, settings, control)
    if only_map:
        yield ClipStep(1.0, Sentence("The map is there"), change=change)
        return
    for place in range(count):
        message = Sentence("Recoloring frame {done} of {total}", {"done": place + 1, "total": count})
        yield ClipStep(share + (1.0 - share) * place / count, message, wanted=place)
        frame = desk.take(control)
        out = np.empty_like(frame.pixels)
        for _ in recolored_blocks(frame.pixels, frame.pixel_format, change, frame.mask, out, control):
            pass
        yield ClipStep(share + (1.0 - share) * (place + 1) / count, message, place=place, pixels=out, change=change)
