# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The palette of an image: a histogram of a and b, and quantiles of L (Solomon et al. 2015, section 7)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.arrays.equal_shares import at_equal_shares

BINS = 128
"""Bins along a and along b."""

REACH = 128.0
"""The histogram extends from minus this to this along both axes; values beyond it count at its border."""

QUANTILES = 4096
"""Number of values of L, at equally spaced probabilities."""

# Largest number of pixels measured: more would not change the histogram visibly.
_MOST_SAMPLES = 1 << 18
# Golden ratio: placing one sample at multiples of this within each of many equal intervals avoids aliasing with the
# width of the picture.
_GOLDEN = 0.6180339887498949


@dataclass(frozen=True)
class Palette:
    """The distribution of an image's colors.

    Attributes
    ----------
    chroma : (BINS, BINS) float64
        Histogram of a (first axis) and b, of sum 1.
    lightness : (QUANTILES,) float64
        L at the midpoints of equal probability intervals, ascending.
    mass : float
        Number of pixels, with partly transparent ones counted in part.
    """

    chroma: NDArray[np.float64]
    lightness: NDArray[np.float64]
    mass: float


def sample_places(count: int) -> NDArray[np.int64]:
    """Return the indices of a sample of `count` pixels: all of them, or about 260 000 evenly spread ones."""
    if count <= _MOST_SAMPLES:
        return np.arange(count)
    steps = np.arange(_MOST_SAMPLES, dtype=np.float64)
    return ((steps + steps * _GOLDEN % 1.0) * (count / _MOST_SAMPLES)).astype(np.int64)


def measured_palette(lab: ArrayLike, weights: ArrayLike | None = None) -> Palette:
    """Measure the palette of pixels.

    Parameters
    ----------
    lab : (3, n) array_like
        CIE-Lab; pixels with values that are not finite are ignored.
    weights : (n,) array_like, optional
        Nonnegative weights of the pixels, such as their alpha; by default equal.

    Raises
    ------
    InputError
        No pixel counts.
    """
    values = np.asarray(lab, dtype=np.float64)
    shares = np.ones(values.shape[1]) if weights is None else np.asarray(weights, dtype=np.float64)
    counts = np.isfinite(values).all(axis=0) & (shares > 0) & np.isfinite(shares)
    if not counts.any():
        raise _no_colors()
    values, shares = values[:, counts], shares[counts]
    return Palette(_histogram(values[1:], shares), _quantiles(values[0], shares), float(shares.sum()))


def _no_colors() -> InputError:
    return InputError("No pixel counts: the image is transparent, the mask is black, or no color is a number.")


def pooled_palette(palettes: Iterable[Palette | None]) -> Palette:
    """Return the combined palette of several images, such as the frames of a clip, weighted by their pixels.

    Parameters
    ----------
    palettes : iterable of Palette or None
        None for images without colors.

    Raises
    ------
    InputError
        All images are without colors.
    """
    palettes = [palette for palette in palettes if palette is not None]
    if not palettes:
        raise _no_colors()
    masses = np.array([palette.mass for palette in palettes])
    chroma = np.tensordot(masses / masses.sum(), np.array([palette.chroma for palette in palettes]), axes=1)
    values = np.concatenate([palette.lightness for palette in palettes])
    return Palette(chroma, _quantiles(values, np.repeat(masses, QUANTILES)), float(masses.sum()))


def _histogram(ab: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distribute every pixel over the four bins around it, which preserves the mean color exactly."""
    places = np.clip((ab + REACH) * (BINS / (2.0 * REACH)) - 0.5, 0.0, BINS - 1.0)
    first = np.minimum(places.astype(np.int64), BINS - 2)
    upper = places - first
    found = np.zeros(BINS * BINS)
    for down, right in np.ndindex(2, 2):
        share = (upper[0] if down else 1.0 - upper[0]) * (upper[1] if right else 1.0 - upper[1])
        found += np.bincount((first[0] + down) * BINS + first[1] + right, share * weights, BINS * BINS)
    return found.reshape(BINS, BINS) / found.sum()


def _quantiles(values: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    order = np.argsort(values)
    return values[order[at_equal_shares(weights[order], QUANTILES)]]
