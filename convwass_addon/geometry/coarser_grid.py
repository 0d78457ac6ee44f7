# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids with fewer cells, for fields that need little accuracy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def halved(field: NDArray[np.floating], dimensions: int = 3) -> NDArray[np.floating]:
    """Return the means of 2 x 2 x 2 cells of a field (nx, ny, nz, ...); odd sides are padded with zeros.

    With another number of `dimensions`, only so many axes are halved.
    """
    field = np.pad(field, [(0, size % 2) for size in field.shape[:dimensions]] + [(0, 0)] * (field.ndim - dimensions))
    for axis in range(dimensions):
        even, odd = (slice(None),) * axis + (slice(0, None, 2),), (slice(None),) * axis + (slice(1, None, 2),)
        field = field.dtype.type(0.5) * (field[even] + field[odd])
    return field


def doubled(field: NDArray[np.floating], shape: Sequence[int]) -> NDArray[np.floating]:
    """Interpolate a field (mx, my, mz, ...) linearly on cells of half the size, in a grid of `shape`, up to three axes.

    It is constant beyond the outer centers.
    """
    for axis, size in enumerate(shape):
        near, far = field.dtype.type(0.75) * field, field.dtype.type(0.25) * field
        found = np.empty((*field.shape[:axis], 2 * field.shape[axis], *field.shape[axis + 1 :]), field.dtype)

        def along(part: slice, axis: int = axis) -> tuple[slice, ...]:
            return (slice(None),) * axis + (part,)

        found[along(slice(0, None, 2))] = found[along(slice(1, None, 2))] = near
        found[along(slice(2, None, 2))] += far[along(slice(None, -1))]
        found[along(slice(1, -1, 2))] += far[along(slice(1, None))]
        found[along(slice(0, 1))] += far[along(slice(0, 1))]
        found[along(slice(-1, None))] += far[along(slice(-1, None))]
        field = found[along(slice(0, size))]
    return field


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
        for _ in range(self._halvings):
            field = halved(field, len(self._shape))
        return field

    def holding(self, cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return the coarser cells that hold at least one of some cells."""
        return self.means(cells.astype(np.float32)) > 0.0 if self._halvings else cells

    def interpolated(self, field: NDArray[np.floating]) -> NDArray[np.float32]:
        """Interpolate a field of the coarser grid on the finer one."""
        for halving in reversed(range(self._halvings)):
            field = doubled(field, [-(-size // 2**halving) for size in self._shape])
        return field.astype(np.float32, copy=False)

    def within(self, cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return the finer cells whose interpolated values depend on some coarser cells alone."""
        # Weights are sums of powers of two, so the interpolated mask is exact.
        return self.interpolated(cells.astype(np.float32)) == 1.0 if self._halvings else cells
