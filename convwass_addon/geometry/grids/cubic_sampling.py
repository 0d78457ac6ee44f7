# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Values and gradients of a field between its samples, by cubic convolution.

Keys, "Cubic convolution interpolation for digital image processing", IEEE Transactions on Acoustics, Speech, and Signal
Processing 29 (1981): interpolates the samples, is exact for quadratic polynomials, and has continuous gradients.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.chunks import chunks

# Points processed together: their 64 samples fit into the cache.
_AT_ONCE = 2048


@dataclass(frozen=True)
class CubicSamples:
    """Values and gradients of a field at some points.

    Attributes
    ----------
    values : (n,) float32
    gradients : (n, 3) float32
        Per unit of sample spacing.
    """

    values: NDArray[np.float32]
    gradients: NDArray[np.float32]


def cubic_samples(field: NDArray[np.float32], points: NDArray[np.floating]) -> CubicSamples:
    """Interpolate a field.

    Parameters
    ----------
    field : (nx, ny, nz) float32
        At least four samples along each axis, the first at coordinate zero, with spacing one; C-contiguous.
    points : (n, 3)
        Between the second and the second to last sample along each axis; values outside are extrapolated.
    """
    strides = np.array([field.shape[1] * field.shape[2], field.shape[2], 1])
    offsets = np.add.outer(np.add.outer(np.arange(4) * strides[0], np.arange(4) * strides[1]), np.arange(4)).ravel()
    low = np.clip(np.floor(points), 1, np.subtract(field.shape, 3)).astype(np.int64)
    first = (low - 1) @ strides
    shares = np.subtract(points, low, dtype=np.float32)
    values, gradients = np.empty(len(points), np.float32), np.empty((len(points), 3), np.float32)
    for part in chunks(len(points), _AT_ONCE):
        around = field.ravel()[offsets[:, None] + first[part]].reshape(16, 4, -1)
        (x, dx), (y, dy), (z, dz) = (_weights(share) for share in np.ascontiguousarray(shares[part].T))
        lines, line_slopes = ((around * weights).sum(axis=1).reshape(4, 4, -1) for weights in (z, dz))
        plane = (lines * y).sum(axis=1)
        values[part] = (plane * x).sum(axis=0)
        gradients[part, 0] = (plane * dx).sum(axis=0)
        gradients[part, 1] = ((lines * dy).sum(axis=1) * x).sum(axis=0)
        gradients[part, 2] = ((line_slopes * y).sum(axis=1) * x).sum(axis=0)
    return CubicSamples(values, gradients)


def _weights(share: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Weights of the four samples around a point at distance `share`, (n,), from the second, and their derivatives."""
    weights = np.stack(
        [
            share * (share * (1.0 - 0.5 * share) - 0.5),
            share * share * (1.5 * share - 2.5) + 1.0,
            share * (share * (2.0 - 1.5 * share) + 0.5),
            share * share * (0.5 * share - 0.5),
        ]
    )
    slopes = np.stack(
        [
            share * (2.0 - 1.5 * share) - 0.5,
            share * (4.5 * share - 5.0),
            share * (4.0 - 4.5 * share) + 0.5,
            share * (1.5 * share - 1.0),
        ]
    )
    return weights, slopes
