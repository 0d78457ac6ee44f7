# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A grid with fewer cells, for fields that need little accuracy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .grid_halving import doubled, halved


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
