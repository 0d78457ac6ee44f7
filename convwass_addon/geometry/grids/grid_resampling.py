# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Trilinear interpolation of a field at the points of another grid with the same axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def resampled(
    field: NDArray[np.floating], first: NDArray[np.float64], step: float, shape: tuple[int, int, int]
) -> NDArray[np.floating]:
    """Interpolate a field linearly along each axis, with zeros around it.

    Parameters
    ----------
    field : (nx, ny, nz) float
        Values at the points of a grid.
    first : (3,) float64
        Place of the first point of the result, in indices of the field.
    step : float
        Distance between points of the result along each axis, in indices of the field.
    shape : tuple of int
        Number of points of the result along each axis.

    Returns
    -------
    ``shape``, of the field's type
    """
    # Three products with small matrices take a tenth of the time of scipy.ndimage.affine_transform.
    along_x, along_y, along_z = (
        np.maximum(1.0 - np.abs(begin + step * np.arange(count)[:, None] - np.arange(size)), 0.0).astype(field.dtype)
        for begin, count, size in zip(first, shape, field.shape, strict=True)
    )
    across = along_y @ (field @ along_z.T)
    return (along_x @ across.reshape(len(field), -1)).reshape(shape)
