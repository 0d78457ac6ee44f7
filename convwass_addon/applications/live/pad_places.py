# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions on a pad and the weights there: a line for two shapes, a triangle for three, a square for four.

A position is (across, up), both 0 to 1. Two shapes are at the left and right; three at the lower left, lower right and
top; four at the upper left, upper right, lower left and lower right, as on the sheets of :mod:`..morphs.layouts`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .weight_layouts import checked_weights, path_weights, square_weights

_CORNERS = {
    2: ((0.0, 0.0), (1.0, 0.0)),
    3: ((0.0, 0.0), (1.0, 0.0), (0.5, 1.0)),
    4: ((0.0, 1.0), (1.0, 1.0), (0.0, 0.0), (1.0, 0.0)),
}
# Height of a pad relative to its width; for three shapes that of an equilateral triangle.
_HEIGHTS = {2: 0.0, 3: float(np.sqrt(0.75)), 4: 1.0}


def pad_corners(count: int) -> NDArray[np.float64]:
    """Return the positions of two, three or four shapes, (k, 2)."""
    return np.array(_CORNERS[count])


def pad_height(count: int) -> float:
    """Return the height of a pad for this many shapes, relative to its width."""
    return _HEIGHTS[count]


def pad_points(count: int, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return positions, (n, 2), as points of the XZ plane, (n, 3), on a pad of width 1 around the origin."""
    across, up = places.T
    return np.stack([across - 0.5, np.zeros(len(places)), pad_height(count) * (up - 0.5)], axis=1)


def pad_middle(count: int) -> tuple[float, float]:
    """Return the position at which all shapes have the same weight."""
    across, up = pad_corners(count).mean(axis=0)
    return float(across), float(up)


def pad_weights(count: int, across: float, up: float) -> NDArray[np.float64]:
    """Return the weights, (k,), at a position; outside the pad, those of the nearest position.

    Raises
    ------
    InputError
        A coordinate is not a number.
    """
    if count == 2:
        return path_weights(across, 2)
    if count == 4:
        return square_weights(across, 1.0 - up)
    right = across - up / 2.0
    return checked_weights((1.0 - right - up, right, up), 3)
