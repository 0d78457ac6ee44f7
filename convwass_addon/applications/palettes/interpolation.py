# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear interpolation of tables, in a third of the time of SciPy's map_coordinates for many channels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays.chunks import chunks

# Points processed together: their data fits into the processor's cache.
_AT_ONCE = 1 << 16


def interpolated(tables: Sequence[NDArray[np.float32]], places: NDArray[np.floating]) -> NDArray[np.floating]:
    """Interpolate linearly along every axis, with the nearest entry beyond the ends.

    Parameters
    ----------
    tables : sequence of (s1, ..., sd) float32
        Of equal shape, with at least two entries along every axis; in C order.
    places : (d, n) float32 or float64
        Points to interpolate at, in units of entries; finite.

    Returns
    -------
    (tables, n) of the type of `places`
    """
    shape = tables[0].shape
    strides = tuple(int(np.prod(shape[axis + 1 :])) for axis in range(len(shape)))
    flat = [table.reshape(-1) for table in tables]
    found = np.empty((len(flat), places.shape[1]), dtype=places.dtype)
    for part in chunks(places.shape[1], _AT_ONCE):
        cells = np.zeros(len(places[0, part]), dtype=np.intp)
        shares = []
        for axis, size, stride in zip(places[:, part], shape, strides, strict=True):
            own = np.clip(axis, 0.0, size - 1.0)
            low = own.astype(np.intp)
            np.minimum(low, size - 2, out=low)
            shares.append(own - low.astype(own.dtype))
            low *= stride
            cells += low
        for values, own in zip(flat, found, strict=True):
            own[part] = _mixed(values, strides, cells, shares)
    return found


def _mixed(
    values: NDArray[np.float32],
    strides: tuple[int, ...],
    cells: NDArray[np.intp],
    shares: Sequence[NDArray[np.floating]],
) -> NDArray[np.float32]:
    """Interpolate along the first axis between the two ends, each interpolated along the remaining axes."""
    if not strides:
        # No index is out of range; "clip" is NumPy's fastest check.
        return values.take(cells, mode="clip")
    low = _mixed(values, strides[1:], cells, shares[1:])
    high = _mixed(values[strides[0] :], strides[1:], cells, shares[1:])
    high -= low
    high *= shares[0]
    high += low
    return high
