# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes as distributions on one plane grid, each relative to its own center of mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.plane.coverage import coverage
from ...geometry.plane.outlines import Outline
from ...geometry.plane.planar_fill import Boundary
from ..memory import available_memory
from ..morphs.centered_grid import CenteredGrid
from .flat_pieces import FlatPieces

# Maximum bytes per cell at the peak (tests/applications/test_memory_estimates.py), for a part of every shape and for a
# solving thread.
_BYTES_PER_SHAPE, _BYTES_PER_WORKER = 60, 400


@dataclass(frozen=True)
class FlatLattice(CenteredGrid):
    """The grid shared by all shapes of a flat morph."""

    multiple = 16

    @classmethod
    def around(cls, shapes: Sequence[FlatPieces], resolution: int, sigma: float) -> FlatLattice:
        """Return a grid with `resolution` cells along its longest side that holds all shapes.

        Raises
        ------
        InputError
            A resolution too small for a shape and its blur.
        """
        centers = np.stack([shape.center for shape in shapes])
        return cls.of_bounds([shape.bounds for shape in shapes], centers, resolution, sigma)

    def corner(self, weights: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
        """Low corner of the grid around a blend with these weights, (2,), scene units."""
        return self.origin + np.asarray(weights) @ self.centers

    def filled(self, boundary: Boundary, weights: Sequence[float]) -> NDArray[np.float64]:
        """Return the fraction of every cell around a blend that a boundary in scene units fills, (nx, ny)."""
        scale = 1.0 / self.spacing
        return coverage(boundary.moved(-self.corner(weights) * scale, scale), self.shape)

    def to_scene(self, outline: Outline, weights: Sequence[float]) -> Outline:
        """Convert an outline from cells to scene space, at the weighted mean of the centers."""
        return outline.moved(self.corner(weights), self.spacing)

    def memory(self, parts: int, workers: int) -> int:
        """Return the maximum memory of a morph in bytes, for this many parts of shapes and solving threads."""
        return self.shape[0] * self.shape[1] * (parts * _BYTES_PER_SHAPE + workers * _BYTES_PER_WORKER)

    def fitting_workers(self, shapes: int, parts: int, most: int) -> int:
        """Return how many threads, from one to `most`, can solve at the same time in the available memory."""
        free = available_memory()
        if free is None:
            return most
        return int(np.clip((free - self.memory(shapes * parts, 0)) // self.memory(0, 1), 1, most))
