# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of how well a warp fits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.grid_halving import halved
from ...progress import Control
from ...transport import Grid, distance
from .warp_registration import MeetingFlows
from .warped_shape import Course

# Blur of the distances, their tolerance, and their maximum number of iterations.
_SIGMA, _TOLERANCE, _MOST_ITERATIONS = 1.0, 3e-3, 200
_SAMPLES = 500
# Percentiles reported for a distribution over the solid.
_PERCENTILES = (1, 5, 50, 95, 99)


@dataclass(frozen=True)
class WarpSignals:
    """How well a warp between two shapes fits.

    Attributes
    ----------
    length_before, length_left : float
        Wasserstein distance between the two shapes, in cells of the warp's grid: at rest, and moved halfway.
    volume_change : tuple of float
        Percentiles 1, 5, 50, 95, 99 of the volume ratio of parts of either shape from end to end.
    strain : float
        Mean over both solids of the largest |ln s| over the singular values s of the gradient.
    inverse_error : float
        Largest round-trip error of the vertices, in cells.
    """

    length_before: float
    length_left: float
    volume_change: tuple[float, ...]
    strain: float
    inverse_error: float

    def record(self) -> dict[str, object]:
        """Return the figures ready for JSON."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}


def length_between(first: NDArray[np.float64], second: NDArray[np.float64], control: Control) -> float:
    """Return the Wasserstein distance, in cells, between two solids given by the filled fractions of their cells.

    Computed on cells of twice the size, which takes a tenth of the time.
    """
    one, other = halved(first), halved(second)
    solved = distance(
        one,
        other,
        Grid(one.shape, _SIGMA),
        tolerance=_TOLERANCE,
        max_iterations=_MOST_ITERATIONS,
        control=control,
    )
    return 2.0 * solved.length


def inverse_error(points: NDArray[np.float64], course: Course, flows: MeetingFlows, control: Control) -> float:
    """Return the largest round-trip error of some of the points, (n, 3) in cells."""
    some = slice(None, None, max(len(points) // _SAMPLES, 1))
    back = flows.first.moved_back(flows.second.moved(course.end[some], control), control)
    return float(np.linalg.norm(back - points[some], axis=1).max())


def volume_change(gradients: Sequence[NDArray[np.float64]]) -> tuple[float, ...]:
    """Return percentiles of the determinants of gradients, (c, 3, 3) each."""
    found = np.percentile(np.linalg.det(np.concatenate(gradients)), _PERCENTILES)
    return tuple(float(value) for value in found)


def strain(gradients: Sequence[NDArray[np.float64]]) -> float:
    """Return the mean of the largest |ln s| of the singular values s of gradients, (c, 3, 3) each."""
    values = np.linalg.svd(np.concatenate(gradients), compute_uv=False)
    return float(np.abs(np.log(np.maximum(values, 1e-3))).max(axis=1).mean())
