# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The map of a and b: transport between histograms on a grid (Solomon et al. 2015, section 7), debiased."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...progress import Control
from ...transport import Grid, barycenter, distance, transport_map
from .interpolation import interpolated
from .palette_statistics import BINS, REACH

SIGMA = 4.0
"""Standard deviation of the kernel in units of a and b."""

_BIN = 2.0 * REACH / BINS
_TOLERANCE = 1e-3
# Chosen by eye; the resulting maps are measured in docs/performance, "Palettes".
# Fraction of the largest bin below which an average is unreliable and a wider one is used.
_FLOOR = 1e-6
_LEAST_SMOOTHING, _WIDENING = 0.35, 1.6


@dataclass(frozen=True)
class ChromaMap:
    """The change of a and b.

    Attributes
    ----------
    shifts : (2, BINS, BINS) float32
        Change of a and of b at the centers of the bins.
    iterations : int
        Iterations of Sinkhorn's algorithm.
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
    """Return the plane of a and b as a domain; every solving thread needs its own."""
    return Grid((BINS, BINS), SIGMA / _BIN)


def chroma_barycenter(
    histograms: Sequence[NDArray[np.float64]], weights: Sequence[float], control: Control
) -> NDArray[np.float64]:
    """Return the debiased barycenter of histograms, (BINS, BINS), with sum 1."""
    domain = chroma_domain()
    found = barycenter(np.array(histograms), weights, domain, sharpness=1.0, tolerance=_TOLERANCE, control=control)
    return found.density / found.density.sum()


def chroma_map(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    smoothing: float,
    control: Control,
) -> ChromaMap:
    """Solve for the map from one histogram to another.

    The blur pulls the barycentric projection of an entropic plan towards the mean. The plan of the source to itself is
    pulled in the same way, so the difference of the two projections moves nothing where both histograms are equal.

    Parameters
    ----------
    source, target : (BINS, BINS) float64
        Nonnegative, not all zero.
    smoothing : float
        Standard deviation in bins of the average over the map, weighted by the source.
    control : Control
        Stops the solve when cancelled.

    Returns
    -------
    ChromaMap
        Shifts of a and b, (2, BINS, BINS).
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
    """Average the map, weighted by the histogram; bins without colors use increasingly wide averages."""
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
