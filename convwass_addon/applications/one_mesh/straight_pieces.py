# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths of many points as few straight pieces.

Pieces whose ends lie on a curved path leave it to one side. With ends a little beyond it, by least squares, they stay
within about two thirds of that, so that fewer are needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

# Pieces with their ends on the path may leave it by so many times what is allowed, the longest first.
_LONGER = (2.0, 1.8, 1.6, 1.4, 1.2, 1.0)


@dataclass(frozen=True)
class FittedPieces:
    """Straight pieces along a path.

    Attributes
    ----------
    ends : list of int
        Samples at whose times the pieces end, the last one among them; the first piece begins at sample 0.
    positions : (k, n, 3) float64
        The points there: at the last sample exactly, in between where the pieces follow the path best.
    deviation : float
        How far a point is at the most from where it belongs.
    """

    ends: list[int]
    positions: NDArray[np.float64]
    deviation: float


def fitted_pieces(samples: Sequence[NDArray[np.float64]], most: float) -> FittedPieces:
    """Follow a path by few straight pieces; the parameters are those of :func:`straight_pieces`."""
    for factor in _LONGER:
        found = _fitted(samples, straight_pieces(samples, factor * most))
        if found.deviation <= most:
            return found
    # With their ends on the path the pieces stay within what is allowed.
    ends = straight_pieces(samples, most)
    return FittedPieces(ends, np.stack([samples[end] for end in ends]), _deviation(samples, (0, *ends)))


def _fitted(samples: Sequence[NDArray[np.float64]], ends: list[int]) -> FittedPieces:
    """Place the inner ends by least squares over all samples."""
    knots = np.array([0, *ends])
    times = np.arange(len(samples))
    hats = np.stack([np.interp(times, knots, row) for row in np.eye(len(knots))], axis=1)
    path = np.stack(samples).reshape(len(samples), -1)
    # Both ends of the path stay where they are.
    fixed = hats[:, [0, -1]] @ path[[0, -1]]
    inner = np.linalg.lstsq(hats[:, 1:-1], path - fixed, rcond=None)[0]
    away = (fixed + hats[:, 1:-1] @ inner - path).reshape(len(samples), -1, 3)
    positions = np.concatenate([inner, path[-1:]]).reshape(len(ends), -1, 3)
    return FittedPieces(ends, positions, float(np.linalg.norm(away, axis=2).max()))


def _deviation(samples: Sequence[NDArray[np.float64]], knots: Sequence[int]) -> float:
    return max(strayed(samples, begin, end) for begin, end in pairwise(knots))


def straight_pieces(samples: Sequence[NDArray[np.float64]], most: float) -> list[int]:
    """Choose the ends of as few straight pieces as follow a path.

    Each piece leads to the farthest sample that it can reach, which gives the fewest pieces. Along a piece the points
    move at an even pace.

    Parameters
    ----------
    samples : sequence of (n, 3) float64
        Where the points are, at even steps of time; two samples at least.
    most : float
        How far a point may be from where it belongs at the time of any sample.

    Returns
    -------
    list of int
        Samples at which the pieces end, the last one among them; the first piece begins at sample 0.
    """
    last, ends, begin = len(samples) - 1, [], 0
    while begin < last:
        reached = begin + 1
        while reached < last and strayed(samples, begin, reached + 1) <= most:
            reached += 1
        ends.append(reached)
        begin = reached
    return ends


def strayed(samples: Sequence[NDArray[np.float64]], begin: int, end: int) -> float:
    """Return how far points are at the most from the straight and even way between two samples."""
    away = 0.0
    for index in range(begin + 1, end):
        t = (index - begin) / (end - begin)
        straight = (1.0 - t) * samples[begin] + t * samples[end]
        away = max(away, float(np.linalg.norm(samples[index] - straight, axis=1).max()))
    return away
