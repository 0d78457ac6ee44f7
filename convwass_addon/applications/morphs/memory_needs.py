# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates of the memory that a bake needs, without reading any shape."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

# Maximum bytes per cell at the peak (tests/applications/test_memory_estimates.py), for every shape and for every
# solving thread: for all cells of the grid, for those that the largest shape fills, and for every further part.
_BYTES_PER_SHAPE, _BYTES_PER_SHAPE_FILLED, _BYTES_PER_SHAPE_PART = 18, 80, 4
_BYTES_PER_WORKER, _BYTES_PER_WORKER_FILLED, _BYTES_PER_WORKER_PART = 90, 330, 12
# Thin shapes fill little of the grid; the solver's memory does not fall below that of this fraction.
_LEAST_FILLED = 0.03
# Assumed fraction of its bounding box that a shape fills: more than the animals of assets/shapes do.
_FILLED = 0.4


def peak_bytes(cells: float, filled: float, shapes: int, workers: int, parts: int = 1) -> int:
    """Return the peak memory of a bake in bytes.

    Parameters
    ----------
    cells : float
        Number of cells of the grid.
    filled : float
        Fraction of them that the largest shape fills.
    shapes, workers, parts : int
        Number of shapes, of solving threads, and of parts of every shape.
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
