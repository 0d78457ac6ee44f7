# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grade a clip in steps: one map from the palette of all frames together, which avoids flicker."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control, Progress, Request, Work, within
from ...sentence import Sentence
from .palette_settings import RecolorSettings
from .palette_statistics import pooled_palette
from .pixel_blocks import recolored_blocks
from .recolor_job import Picture, matched
from .recoloring import Recoloring

# Fraction of the job for finding the map, and fraction of that for measuring.
_MAPPED, _MEASURED = 0.35, 0.85


class FrameRequest(Request[Picture]):
    """Requests a frame of the clip, which only the caller can read.

    Parameters
    ----------
    place : int
        Index of the frame.
    """

    def __init__(self, place: int) -> None:
        super().__init__()
        self.place = place


@dataclass(frozen=True)
class RecoloredFrame:
    """A recolored frame.

    Attributes
    ----------
    place : int
        Index of the frame.
    pixels : (height, width, 4) float32
        Its new pixels.
    """

    place: int
    pixels: NDArray[np.float32]


def clip_steps(
    count: int,
    palettes: Sequence[Picture],
    weights: Sequence[float],
    settings: RecolorSettings,
    control: Control = UNINTERRUPTED,
) -> Work[Recoloring]:
    """Measure all frames of a clip, solve once, and recolor every frame by the same map.

    Parameters
    ----------
    count : int
        Number of frames.
    palettes, weights, settings, control
        As for :func:`.recolor_job.recolor_steps`.

    Yields
    ------
    Progress
        The payloads are two :class:`FrameRequest` per frame, which the caller answers, and every
        :class:`RecoloredFrame`. Only one frame is held at a time.

    Returns
    -------
    Recoloring
        The map.

    Raises
    ------
    InputError
        Pictures without colors, or invalid weights.
    """
    change = yield from within(clip_map_steps(count, palettes, weights, settings, control), 0.0, _MAPPED)
    for place in range(count):
        begin, end = (_MAPPED + (1.0 - _MAPPED) * done / count for done in (place, place + 1))
        message = Sentence("Recoloring frame {done} of {total}", {"done": place + 1, "total": count})
        request = FrameRequest(place)
        yield Progress(begin, message, request)
        frame = request.value
        out = np.empty_like(frame.pixels)
        work = recolored_blocks(frame.pixels, frame.pixel_format, change, frame.mask, out, control)
        yield from within(work, begin, end, message)
        yield Progress(end, message, RecoloredFrame(place, out))
    return change


def clip_map_steps(
    count: int,
    palettes: Sequence[Picture],
    weights: Sequence[float],
    settings: RecolorSettings,
    control: Control = UNINTERRUPTED,
) -> Work[Recoloring]:
    """Find only the map of a clip; arguments and requests as for :func:`clip_steps`, once per frame."""
    measured = []
    for place in range(count):
        message = Sentence("Measuring frame {done} of {total}", {"done": place + 1, "total": count})
        request = FrameRequest(place)
        yield Progress(_MEASURED * place / count, message, request)
        measured.append(request.value.palette_if_any())
        control.check()
    yield Progress(_MEASURED, Sentence("Matching palettes"))
    return matched(pooled_palette(measured), palettes, weights, settings, control)
