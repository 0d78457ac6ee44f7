# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sets of blend weights: along a path, or over a whole pad."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.plane.polylines import along_polyline

MOST_ON_PAD = 16
"""Largest number of blends along each side: all tables lie in one image, whose rows graphics cards limit."""


def way_weights(rows: ArrayLike, steps: int) -> NDArray[np.float64]:
    """Weights along a path through given ones, evenly spaced from each to the next, (steps, k).

    Parameters
    ----------
    rows : (n, k)
        Weights to pass through; at least two rows.
    steps : int
        Number of results.

    Raises
    ------
    InputError
        Fewer than two rows, or rows of different lengths.
    """
    try:
        stops = np.asarray(rows, dtype=np.float64)
    except ValueError as error:
        raise InputError("All stops of a path must have the same number of weights.") from error
    if stops.ndim != 2 or len(stops) < 2:
        raise InputError("A path of weights needs at least two stops.")
    places = np.linspace(0.0, len(stops) - 1.0, steps)
    return along_polyline(places, np.arange(len(stops)), stops)


@dataclass(frozen=True)
class PadSheet:
    """The blends of a pad: a square grid of side x side cells; for a triangle, all cells of the top row are equal.

    Attributes
    ----------
    side : int
        Cells along each side.
    weights : (n, k) float64
        Distinct weights; consecutive ones are neighbors on the pad.
    numbers : (side * side,) int64
        Index into `weights` of each cell, row by row from the bottom, left to right.
    """

    side: int
    weights: NDArray[np.float64]
    numbers: NDArray[np.int64]

    @classmethod
    def of(cls, count: int, side: int) -> PadSheet:
        """Arrange three materials (bottom left, bottom right, top) or four (top left, top right, bottom left, ...).

        Raises
        ------
        InputError
            Another number of materials, or too few or too many cells along a side.
        """
        if count not in (3, 4):
            raise InputError("A pad blends three or four materials, not {count}.", count=count)
        if not 2 <= side <= MOST_ON_PAD:
            raise InputError("A pad has 2 to {most} blends along each side.", most=MOST_ON_PAD)
        found: dict[tuple[float, ...], int] = {}
        numbers = np.empty((side, side), dtype=np.int64)
        for row in range(side):
            for column in range(side) if row % 2 == 0 else reversed(range(side)):
                weights = pad_weights(count, column / (side - 1), row / (side - 1))
                numbers[row, column] = found.setdefault(weights, len(found))
        return cls(side, np.array(list(found)), numbers.ravel())


def pad_weights(count: int, across: float, up: float) -> tuple[float, ...]:
    """Weights at a point of a pad, coordinates from 0 to 1; in a triangle `across` is relative to the line at `up`."""
    left, right, below = 1.0 - across, across, 1.0 - up
    if count == 3:
        return (left * below, right * below, up)
    return (left * up, right * up, left * below, right * below)


def spread_out(sheet: PadSheet, values: Sequence[object]) -> list[object]:
    """Expand the values of a sheet's distinct blends to all its cells."""
    return [values[number] for number in sheet.numbers]
