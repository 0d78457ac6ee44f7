# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Resample fields to grids of half or twice the resolution."""

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
