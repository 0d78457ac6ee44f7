# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The map of L: one-dimensional transport in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter1d

# Spacing of knots in L, and their largest number, which increases the spacing for images of high dynamic range.
_STEP, _MOST_KNOTS = 0.1, 16384
# Standard deviation in L of one unit of smoothing.
_UNIT = 0.5


@dataclass(frozen=True)
class LightnessCurve:
    """The change of L.

    Attributes
    ----------
    first, step : float
        L at the first knot, and spacing of the knots.
    shifts : (n,) float32
        Change of L at the knots; constant beyond the ends.
    """

    first: float
    step: float
    shifts: NDArray[np.float32]

    def __call__(self, lightness: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the change of every L."""
        places = np.clip((lightness - self.first) / self.step, 0.0, len(self.shifts) - 1.0)
        below = np.minimum(places.astype(np.int32), len(self.shifts) - 2)
        low = self.shifts[below]
        return low + (places - below) * (self.shifts[below + 1] - low)


def lightness_curve(
    source: ArrayLike, target: ArrayLike, smoothing: float = 0.0, steepest: float = 0.0
) -> LightnessCurve:
    """Return the monotone map between two distributions on a line, T = Q_target o Q_source^-1.

    Parameters
    ----------
    source, target : (n,) array_like
        Quantiles at the same probabilities, ascending. Repeated values of the source, such as a black border, all map
        to the mean of their targets.
    smoothing : float
        Standard deviation of the smoothing of the change, in half units of L.
    steepest : float
        Largest slope; 0 for none. The limit preserves the mean lightness.
    """
    quantiles = np.asarray(source, dtype=np.float64)
    knots, ties = np.unique(quantiles, return_inverse=True)
    images = np.bincount(ties, np.asarray(target, dtype=np.float64)) / np.bincount(ties)
    span = max(knots[-1] - knots[0], 2.0 * _STEP)
    count = int(min(np.ceil(span / _STEP) + 1, _MOST_KNOTS))
    places = knots[0] + np.linspace(0.0, span, count)
    step = span / (count - 1)
    shifts = np.interp(places, knots, images - knots)
    if smoothing:
        shifts = gaussian_filter1d(shifts, smoothing * _UNIT / step, mode="nearest")
    if steepest:
        rises = np.diff(places + shifts, prepend=places[0] + shifts[0])
        limited = places[0] + shifts[0] + np.cumsum(np.minimum(rises, steepest * step)) - places
        means = [np.interp(quantiles, places, own).mean() for own in (shifts, limited)]
        shifts = limited + (means[0] - means[1])
    return LightnessCurve(float(places[0]), float(step), shifts.astype(np.float32))
