# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Approximate paths of many points by few straight pieces.

Pieces with ends on a curved path lie on one side of it. If the ends are moved beyond the path by least squares, the
distance falls to about two thirds, so that fewer pieces are needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

# Multiples of the allowed distance that are tried for pieces with ends on the path, before the ends are moved.
_LONGER = (2.0, 1.8, 1.6, 1.4, 1.2, 1.0)


@dataclass(frozen=True)
class FittedPieces:
    """Straight pieces along a path.

    Attributes
    ----------
    ends : list of int
        Samples at which the pieces end, including the last one; the first piece begins at sample 0.
    positions : (k, n, 3) float64
        The points at these ends: exact at the last sample, otherwise fitted to the path.
    deviation : float
        Largest distance of a point from its path.
    """

    ends: list[int]
    positions: NDArray[np.float64]
    deviation: float


def fitted_pieces(samples: Sequence[NDArray[np.float64]], most: float) -> FittedPieces:
    """Follow a path by few straight pieces; parameters as for :func:`straight_pieces`."""
    for factor in _LONGER:
        found = _fitted(samples, straight_pieces(samples, factor * most))
        if found.deviation <= most:
            return found
    # With ends on the path, the pieces stay within the allowed distance.
    ends = straight_pieces(samples, most)
    return FittedPieces(ends, np.stack([samples[end] for end in ends]), _deviation(samples, (0, *ends)))


def _fitted(samples: Sequence[NDArray[np.float64]], ends: list[int]) -> FittedPieces:
    """Fit the inner ends by least squares over all samples."""
    knots = np.array([0, *ends])
    times = np.arange(len(samples))
    hats = np.stack([np.interp(times, knots, row) for row in np.eye(len(knots))], axis=1)
    path = np.stack(samples).reshape(len(samples), -1)
    # Both ends of the path are fixed.
    fixed = hats[:, [0, -1]] @ path[[0, -1]]
    inner = np.linalg.lstsq(hats[:, 1:-1], path - fixed, rcond=None)[0]
    away = (fixed + hats[:, 1:-1] @ inner - path).reshape(len(samples), -1, 3)
    positions = np.concatenate([inner, path[-1:]]).reshape(len(ends), -1, 3)
    return FittedPieces(ends, positions, float(np.linalg.norm(away, axis=2).max()))


def _deviation(samples: Sequence[NDArray[np.float64]], knots: Sequence[int]) -> float:
    return max(strayed(samples, begin, end) for begin, end in pairwise(knots))


def straight_pieces(samples: Sequence[NDArray[np.float64]], most: float) -> list[int]:
    """Choose the ends of the fewest straight pieces that follow a path.

    Each piece leads to the farthest sample that it can reach, which minimizes their number. Points move along a piece
    at constant speed.

    Parameters
    ----------
    samples : sequence of (n, 3) float64
        Positions of the points at equal steps of time; at least two samples.
    most : float
        Largest allowed distance of a point from its position at the time of any sample.

    Returns
    -------
    list of int
        Samples at which the pieces end, including the last one; the first piece begins at sample 0.
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
    """Return the largest distance of points from uniform motion on a straight line between two samples."""
    away = 0.0
    for index in range(begin + 1, end):
        t = (index - begin) / (end - begin)
        straight = (1.0 - t) * samples[begin] + t * samples[end]
        away = max(away, float(np.linalg.norm(samples[index] - straight, axis=1).max()))
    return away
