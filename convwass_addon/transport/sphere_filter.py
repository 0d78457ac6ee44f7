# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's filter on the sphere: separable blurs along meridians and parallels that approximate the kernel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.algebra.products import contract
from .log_range import NEGLIGIBLE

# Chosen by eye; accuracy and speed of the filter are measured in docs/performance, "Sphere".
# Number of repetitions of the blurs, which share the variance equally.
_STEPS = 2
# Azimuths over which the blur along meridians is averaged.
_AZIMUTHS = 512
# Turns over which a parallel's Gaussian is wrapped.
_WRAPS = 2


class SphereFilter:
    """A Gaussian blur along parallels, along meridians, and along parallels again, all of it twice.

    Along parallels its width is sigma / sin(theta) in longitude (Solomon et al. 2015, section 7, after Deriche 1993);
    along meridians it is the exact kernel averaged over all azimuths, which lets mass cross a pole. The filter is
    positive and symmetric, but its error does not vanish at any resolution: distances are off by up to 10 %, and a
    midpoint away from the equator by a tenth to a third of sigma.

    Parameters
    ----------
    rows, columns, used, sigma, weights
        As for :class:`.zonal_kernel.ZonalKernel`.
    """

    def __init__(self, rows: int, columns: int, used: int, sigma: float, weights: NDArray[np.float64]) -> None:
        along = sigma / np.sqrt(_STEPS)
        theta = (np.arange(used) + 0.5) * (np.pi / rows)
        self._meridians = _meridians(theta, along, weights * columns)
        # Half of the variance before the blur along meridians and half of it afterwards.
        self._parallels = np.stack([_parallel(columns, along / np.sqrt(2.0) / np.sin(angle)) for angle in theta])

    def apply(self, values: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write H (a * values), (k, used, columns) each, to `out`, which must be another array."""
        # Rows first, because each has a kernel of its own. The matrices are small, so NumPy's product is fast enough.
        current = np.ascontiguousarray(values.transpose(1, 0, 2))
        for _ in range(_STEPS):
            turned = np.ascontiguousarray((current @ self._parallels).reshape(len(current), -1).T)
            blurred = np.empty(current.shape)
            contract(turned.reshape(-1), blurred.reshape(-1), self._meridians)
            current = blurred @ self._parallels
        out[...] = current.transpose(1, 0, 2)


def _meridians(theta: NDArray[np.float64], sigma: float, bands: NDArray[np.float64]) -> NDArray[np.float64]:
    """Exact kernel between rows, averaged over azimuths, multiplied by the weights of the rows."""
    kernel = np.zeros((len(theta), len(theta)))
    sines = np.sin(theta)[:, None] * np.sin(theta)
    across = np.sin((theta[:, None] - theta) / 2.0) ** 2
    for azimuth in (np.arange(_AZIMUTHS) + 0.5) * (np.pi / _AZIMUTHS):
        haversine = np.minimum(across + sines * np.sin(azimuth / 2.0) ** 2, 1.0)
        kernel += np.exp(-((2.0 * np.arcsin(np.sqrt(haversine))) ** 2) / (2.0 * sigma**2))
    kernel *= bands[:, None]
    kernel /= kernel.sum(axis=0).max()
    kernel[kernel < NEGLIGIBLE] = 0.0
    return np.asfortranarray(kernel)


def _parallel(columns: int, sigma: float) -> NDArray[np.float64]:
    """Return the wrapped Gaussian between the columns of one row, sigma in radians of longitude; rows sum to one."""
    places = np.arange(columns)
    steps = (places[:, None] - places) % columns * (2.0 * np.pi / columns)
    turns = 2.0 * np.pi * np.arange(-_WRAPS, _WRAPS + 1)[:, None, None]
    kernel = np.exp(-((steps + turns) ** 2) / (2.0 * sigma**2)).sum(axis=0)
    kernel /= kernel[0].sum()
    kernel[kernel < NEGLIGIBLE] = 0.0
    return kernel
