# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distance transforms of a set of cells, up to a given distance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def capped_squares(inside: NDArray[np.bool_], reach: float) -> NDArray[np.integer]:
    """Squared distance of every cell's center from the nearest True cell, exact up to a given distance.

    For a few cells, shifted copies of small integers take a twentieth of the time of a full distance transform.

    Parameters
    ----------
    inside : (nx, ny, nz) bool
        The cells at distance zero.
    reach : float
        The largest distance, in cells.

    Returns
    -------
    (nx, ny, nz) unsigned integer
        Beyond `reach`, some number larger than its square.
    """
    most = int(reach**2) + 1
    steps = int(reach)
    dtype = np.min_scalar_type(most + steps**2)
    squares = np.where(inside, dtype.type(0), dtype.type(most))
    for axis in range(inside.ndim):
        before = squares.copy()
        for step in range(1, min(steps + 1, inside.shape[axis])):
            here = (slice(None),) * axis + (slice(None, -step),)
            there = (slice(None),) * axis + (slice(step, None),)
            along = before + dtype.type(step**2)
            np.minimum(squares[here], along[there], out=squares[here])
            np.minimum(squares[there], along[here], out=squares[there])
    return squares


def capped_distances(inside: NDArray[np.bool_], reach: float) -> NDArray[np.float32]:
    """Distance of every cell's center from the surface of a set of cells, which is half a cell from their centers.

    Parameters
    ----------
    inside : (nx, ny, nz) bool
        The cells.
    reach : float
        The largest distance between centers that counts, in cells.

    Returns
    -------
    (nx, ny, nz) float32
        In cells: zero inside, exact up to half a cell less than `reach`, and between that and `reach` farther away.
    """
    return np.clip(np.sqrt(capped_squares(inside, reach), dtype=np.float32) - np.float32(0.5), 0.0, reach)
