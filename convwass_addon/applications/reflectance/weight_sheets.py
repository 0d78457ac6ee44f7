# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""At which weights materials are blended: along a way of weights, or all over a pad."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError

MOST_ON_PAD = 16
"""Blends along each side: their tables lie in one image, and no graphics card takes more rows than those of these."""


def way_weights(rows: ArrayLike, steps: int) -> NDArray[np.float64]:
    """Weights on the way through some, evenly from each to the next, (steps, k).

    Parameters
    ----------
    rows : (n, k)
        Through which the way goes; two at least.
    steps : int
        How many there shall be.

    Raises
    ------
    InputError
        There are not two rows, or they are not equally long.
    """
    try:
        stops = np.asarray(rows, dtype=np.float64)
    except ValueError as error:
        raise InputError("All stops of a way must have the same number of weights.") from error
    if stops.ndim != 2 or len(stops) < 2:
        raise InputError("A way of weights needs two stops at least.")
    places = np.linspace(0.0, len(stops) - 1.0, steps)
    return np.stack([np.interp(places, np.arange(len(stops)), column) for column in stops.T], axis=1)


@dataclass(frozen=True)
class PadSheet:
    """The blends that a pad is made of: a square of side x side places, of which the upper edge of a triangle is one.

    Attributes
    ----------
    side : int
        Places along each side.
    weights : (n, k) float64
        Of what is blended, each once; neighbors in this order are neighbors on the pad.
    numbers : (side * side,) int64
        Which of them is at each place, row by row from below, from the left.
    """

    side: int
    weights: NDArray[np.float64]
    numbers: NDArray[np.int64]

    @classmethod
    def of(cls, count: int, side: int) -> PadSheet:
        """Lay out three materials (left below, right below, above) or four (left above, right above, left below, ...).

        Raises
        ------
        InputError
            Another number of materials, or too few or too many places along a side.
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
    """Weights at a place of a pad, both from 0 to 1; in a triangle `across` counts along the line at that height."""
    left, right, below = 1.0 - across, across, 1.0 - up
    if count == 3:
        return (left * below, right * below, up)
    return (left * up, right * up, left * below, right * below)


def spread_out(sheet: PadSheet, values: Sequence[object]) -> list[object]:
    """Return the values of the blends of a sheet at all its places."""
    return [values[number] for number in sheet.numbers]
