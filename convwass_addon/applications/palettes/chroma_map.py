# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The map of a and b: transport between histograms on a grid (Solomon et al. 2015, section 7), without its blur."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...progress import UNINTERRUPTED, Control
from ...transport import Grid, barycenter, distance, transport_map
from .interpolation import interpolated
from .palette_statistics import BINS, REACH

SIGMA = 4.0
"""Standard deviation of the kernel in units of a and b."""

_BIN = 2.0 * REACH / BINS
_TOLERANCE = 1e-3
# Chosen by eye; what the map gives is measured in docs/performance.md, "Palettes".
# Shares of the largest bin below which an average is not trusted, and is taken from further away.
_FLOOR = 1e-6
_LEAST_SMOOTHING, _WIDENING = 0.35, 1.6


@dataclass(frozen=True)
class ChromaMap:
    """By how much a and b change.

    Attributes
    ----------
    shifts : (2, BINS, BINS) float32
        Change of a and of b at the middles of bins.
    iterations : int
        Of Sinkhorn's algorithm.
    marginal_error : float
        L1 distance of the plan's marginal from the histogram.
    """

    shifts: NDArray[np.float32]
    iterations: int
    marginal_error: float

    def __call__(self, ab: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the changes of colors, (2, ...), interpolated between bins."""
        places = ab.reshape(2, -1) * (1.0 / _BIN) + (REACH / _BIN - 0.5)
        return interpolated(self.shifts, places).reshape(ab.shape)


def chroma_domain() -> Grid:
    """Return the plane of a and b as a domain; one for each thread that solves."""
    return Grid((BINS, BINS), SIGMA / _BIN)


def chroma_barycenter(
    histograms: Sequence[NDArray[np.float64]], weights: Sequence[float], control: Control = UNINTERRUPTED
) -> NDArray[np.float64]:
    """Return the debiased barycenter of histograms, (BINS, BINS), of sum 1."""
    domain = chroma_domain()
    found = barycenter(np.array(histograms), weights, domain, sharpness=1.0, tolerance=_TOLERANCE, control=control)
    return found.density / found.density.sum()


def chroma_map(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    smoothing: float = 1.0,
    control: Control = UNINTERRUPTED,
) -> ChromaMap:
    """Solve for the map from one histogram to another.

    The barycentric projection of an entropic plan is pulled to the mean by the blur. That of the plan of the source
    with itself is pulled in the same way; the difference of the two moves nothing where both are equal.

    Parameters
    ----------
    source, target : (BINS, BINS) float64
        Not negative, not zero everywhere.
    smoothing : float
        Standard deviation in bins over which the map is averaged, weighted by the source.
    control : Control
        Ends the solve when cancelled.

    Returns
    -------
    ChromaMap
        (2, BINS, BINS) shifts of a and b.
    """
    domain = chroma_domain()
    plans = [
        distance(source, other, domain, debias=False, tolerance=_TOLERANCE, control=control)
        for other in (target, source)
    ]
    images = [transport_map(plan.log_w, domain) for plan in plans]
    shifts = np.moveaxis(images[0] - images[1], -1, 0) * _BIN
    filled = _smoothed(shifts, source / source.max(), smoothing)
    return ChromaMap(filled.astype(np.float32), plans[0].iterations, float(plans[0].marginal_error))


def _smoothed(shifts: NDArray[np.float64], weights: NDArray[np.float64], sigma: float) -> NDArray[np.float64]:
    """Average the map, weighted by the histogram, and fill bins without colors from ever further away."""
    found, done = np.zeros_like(shifts), np.zeros(weights.shape, dtype=bool)
    if sigma < _LEAST_SMOOTHING:
        done = weights > _FLOOR
        found[:, done] = shifts[:, done]
        sigma = _LEAST_SMOOTHING
    while not done.all() and sigma < BINS:
        share = gaussian_filter(weights, sigma, truncate=5.0, mode="constant")
        new = (share > _FLOOR) & ~done
        for own, filled in zip(shifts, found, strict=True):
            filled[new] = gaussian_filter(weights * own, sigma, truncate=5.0, mode="constant")[new] / share[new]
        done |= new
        sigma *= _WIDENING
    if not done.all():
        found[:, ~done] = (weights * shifts).sum(axis=(1, 2), keepdims=True)[:, 0] / weights.sum()
    return found
