# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays of a frame in a form that deflate compresses well.

Rows of integers are stored as the differences of successive entries, which are small because the vertices of an
extracted surface are in the order of the cells. Signs are folded into the lowest bit, and the four bytes of each
number are separated, so that the leading zeros of all numbers are adjacent. Positions are rounded to multiples of a
power of two first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

_BYTES = 4
# Differences of integers up to this size fit into four bytes with their sign.
_LARGEST = 1 << 30
# Of a step: multiples of it remain finite.
_LARGEST_EXPONENT = 900


def packed_integers(values: NDArray[np.integer]) -> NDArray[np.uint8]:
    """Return rows of integers as bytes.

    Parameters
    ----------
    values : (k, n) int
        Absolute values below 2^30.

    Returns
    -------
    (4, k, n) uint8
        For :func:`unpacked_integers`.
    """
    differences = np.diff(values.astype(np.int64), axis=1, prepend=0)
    folded = ((differences << 1) ^ (differences >> 63)).astype("<u4")
    return np.ascontiguousarray(np.moveaxis(folded[..., None].view(np.uint8), -1, 0))


def unpacked_integers(planes: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Return the rows of integers, (k, n), of :func:`packed_integers`.

    Raises
    ------
    ValueError
        The bytes are not those of integers below 2^30.
    """
    if planes.ndim != 3 or len(planes) != _BYTES:
        raise ValueError("its numbers do not have four bytes each")
    folded = np.ascontiguousarray(np.moveaxis(planes, 0, -1)).view("<u4")[..., 0].astype(np.int64)
    values = np.cumsum((folded >> 1) ^ -(folded & 1), axis=1)
    if values.size and np.abs(values).max() >= _LARGEST:
        raise ValueError("its numbers are too large")
    return values


@dataclass(frozen=True)
class Rounding:
    """Positions as multiples of a power of two.

    Attributes
    ----------
    exponent : int
        The step is 2^exponent.
    lows : (k, 3) float64
        Lowest corner of each of k sets of points.
    """

    exponent: int
    lows: NDArray[np.float64]

    @property
    def step(self) -> float:
        """Distance between neighboring positions along an axis."""
        return float(np.ldexp(1.0, self.exponent))

    @classmethod
    def of(cls, points: NDArray[np.floating], most: float) -> Rounding | None:
        """Choose a step.

        Parameters
        ----------
        points : (k, n, 3) float
            The positions; k and n are positive.
        most : float
            The largest step allowed; if it is zero, points are stored as they are.

        Returns
        -------
        Rounding or None
            None if the points are too far apart for this step, or if it is zero or extreme.
        """
        if not most > 0.0:
            return None
        lows = points.min(axis=1).astype(np.float64)
        widest = float((points.max(axis=1) - lows).max())
        exponent = int(np.floor(np.log2(most)))
        if abs(exponent) > _LARGEST_EXPONENT or widest >= float(np.ldexp(_LARGEST, exponent)):
            return None
        return cls(exponent, lows)

    @classmethod
    def read(cls, exponent: object, lows: ArrayLike) -> Rounding:
        """Return a rounding from a file.

        Raises
        ------
        ValueError
            Not the values of a rounding.
        """
        found = np.asarray(lows, dtype=np.float64)
        if type(exponent) is not int or abs(exponent) > _LARGEST_EXPONENT or found.ndim != 2 or found.shape[1] != 3:
            raise ValueError("its positions have no step")
        return cls(exponent, found)

    def rounded(self, points: NDArray[np.floating]) -> NDArray[np.int64]:
        """Return the multiples nearest to k sets of points, (k, n, 3), as rows of integers, (3 k, n)."""
        steps = np.rint((points - self.lows[:, None]) / self.step).astype(np.int64)
        return np.moveaxis(steps, 2, 1).reshape(-1, points.shape[1])

    def positions(self, steps: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the k sets of points, (k, n, 3), of rows of integers.

        Raises
        ------
        ValueError
            There are not three rows for each set.
        """
        if len(steps) != 3 * len(self.lows):
            raise ValueError("its positions do not have three coordinates")
        return np.moveaxis(steps.reshape(len(self.lows), 3, -1), 1, 2) * self.step + self.lows[:, None]
