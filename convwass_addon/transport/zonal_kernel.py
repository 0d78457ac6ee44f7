# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Gaussian of the geodesic distance on a latitude-longitude grid, exact even at the poles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry.algebra.products import contract
from .log_range import NEGLIGIBLE

# Chosen by eye; the costs of the kernel are measured in docs/performance, "Sphere".
# Number of longitude offsets that share a matrix product, whose result is then added once.
_OFFSETS = 8
# If the nonzero rows are polar caps of less than this fraction of all rows, the caps are multiplied separately.
_CAP = 0.45


def log_zonal(rows: int, columns: int, used: int, offset: int, sigma: float) -> NDArray[np.float64]:
    """Logarithm of exp(-d^2 / 2 sigma^2) between the first `used` rows, at an offset in longitude.

    Parameters
    ----------
    rows, columns : int
        Size of the whole sphere.
    used : int
        Number of rows, from the north pole.
    offset : int
        In columns.
    sigma : float
        In radians.

    Returns
    -------
    (used, used) float64
        Computed from the haversine, which is accurate at small distances, unlike the arc cosine.
    """
    theta = (np.arange(used) + 0.5) * (np.pi / rows)
    sines = np.sin(theta)
    turn = np.sin(np.pi * offset / columns) ** 2
    haversine = np.sin((theta[:, None] - theta) / 2.0) ** 2 + sines[:, None] * sines * turn
    distance = 2.0 * np.arcsin(np.sqrt(np.minimum(haversine, 1.0)))
    return -(distance**2) / (2.0 * sigma**2)


@dataclass(frozen=True)
class _Block:
    """Adjacent offsets and their kernels between some rows, stacked vertically."""

    offsets: range
    rows: slice
    kernel: NDArray[np.float64]


class ZonalKernel:
    """The kernel on a grid of latitudes and longitudes.

    Between two rows it depends only on the offset in longitude. Each offset has one matrix, which is applied to the sum
    of the columns at this offset to the left and to the right. All entries are positive and accurate to the last
    digits; a Fourier transform would lose these, since scalings span hundreds of orders of magnitude.

    Parameters
    ----------
    rows, columns : int
        Size of the whole sphere; `columns` even.
    used : int
        Number of rows, from the north pole: all, or half of them.
    sigma : float
        In radians.
    weights : (used,) float64
        Area weight of the cells of every row.
    """

    def __init__(self, rows: int, columns: int, used: int, sigma: float, weights: NDArray[np.float64]) -> None:
        half = columns // 2
        sums = np.zeros(used)
        matrices = []
        for offset in range(half + 1):
            matrix = np.exp(log_zonal(rows, columns, used, offset, sigma))
            sums += (matrix @ weights) * (1.0 if offset in (0, half) else 2.0)
            matrices.append(matrix)
        # No row sums to more than one.
        scale = float(1.0 / sums.max())
        self._blocks = []
        for start in range(0, half + 1, _OFFSETS):
            some = np.stack(matrices[start : start + _OFFSETS]) * scale
            some[some < NEGLIGIBLE] = 0.0
            offsets = range(start, start + len(some))
            for span in _spans(some, used == rows):
                part = some[:, span, span] * weights[span, None]
                size = span.stop - span.start
                self._blocks.append(_Block(offsets, span, np.asfortranarray(part.reshape(-1, size))))

    def apply(self, values: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write H (a * values), (k, used, columns) each, to `out`, which must be another array."""
        for source, target in zip(values, out, strict=True):
            self._apply_to(source, target)

    def _apply_to(self, values: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        columns = values.shape[1]
        turned = np.ascontiguousarray(values.T)
        around = np.concatenate([turned, turned, turned])
        out.fill(0.0)
        for block in self._blocks:
            size = block.rows.stop - block.rows.start
            sums = np.empty((columns, len(block.offsets), size))
            for place, offset in enumerate(block.offsets):
                right = around[columns + offset : 2 * columns + offset, block.rows]
                if offset in (0, columns // 2):
                    sums[:, place] = right
                else:
                    np.add(around[columns - offset : 2 * columns - offset, block.rows], right, out=sums[:, place])
            product = np.empty((size, columns))
            contract(sums.reshape(-1), product.reshape(-1), block.kernel)
            out[block.rows] += product


def _spans(matrices: NDArray[np.float64], both_poles: bool) -> list[slice]:
    """Nonzero rows as one span or as two caps; no span if all are zero."""
    used = matrices.shape[1]
    there = matrices.any(axis=(0, 2))
    if not there.any():
        return []
    if not both_poles:
        return [slice(0, int(np.flatnonzero(there)[-1]) + 1)]
    north = int(np.flatnonzero(there[: used // 2])[-1]) + 1 if there[: used // 2].any() else 0
    if north < _CAP * used:
        # Rows are symmetric about the equator.
        return [slice(0, north), slice(used - north, used)]
    return [slice(0, used)]
