# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids with fewer cells, for fields that need little accuracy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .boxes import Box, slabs


def halved(field: NDArray[np.floating], dimensions: int = 3) -> NDArray[np.floating]:
    """Return the means of 2 x 2 x 2 cells of a field (nx, ny, nz, ...); odd sides are padded with zeros.

    With another number of `dimensions`, only so many axes are halved.
    """
    field = _evenly_padded(field, dimensions)
    for axis in range(dimensions):
        even, odd = _pairs(axis)
        found = field[even] + field[odd]
        field = np.multiply(found, field.dtype.type(0.5), out=found)
    return field


def _evenly_padded(field: NDArray, dimensions: int) -> NDArray:
    """Pad odd sides of a field (nx, ny, nz, ...) with zeros."""
    missing = [size % 2 for size in field.shape[:dimensions]] + [0] * (field.ndim - dimensions)
    return np.pad(field, [(0, one) for one in missing]) if any(missing) else field


def _pairs(axis: int) -> tuple[Box, Box]:
    """Return the slices of the first and second cells of all pairs along an axis."""
    before = (slice(None),) * axis
    return (*before, slice(0, None, 2)), (*before, slice(1, None, 2))


def doubled(field: NDArray[np.floating], shape: Sequence[int]) -> NDArray[np.floating]:
    """Interpolate a field (mx, my, mz, ...) linearly on cells of half the size, in a grid of `shape`, up to three axes.

    It is constant beyond the outer centers.
    """
    for axis, size in enumerate(shape):
        field = doubled_along(field, axis)[(slice(None),) * axis + (slice(0, size),)]
    return field


def doubled_along(field: NDArray[np.floating], axis: int) -> NDArray[np.floating]:
    """Interpolate a field linearly on twice as many cells along one axis; it is constant beyond the outer centers."""
    shape = list(field.shape)
    shape[axis] *= 2
    found = np.empty(shape, field.dtype)
    values, target = np.moveaxis(field, axis, 0), np.moveaxis(found, axis, 0)
    np.multiply(values, field.dtype.type(0.75), out=target[0::2])
    target[1::2] = target[0::2]
    quarter = field.dtype.type(0.25) * values
    target[2::2] += quarter[:-1]
    target[0] += quarter[0]
    target[1:-1:2] += quarter[1:]
    target[-1] += quarter[-1]
    return found


class CoarserGrid:
    """A grid that is halved until it has few enough cells along every side.

    Parameters
    ----------
    shape : tuple of int
        Cells of the finer grid along two or three axes.
    most : int
        Maximum number of cells along a side.

    Attributes
    ----------
    cell : int
        Size of its cells in cells of the finer grid, a power of two; 1 if that is coarse enough.
    """

    def __init__(self, shape: tuple[int, ...], most: int) -> None:
        self._shape = shape
        self._halvings = max(int(np.ceil(np.log2(max(shape) / most))), 0)
        self.cell = 2**self._halvings

    def means(self, field: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the means of a field over the coarser cells."""
        if not self._halvings:
            return field
        return np.concatenate([self.means_in_slab(field[slab]) for slab in slabs(self._shape, self.cell)])

    def means_in_slab(self, field: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the means of a field in one of the :func:`.boxes.slabs` of a multiple of `cell` layers."""
        for _ in range(self._halvings):
            field = halved(field, len(self._shape))
        return field

    def holding(self, cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return the coarser cells that hold at least one of some cells."""
        for _ in range(self._halvings):
            cells = _evenly_padded(cells, cells.ndim)
            for axis in range(cells.ndim):
                even, odd = _pairs(axis)
                cells = cells[even] | cells[odd]
        return cells

    def interpolated(self, field: NDArray[np.floating], box: Box | None = None) -> NDArray[np.float32]:
        """Interpolate a field of the coarser grid on the finer one, or in a box of it."""
        within = tuple(map(slice, self._shape)) if box is None else box
        spans = [span.indices(size)[:2] for span, size in zip(within, self._shape, strict=True)]
        # Values depend on the coarser cells around them and on those beside these.
        firsts = [max(start // self.cell - 1, 0) for start, _ in spans]
        outer = tuple(slice(first, -(-stop // self.cell) + 1) for first, (_, stop) in zip(firsts, spans, strict=True))
        field = field[outer]
        sizes = [
            min(count * self.cell, size - first * self.cell)
            for count, size, first in zip(field.shape, self._shape, firsts, strict=True)
        ]
        for halving in reversed(range(self._halvings)):
            field = doubled(field, [-(-size // 2**halving) for size in sizes])
        inner = tuple(
            slice(start - first * self.cell, stop - first * self.cell)
            for first, (start, stop) in zip(firsts, spans, strict=True)
        )
        return field[inner].astype(np.float32, copy=False)

    def within(self, cells: NDArray[np.bool_], box: Box | None = None) -> NDArray[np.bool_]:
        """Return the finer cells, or those in a box, whose interpolated values depend on some coarser cells alone."""
        # Weights are sums of powers of two, so the interpolated mask is exact.
        return self.interpolated(cells.astype(np.float32), box) == 1.0

    def finer_box(self, box: Box) -> Box:
        """Return the finer cells in a box of coarser ones."""
        return tuple(
            slice(span.start * self.cell, min(span.stop * self.cell, size))
            for span, size in zip(box, self._shape, strict=True)
        )
