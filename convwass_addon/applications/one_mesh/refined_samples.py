# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolate between the computed samples of a smooth path."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Weights of four consecutive samples, for the point halfway between the inner two and for that between the first two.
_INNER, _FIRST = np.array([-1.0, 9.0, 9.0, -1.0]) / 16.0, np.array([5.0, 15.0, -5.0, 1.0]) / 16.0


def with_middles(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return samples, (f, ...), and the values in the middle between them, (2 f - 1, ...), by cubic interpolation.

    The error of a point that rotates by the angle h per step is 3/128 h^4 times its radius, and 5/128 h^4 in the first
    and the last step: 7e-6 and 1.2e-5 for 120 degrees in 16 steps.

    Parameters
    ----------
    samples : (f, ...) float64
        At least four, at equal steps of time.
    """
    found = np.empty((2 * len(samples) - 1, *samples.shape[1:]))
    found[::2] = samples
    for place in range(len(samples) - 1):
        start = min(max(place - 1, 0), len(samples) - 4)
        weights = _INNER if place - start == 1 else _FIRST if place == start else _FIRST[::-1]
        found[2 * place + 1] = np.tensordot(weights, samples[start : start + 4], axes=1)
    return found
