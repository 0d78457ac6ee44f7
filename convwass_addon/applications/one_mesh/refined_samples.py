# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth paths of many points, interpolated between computed samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.products import product

# Weights of four consecutive samples, for the point halfway between the inner two and for that between the first two.
_INNER, _FIRST = np.array([-1.0, 9.0, 9.0, -1.0]) / 16.0, np.array([5.0, 15.0, -5.0, 1.0]) / 16.0


@dataclass(frozen=True)
class RefinedPath:
    """A path of many points, with positions between its samples that are never stored for all points.

    Attributes
    ----------
    samples : (s, n, 3) float64
        Computed positions at even steps of time.
    weights : (f, s) float64
        The positions at finer steps are these weighted means of the samples.
    """

    samples: NDArray[np.float64]
    weights: NDArray[np.float64]

    @classmethod
    def of(cls, samples: NDArray[np.float64], doublings: int) -> RefinedPath:
        """Double the number of steps several times by interpolation; see :func:`with_middles`."""
        weights = np.eye(len(samples))
        for _ in range(doublings):
            weights = with_middles(weights)
        return cls(samples, weights)

    def __len__(self) -> int:
        """Return the number of positions of every point."""
        return len(self.weights)

    def mean(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return weighted means of the samples, (k, n, 3), with weights, (k, s)."""
        return product(weights, self.samples.reshape(len(self.samples), -1)).reshape(-1, *self.samples.shape[1:])


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
