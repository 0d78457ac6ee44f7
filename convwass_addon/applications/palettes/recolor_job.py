# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recoloring one image as a job of steps: measure, solve, apply."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...one_line import one_line
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from .palette_settings import RecolorSettings
from .palette_statistics import Palette
from .pixel_blocks import recolored_blocks
from .pixels import PixelFormat, image_palette
from .recoloring import Recoloring, recoloring

# Shares of a job that measuring and solving take, as the progress tells it.
_MEASURED, _SOLVED = 0.1, 0.3

LARGEST_ERROR = 0.1
"""A plan that is this far off is refused: it would say little about the palette."""


@dataclass(frozen=True)
class Picture:
    """Pixels, or what is treated as such, and how they are to be read.

    Attributes
    ----------
    pixels : (height, width, 4) float32
        Red, green, blue, alpha.
    pixel_format : PixelFormat
        What they mean.
    mask : (height, width) float32 or None
        From 0 to 1: how much every pixel takes part.
    weights : (height, width) array or None
        How much it counts in the palette, besides: the area that it stands for.
    """

    pixels: NDArray[np.float32]
    pixel_format: PixelFormat
    mask: NDArray[np.float32] | None = None
    weights: NDArray[np.float64] | None = None

    __repr__ = one_line("pixels", "pixel_format", "mask", "weights")

    def palette(self) -> Palette:
        """Measure the palette; raises InputError where no pixel counts."""
        return image_palette(self.pixels, self.pixel_format, self.mask, self.weights)


@dataclass(frozen=True)
class Recolored:
    """A recolored picture.

    Attributes
    ----------
    change : Recoloring
        The map of colors.
    pixels : (height, width, 4) float32
        The picture.
    """

    change: Recoloring
    pixels: NDArray[np.float32]

    __repr__ = one_line("change", "pixels")


def recolor_steps(
    source: Picture,
    palettes: Sequence[Picture],
    weights: Sequence[float],
    settings: RecolorSettings,
    control: Control = UNINTERRUPTED,
) -> Work[Recolored]:
    """Give a picture the palette of another, or the barycenter of the palettes of several.

    Parameters
    ----------
    source : Picture
        What is recolored.
    palettes : sequence of Picture
        Where the colors come from.
    weights : sequence of float
        One for each; those without weight are not read.
    settings : RecolorSettings
        How.
    control : Control
        Ends the job when cancelled.

    Yields
    ------
    Progress
        Before every part of the work, and after every block of pixels.

    Returns
    -------
    Recolored

    Raises
    ------
    InputError
        Pictures without colors, or weights that do not fit.
    """
    change = yield from within(map_steps(source, palettes, weights, settings, control), 0.0, _SOLVED)
    yield Progress(_SOLVED, Sentence("Recoloring"))
    out = np.empty_like(source.pixels)
    work = recolored_blocks(source.pixels, source.pixel_format, change, source.mask, out, control)
    yield from within(work, _SOLVED, 1.0)
    return Recolored(change, out)


def map_steps(
    source: Picture,
    palettes: Sequence[Picture],
    weights: Sequence[float],
    settings: RecolorSettings,
    control: Control = UNINTERRUPTED,
) -> Work[Recoloring]:
    """Find the map of colors alone, for a table that other programs apply; arguments as :func:`recolor_steps`."""
    yield Progress(0.0, Sentence("Measuring palettes"))
    own = source.palette()
    yield Progress(_MEASURED / _SOLVED, Sentence("Matching palettes"))
    return matched(own, palettes, weights, settings, control)


def matched(
    source: Palette,
    palettes: Sequence[Picture],
    weights: Sequence[float],
    settings: RecolorSettings,
    control: Control = UNINTERRUPTED,
) -> Recoloring:
    """Measure palettes, those that have a weight, and return the map to their barycenter.

    Raises
    ------
    InputError
        Pictures without colors, weights that do not fit, or palettes that could not be matched.
    """
    used = [place for place, weight in enumerate(weights) if weight > 0]
    if not used:
        raise InputError("Weights must be 0 or more, and not all of them 0.")
    measured = []
    for place in used:
        control.check()
        measured.append(palettes[place].palette())
    return solved_map(source, measured, [weights[place] for place in used], settings, control)


def solved_map(
    source: Palette,
    palettes: Sequence[Palette],
    weights: Sequence[float] | None,
    settings: RecolorSettings,
    control: Control = UNINTERRUPTED,
) -> Recoloring:
    """Return the map to the barycenter of palettes, as :func:`.recoloring.recoloring` does, if it is good for anything.

    Raises
    ------
    InputError
        Weights that do not fit, or palettes that could not be matched.
    """
    change = recoloring(source, palettes, weights, settings, control)
    if not change.chroma.marginal_error < LARGEST_ERROR:
        raise InputError(
            "The palettes could not be matched (marginal error {error:.0%}); blur or mask what has stray colors.",
            error=change.chroma.marginal_error,
        )
    return change
