# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much memory a bake takes; quick to ask, before any shape is read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

# Most bytes per cell at the peak (tests/applications/test_memory_estimates.py), of every shape and of every thread that
# solves: for all cells of the grid, for those that the largest shape fills, and for every further part.
_BYTES_PER_SHAPE, _BYTES_PER_SHAPE_FILLED, _BYTES_PER_SHAPE_PART = 18, 80, 4
_BYTES_PER_WORKER, _BYTES_PER_WORKER_FILLED, _BYTES_PER_WORKER_PART = 90, 330, 12
# Thin shapes fill little of the grid; what the solver keeps of them does not fall below this.
_LEAST_FILLED = 0.03
# Share of its bounding box that a shape is taken to fill before it is read: more than the animals of assets/shapes do.
_FILLED = 0.4


def peak_bytes(cells: float, filled: float, shapes: int, workers: int, parts: int = 1) -> int:
    """Return the bytes at the peak of a bake.

    Parameters
    ----------
    cells : float
        Of the grid.
    filled : float
        Share of them that the largest shape fills.
    shapes, workers, parts : int
        How many shapes, threads that solve, and parts of every shape.
    """
    filled = float(np.clip(filled, _LEAST_FILLED, 1.0))
    of_shape = _BYTES_PER_SHAPE + _BYTES_PER_SHAPE_FILLED * filled + _BYTES_PER_SHAPE_PART * (parts - 1)
    of_worker = _BYTES_PER_WORKER + _BYTES_PER_WORKER_FILLED * filled + _BYTES_PER_WORKER_PART * (parts - 1)
    return int(cells * (shapes * of_shape + workers * of_worker))


def estimated_bytes(sizes: Sequence[Sequence[float]], resolution: int, workers: int) -> int:
    """Estimate the same from the sizes of the shapes' bounding boxes, (k, 3), within a factor of about two."""
    extent = np.max(np.asarray(sizes, dtype=np.float64), axis=0)
    if not extent.max() > 0.0:
        return 0
    cells = float(np.prod(np.clip(extent / extent.max(), 1.0 / resolution, 1.0))) * float(resolution) ** 3
    return peak_bytes(cells, _FILLED, len(sizes), workers)
