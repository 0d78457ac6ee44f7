# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes as distributions on one plane grid, each relative to its own center of mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.coverage import coverage
from ...geometry.outlines import Outline
from ...geometry.planar_fill import Boundary
from ...transport import Grid
from ..memory import available_memory
from ..morphs.moved_room import Room
from .flat_pieces import FlatPieces

# Sides are multiples of this, so that the grid can be halved several times.
_MULTIPLE = 16
# Maximum bytes per cell at the peak (tests/applications/test_memory_estimates.py), for a part of every shape and for a
# solving thread.
_BYTES_PER_SHAPE, _BYTES_PER_WORKER = 60, 400


@dataclass(frozen=True)
class FlatLattice:
    """The grid shared by the shapes of a flat morph, relative to the center of each; see :class:`.volumes.Lattice`.

    Attributes
    ----------
    shape : (int, int)
        Cells per axis.
    spacing : float
        Size of a cell in scene units.
    origin : (2,) float64
        Low corner of the grid relative to a shape's center, scene units.
    centers : (k, 2) float64
        Centers of the shapes, scene units.
    """

    shape: tuple[int, int]
    spacing: float
    origin: NDArray[np.float64]
    centers: NDArray[np.float64]

    @classmethod
    def around(cls, shapes: Sequence[FlatPieces], resolution: int, sigma: float) -> FlatLattice:
        """Return a grid with `resolution` cells along its longest side that holds all shapes.

        Raises
        ------
        InputError
            A resolution too small for a shape and its blur.
        """
        margin = 2 + int(np.ceil(2.0 * sigma))
        if resolution < 4 * margin:
            raise InputError(
                "Resolution {resolution} is too coarse for a blur of {blur:.3g} cells; use at least {least}, or less "
                "blur.",
                resolution=resolution,
                blur=sigma,
                least=4 * margin,
            )
        centers = np.stack([shape.center for shape in shapes])
        low = np.min([shape.bounds[0] - c for shape, c in zip(shapes, centers, strict=True)], axis=0)
        high = np.max([shape.bounds[1] - c for shape, c in zip(shapes, centers, strict=True)], axis=0)
        extent = high - low
        spacing = float(extent.max()) / (resolution - 2 * margin)
        cells = np.ceil(extent / spacing + 2 * margin)
        cells = (np.ceil(cells / _MULTIPLE - 1e-9) * _MULTIPLE).astype(int)
        origin = (low + high) / 2 - cells * spacing / 2
        return cls((int(cells[0]), int(cells[1])), spacing, origin, centers)

    def holding(self, room: Room | None) -> FlatLattice:
        """Return a lattice with the same cells and enough further ones for moved shapes."""
        return self if room is None else room.in_lattice(self, _MULTIPLE)

    def grid(self, sigma: float) -> Grid:
        """Return the transport domain with a kernel of `sigma` cells."""
        return Grid(self.shape, sigma)

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
