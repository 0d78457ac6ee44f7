# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Approximate the path of many points by few straight pieces.

Pieces that end on a curved path deviate to one side of it. Least squares moves the inner ends a little beyond the path,
which leaves about two thirds of the deviation, so that fewer pieces are needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...geometry.polylines import along_polyline
from ...geometry.products import product
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence

# Pieces are chosen by so many times the allowed error, the longest first: twice it is more than any fit makes up for,
# and half of it leaves room for points that were not among the probes.
_LONGER = (2.0, 1.8, 1.6, 1.4, 1.2, 1.0, 0.8, 0.5)
# Number of points, about, at which the error of a piece between two samples is measured first.
_PROBES = 2000


class Criterion(Protocol):
    """What pieces must satisfy: errors, as multiples of what is allowed."""

    def between(self, begin: int, end: int) -> float:
        """Return an estimate of the error of the straight piece from one sample to another."""

    def along(self, knots: Sequence[int], positions: NDArray[np.float64], control: Control) -> float:
        """Return the error of pieces between positions, (k, n, 3), that are reached at the samples `knots`."""


@dataclass(frozen=True)
class StayNear:
    """Points stay close to where they are at the time of each sample.

    Attributes
    ----------
    path : (f, n, 3) float64
        Positions at even steps of time.
    most : float
        Largest distance.
    """

    path: NDArray[np.float64]
    most: float

    def between(self, begin: int, end: int) -> float:
        """Measure the distances of some of the points."""
        probes = self.path[:, :: max(1, self.path.shape[1] // _PROBES)]
        return _strayed(probes, begin, end, probes[begin], probes[end], UNINTERRUPTED) / self.most

    def along(self, knots: Sequence[int], positions: NDArray[np.float64], control: Control) -> float:
        """Measure all distances."""
        return deviation(self.path, knots, positions, control) / self.most


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
        Largest distance of a point from where it belongs.
    """

    ends: list[int]
    positions: NDArray[np.float64]
    deviation: float


def fitted_pieces(
    path: NDArray[np.float64], criteria: Sequence[Criterion], message: Sentence, control: Control
) -> Work[FittedPieces]:
    """Follow a path by few straight pieces that satisfy some criteria; if no pieces do, by those that come close.

    Parameters
    ----------
    path : (f, n, 3) float64
        Positions at even steps of time.
    criteria : sequence of Criterion
        What the pieces must satisfy.
    message : Sentence
        Reported with the progress.
    control : Control
        Stops the work.
    """
    for number, factor in enumerate(_LONGER):
        control.check()
        yield Progress(number / len(_LONGER), message)
        knots = [0, *straight_pieces(len(path), criteria, factor)]
        # Ends on the path are only as good as the pieces were chosen.
        tries = [_fitted(path, knots)] if factor > 1.0 else [_fitted(path, knots), path[knots]]
        for positions in tries:
            if all(own.along(knots, positions, control) <= 1.0 for own in criteria):
                return FittedPieces(knots[1:], positions[1:], deviation(path, knots, positions, control))
    return FittedPieces(knots[1:], path[knots[1:]], deviation(path, knots, path[knots], control))


def straight_pieces(count: int, criteria: Sequence[Criterion], most: float = 1.0) -> list[int]:
    """Choose the ends of as few straight pieces as follow a path.

    Each piece leads to the farthest sample that it can reach, which gives the fewest pieces. Along a piece the points
    move at an even pace.

    Parameters
    ----------
    count : int
        Number of samples, two at least.
    criteria : sequence of Criterion
        What each piece must satisfy.
    most : float
        Allowed multiple of their errors.

    Returns
    -------
    list of int
        Samples at which the pieces end, the last one among them; the first piece begins at sample 0.
    """
    last, ends, begin = count - 1, [], 0
    while begin < last:
        reached = begin + 1
        while reached < last and all(own.between(begin, reached + 1) <= most for own in criteria):
            reached += 1
        ends.append(reached)
        begin = reached
    return ends


def deviation(
    path: NDArray[np.float64], knots: Sequence[int], positions: NDArray[np.float64], control: Control
) -> float:
    """Return the largest distance of points from a path, (f, n, 3), if they move straight between some positions."""
    pieces = zip(pairwise(knots), pairwise(positions), strict=True)
    return max(_strayed(path, begin, end, one, other, control) for (begin, end), (one, other) in pieces)


def _fitted(path: NDArray[np.float64], knots: list[int]) -> NDArray[np.float64]:
    """Return positions at the knots, (k, n, 3): at both ends as they are, in between by least squares."""
    times = np.arange(len(path))
    hats = along_polyline(times, knots, np.eye(len(knots)))
    # The inner positions are linear in the samples.
    inverse = np.linalg.pinv(hats[:, 1:-1])
    weights = inverse.copy()
    weights[:, [0, -1]] -= inverse @ hats[:, [0, -1]]
    found = np.empty((len(knots), *path.shape[1:]))
    found[[0, -1]] = path[[0, -1]]
    found[1:-1] = product(weights, path.reshape(len(path), -1)).reshape(-1, *path.shape[1:])
    return found


def _strayed(
    path: NDArray[np.float64],
    begin: int,
    end: int,
    one: NDArray[np.float64],
    other: NDArray[np.float64],
    control: Control,
) -> float:
    """Return the largest distance from the samples of a piece to points that move straight from `one` to `other`."""
    away = 0.0
    for index in range(begin, end + 1):
        control.check()
        t = (index - begin) / (end - begin)
        apart = (1.0 - t) * one + t * other - path[index]
        away = max(away, float(np.einsum("nd,nd->n", apart, apart).max()))
    return float(np.sqrt(away))
