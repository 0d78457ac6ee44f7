# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth invertible maps of space, composed of small steps on a grid (diffeomorphisms)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from .grid_sampling import sampled

# Largest difference between adjacent cells in a step, in cells. It bounds the derivative of the interpolated step by
# sqrt(3) times this, so the step is invertible and the fixed-point iteration converges.
_LARGEST_SLOPE = 0.5
# Change in cells at which the fixed-point iteration ends: for points, and for whole grids, whose inverse is resampled.
_CLOSE, _CLOSE_ON_GRIDS = 1e-6, 1e-3
_MOST_ROUNDS = 120


class StepFlow:
    """A map of space, id + v_k after ... after id + v_1, and its inverse.

    The steps v are stored and applied to points one after the other. The map itself is therefore never resampled, and
    its inverse is exact.

    Parameters
    ----------
    shape : (int, int, int)
        Cells of the grid along each axis, at least two.

    Attributes
    ----------
    steps : list of (nx, ny, nz, 3) float64
        Displacements at the centers of the cells, in cells.
    """

    def __init__(self, shape: Sequence[int]) -> None:
        self.shape = tuple(shape)
        self.steps: list[NDArray[np.float64]] = []
        # Displacement of the inverse at the centers of the cells; resampled with each step, to warp whole grids.
        self._back = np.zeros((*self.shape, 3))

    def add(self, step: NDArray[np.float64]) -> None:
        """Append a step, (nx, ny, nz, 3) in cells, scaled down if it would not be invertible."""
        step = np.ascontiguousarray(step * min(1.0, _LARGEST_SLOPE / max(_slope(step), _LARGEST_SLOPE)))
        self.steps.append(step)
        centers = _centers(self.shape)
        before = _inverted(step, centers, step.reshape(-1, 3), _CLOSE_ON_GRIDS)
        self._back = (before - centers + sampled(self._back, before)).reshape(self._back.shape)

    def moved(self, points: NDArray[np.float64], control: Control = UNINTERRUPTED) -> NDArray[np.float64]:
        """Return the images of points, (n, 3) in cells."""
        for step in self.steps:
            control.check()
            points = points + sampled(step, points)
        return points

    def moved_back(self, points: NDArray[np.float64], control: Control = UNINTERRUPTED) -> NDArray[np.float64]:
        """Return the points whose images are given, (n, 3) in cells: the exact inverse of :meth:`moved`."""
        for step in reversed(self.steps):
            control.check()
            points = _inverted(step, points, sampled(step, points), _CLOSE)
        return points

    def carried(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return a field, (nx, ny, nz), warped with its cells: values at their preimages."""
        places = _centers(self.shape) + self._back.reshape(-1, 3)
        return sampled(values[..., None], places).reshape(self.shape)


def _slope(step: NDArray[np.float64]) -> float:
    """Largest difference between adjacent cells."""
    return max(float(np.square(np.diff(step, axis=axis)).sum(axis=-1).max()) ** 0.5 for axis in range(3))


def _centers(shape: tuple[int, ...]) -> NDArray[np.float64]:
    return np.stack([index.ravel() for index in np.indices(shape)], axis=1) + 0.5


def _inverted(
    step: NDArray[np.float64], points: NDArray[np.float64], moves: NDArray[np.float64], close: float
) -> NDArray[np.float64]:
    """Solve x + v(x) = y for every point y, (n, 3), by the fixed-point iteration x <- y - v(x), given v(y), (n, 3)."""
    found = points - moves
    # The iteration contracts: where a step is this short, its change is shorter still.
    live = np.flatnonzero(np.einsum("nd,nd->n", moves, moves) > close**2)
    for _ in range(_MOST_ROUNDS):
        if not len(live):
            break
        better = points.take(live, axis=0) - sampled(step, found.take(live, axis=0))
        change = better - found.take(live, axis=0)
        found[live] = better
        live = live[np.einsum("nd,nd->n", change, change) > close**2]
    return found
