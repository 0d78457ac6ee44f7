# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors in and around blends, on coarse cells, and the colors of mixtures of blends.

Half the resolution of the level fields suffices while the handle moves; when it rests, the blend gets its full colors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from ...geometry.arrays.bounds import bounds_of, common_bounds
from ...one_line import one_line

CELL = 2
"""Size of a coarse cell, in cells of the level fields."""


@dataclass(frozen=True, eq=False)
class ColorField:
    """Colors of one blend.

    Attributes
    ----------
    places : (m, 3) int32
        Coarse cells of the common grid, without duplicates; other cells have no known color.
    colors : (m, 3) float16
        RGB, scene linear.
    """

    places: NDArray[np.int32]
    colors: NDArray[np.float16]

    __repr__ = one_line("places")

    @property
    def nbytes(self) -> int:
        """Memory in bytes."""
        return self.places.nbytes + self.colors.nbytes


def places_about(is_inside: NDArray[np.bool_], low: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return the coarse cells that overlap given cells, and their neighbors, (m, 3).

    Parameters
    ----------
    is_inside : (nx, ny, nz) bool
        The given cells, in a box.
    low : (3,) int64
        First cell of the box on the common grid.
    """
    # Margins: one coarse cell for the neighbors, and single cells so that the box begins with a coarse cell.
    before = low % CELL + CELL
    after = -(low + is_inside.shape) % CELL + CELL
    padded = np.pad(is_inside, list(zip(before.tolist(), after.tolist(), strict=True)))
    nx, ny, nz = (n // CELL for n in padded.shape)
    coarse = padded.reshape(nx, CELL, ny, CELL, nz, CELL).any(axis=(1, 3, 5))
    near = binary_dilation(coarse, np.ones((3, 3, 3), bool))
    return (np.argwhere(near) + (low - before) // CELL).astype(np.int32)


def centers_of(places: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return the centers of coarse cells, (m, 3), in cells of the common grid."""
    return (places + 0.5) * CELL


def mixed_colors(
    fields: Sequence[ColorField], shares: Sequence[float], points: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Return the colors of a mixture of blends at points, (n, 3) each: RGB, scene linear.

    Fields without a known color at a point do not contribute there.

    Parameters
    ----------
    fields : sequence of ColorField
        At least one field.
    shares : sequence of float
        One per field, not negative.
    points : (n, 3) float64
        In cells of the common grid.
    """
    low, high = common_bounds([bounds_of(field.places) for field in fields])
    shape = tuple(int(n) for n in high - low + 2)
    strides = (shape[1] * shape[2], shape[2], 1)
    # Premultiplied colors with their shares as the fourth column: float32 in one row per cell is three times as fast.
    sums = np.zeros((shape[0] * strides[0], 4), np.float32)
    for field, share in zip(fields, shares, strict=True):
        own = np.ones((len(field.places), 4), np.float32)
        own[:, :3] = field.colors
        own *= np.float32(share)
        sums[_numbers((field.places - low).T, strides)] += own
    scaled = (points / CELL - 0.5 - low).astype(np.float32).T
    scaled = [np.clip(along, 0.0, n - 1.001) for along, n in zip(scaled, shape, strict=True)]
    cells = [along.astype(np.int32) for along in scaled]
    parts = [along - cell for along, cell in zip(scaled, cells, strict=True)]
    found = _interpolated(sums, _numbers(cells, strides), strides, parts)
    return found[:, :3] / np.maximum(found[:, 3:], np.finfo(np.float32).tiny)


def _numbers(cells: Sequence[NDArray[np.integer]], strides: Sequence[int]) -> NDArray[np.integer]:
    """Return the rows of cells given by their coordinates, (n,) each."""
    return sum(along * stride for along, stride in zip(cells, strides, strict=True))


def _interpolated(
    values: NDArray[np.float32],
    rows: NDArray[np.integer],
    strides: Sequence[int],
    parts: Sequence[NDArray[np.float32]],
) -> NDArray[np.float32]:
    """Interpolate rows of values linearly along every axis; `parts` are the positions between adjacent cells."""
    if not strides:
        return values.take(rows, axis=0)
    start = _interpolated(values, rows, strides[1:], parts[1:])
    end = _interpolated(values, rows + strides[0], strides[1:], parts[1:])
    end -= start
    end *= parts[0][:, None]
    start += end
    return start
