# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Resample fields to grids of half or twice the resolution."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def halved(field: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the means of 2 x 2 x 2 cells of a field (nx, ny, nz, ...); odd sides are padded with zeros."""
    field = np.pad(field, [(0, size % 2) for size in field.shape[:3]] + [(0, 0)] * (field.ndim - 3))
    for axis in range(3):
        even, odd = (slice(None),) * axis + (slice(0, None, 2),), (slice(None),) * axis + (slice(1, None, 2),)
        field = 0.5 * (field[even] + field[odd])
    return field


def doubled(field: NDArray[np.float64], shape: Sequence[int]) -> NDArray[np.float64]:
    """Interpolate a field (mx, my, mz, ...) linearly on cells of half the size, in a grid of `shape`, (3,).

    It is constant beyond the outer centers.
    """
    for axis, size in enumerate(shape):
        values = np.moveaxis(field, axis, 0)
        before, after = np.concatenate([values[:1], values[:-1]]), np.concatenate([values[1:], values[-1:]])
        doubled = np.empty((2 * len(values), *values.shape[1:]))
        doubled[0::2] = 0.75 * values + 0.25 * before
        doubled[1::2] = 0.75 * values + 0.25 * after
        field = np.moveaxis(doubled[:size], 0, axis)
    return field
