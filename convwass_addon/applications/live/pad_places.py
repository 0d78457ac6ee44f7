# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Places on a pad and the weights there: a line between two shapes, a triangle of three, a square of four.

A place is (across, up), both 0 to 1. Two shapes are to the left and right; three at the lower left, lower right and
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
# Height of a pad in sides: that of an even triangle for three shapes.
_HEIGHTS = {2: 0.0, 3: float(np.sqrt(0.75)), 4: 1.0}


def pad_corners(count: int) -> NDArray[np.float64]:
    """Return the places of two, three or four shapes, (k, 2)."""
    return np.array(_CORNERS[count])


def pad_height(count: int) -> float:
    """Return how high the pad of so many shapes is drawn where its side is 1."""
    return _HEIGHTS[count]


def pad_middle(count: int) -> tuple[float, float]:
    """Return the place where all shapes have the same weight."""
    across, up = pad_corners(count).mean(axis=0)
    return float(across), float(up)


def pad_weights(count: int, across: float, up: float) -> NDArray[np.float64]:
    """Return the weights, (k,), at a place; beyond the rim those on the rim.

    Raises
    ------
    InputError
        A place that is no number.
    """
    if count == 2:
        return path_weights(across, 2)
    if count == 4:
        return square_weights(across, 1.0 - up)
    right = across - up / 2.0
    return checked_weights((1.0 - right - up, right, up), 3)
