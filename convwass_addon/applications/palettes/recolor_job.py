# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recolor one image in steps: measure, solve, apply."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...one_line import one_line
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ..blend_weights import require_positive
from .palette_settings import RecolorSettings
from .palette_statistics import Palette
from .pixel_blocks import recolored_blocks
from .pixels import PixelFormat, image_palette
from .recoloring import Recoloring, recoloring

# Fractions of the progress at which measuring and solving end.
_MEASURED, _SOLVED = 0.1, 0.3

LARGEST_ERROR = 0.1
"""Plans with a larger marginal error are rejected as meaningless."""


@dataclass(frozen=True)
class Picture:
    """Pixels (or other colors in the same form) and how to interpret them.

    Attributes
    ----------
    pixels : (height, width, 4) float32
        Red, green, blue, alpha.
    pixel_format : PixelFormat
        Meaning of the values.
    mask : (height, width) float32 or None
        From 0 to 1: weight of every pixel in the palette and strength of its change.
    weights : (height, width) array or None
        Further weights in the palette: the areas that the pixels represent.
    name : str
        Name of the picture in messages.
    """

    pixels: NDArray[np.float32]
    pixel_format: PixelFormat
    mask: NDArray[np.float32] | None = None
    weights: NDArray[np.float64] | None = None
    name: str = ""

    __repr__ = one_line("pixels", "pixel_format", "mask", "weights", "name")

    def palette(self) -> Palette:
        """Measure the palette; raises InputError if no pixel counts."""
        try:
            return image_palette(self.pixels, self.pixel_format, self.mask, self.weights)
        except InputError as error:
            if not self.name:
                raise
            raise InputError(
                "No pixel of {name} counts: it is transparent, its mask is black, or no color is a number.",
                name=self.name,
            ) from error

    def palette_if_any(self) -> Palette | None:
        """Measure the palette; None if no pixel counts, as in the empty frames before an effect begins."""
        try:
            return self.palette()
        except InputError:
            return None


@dataclass(frozen=True)
class Recolored:
    """A recolored picture.

    Attributes
    ----------
    change : Recoloring
        The map of colors.
    pixels : (height, width, 4) float32
        The recolored pixels.
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
    """Recolor a picture with the palette of another, or with the barycenter of the palettes of several.

    Parameters
    ----------
    source : Picture
        The picture to recolor.
    palettes : sequence of Picture
        Pictures that provide the palettes.
    weights : sequence of float
        One per palette; palettes of weight zero are not read.
    settings : RecolorSettings
        Settings of the recoloring.
    control : Control
        Stops the job when cancelled.

    Yields
    ------
    Progress
        Before every stage, and after every block of pixels.

    Returns
    -------
    Recolored

    Raises
    ------
    InputError
        Pictures without colors, or invalid weights.
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
    """Find only the map of colors, for a lookup table; arguments as for :func:`recolor_steps`."""
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
    """Measure the palettes that have weight, and return the map to their barycenter.

    Raises
    ------
    InputError
        Pictures without colors, invalid weights, or palettes that could not be matched.
    """
    require_positive(np.asarray(weights))
    used = [place for place, weight in enumerate(weights) if weight > 0]
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
    """Return the map to the barycenter of palettes, see :func:`.recoloring.recoloring`, if it is accurate enough.

    Raises
    ------
    InputError
        Invalid weights, or palettes that could not be matched.
    """
    change = recoloring(source, palettes, weights, settings, control)
    if not change.chroma.marginal_error < LARGEST_ERROR:
        raise InputError(
            "The palettes could not be matched (marginal error {error:.0%}); blur or mask regions with stray colors.",
            error=change.chroma.marginal_error,
        )
    return change
