# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Approximate the path of many points by few straight pieces.

Pieces that end on a curved path deviate to one side of it. Least squares moves the inner ends a little beyond the path,
which leaves about two thirds of the deviation, so that fewer pieces are needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.products import product
from ...geometry.arrays.chunks import chunks
from ...geometry.plane.polylines import along_polyline
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from .refined_samples import RefinedPath

# Pieces are chosen by so many times the allowed error, the longest first: twice it is more than any fit makes up for,
# and half of it leaves room for points that were not among the probes.
_LONGER = (2.0, 1.8, 1.6, 1.4, 1.2, 1.0, 0.8, 0.5)
# Number of points, about, at which the error of a piece between two samples is measured first.
_PROBES = 2000
# Points processed together; each needs about a kilobyte.
_AT_ONCE = 1 << 12


class Criterion(Protocol):
    """What pieces must satisfy: errors, as multiples of what is allowed."""

    def between(self, begin: int, end: int) -> float:
        """Return an estimate of the error of the straight piece from one position of a path to another."""

    def along(self, knots: Sequence[int], weights: NDArray[np.float64], control: Control) -> float:
        """Return the error of pieces between means of the samples with some weights, (k, s).

        They are reached at the times of the positions `knots`. An error of more than 1 may be an underestimate.
        """


@dataclass(frozen=True)
class StayNear:
    """Points stay close to where they are at the time of each position.

    Attributes
    ----------
    path : RefinedPath
        Where they are.
    most : float
        Largest distance.
    """

    path: RefinedPath
    most: float

    def between(self, begin: int, end: int) -> float:
        """Measure the distances of some of the points."""
        ends = self.path.weights[[begin, end]]
        away = self.path.weights[begin : end + 1] - along_polyline(np.arange(begin, end + 1), (begin, end), ends)
        return _longest(away, self._probes.samples, UNINTERRUPTED) / self.most

    def along(self, knots: Sequence[int], weights: NDArray[np.float64], control: Control) -> float:
        """Measure all distances, unless those of some points are too long."""
        few = deviation(self._probes, knots, weights, control) / self.most
        return few if few > 1.0 else deviation(self.path, knots, weights, control) / self.most

    @cached_property
    def _probes(self) -> RefinedPath:
        samples = self.path.samples
        return RefinedPath(samples[:, :: max(1, samples.shape[1] // _PROBES)], self.path.weights)


@dataclass(frozen=True)
class FittedPieces:
    """Straight pieces along a path.

    Attributes
    ----------
    ends : list of int
        Positions of the path at whose times the pieces end, the last one among them; the first piece begins at 0.
    positions : (k, n, 3) float64
        The points there: at the end exactly, in between where the pieces follow the path best.
    deviation : float
        Largest distance of a point from where it belongs.
    """

    ends: list[int]
    positions: NDArray[np.float64]
    deviation: float


def fitted_pieces(
    path: RefinedPath, criteria: Sequence[Criterion], message: Sentence, control: Control
) -> Work[FittedPieces]:
    """Follow a path by few straight pieces that satisfy some criteria; if no pieces do, by those that come close.

    Parameters
    ----------
    path : RefinedPath
        The path.
    criteria : sequence of Criterion
        What the pieces must satisfy.
    message : Sentence
        Reported with the progress.
    control : Control
        Stops the work.
    """
    tried: list[list[int]] = []
    for number, factor in enumerate(_LONGER):
        control.check()
        yield Progress(number / len(_LONGER), message)
        knots = [0, *straight_pieces(len(path), criteria, factor)]
        # Ends on the path are only as good as the pieces were chosen.
        tries = [] if knots in tried else [_fitted(path, knots)]
        tries += [] if factor > 1.0 else [path.weights[knots]]
        tried.append(knots)
        for weights in tries:
            if all(own.along(knots, weights, control) <= 1.0 for own in criteria):
                return FittedPieces(knots[1:], path.mean(weights[1:]), deviation(path, knots, weights, control))
    weights = path.weights[knots]
    return FittedPieces(knots[1:], path.mean(weights[1:]), deviation(path, knots, weights, control))


def straight_pieces(count: int, criteria: Sequence[Criterion], most: float = 1.0) -> list[int]:
    """Choose the ends of as few straight pieces as follow a path.

    Each piece leads to the farthest position that it can reach, which gives the fewest pieces. Along a piece the points
    move at an even pace.

    Parameters
    ----------
    count : int
        Number of positions, two at least.
    criteria : sequence of Criterion
        What each piece must satisfy.
    most : float
        Allowed multiple of their errors.

    Returns
    -------
    list of int
        Positions at which the pieces end, the last one among them; the first piece begins at 0.
    """
    last, ends, begin = count - 1, [], 0
    while begin < last:
        reached = begin + 1
        while reached < last and all(own.between(begin, reached + 1) <= most for own in criteria):
            reached += 1
        ends.append(reached)
        begin = reached
    return ends


def deviation(path: RefinedPath, knots: Sequence[int], weights: NDArray[np.float64], control: Control) -> float:
    """Return the largest distance of points from a path if they move straight between means of its samples.

    Parameters
    ----------
    path : RefinedPath
        The path.
    knots : sequence of int
        Positions of the path at whose times they reach the means.
    weights : (k, s) float64
        Weights of the samples in the means.
    control : Control
        Stops the work.
    """
    away = path.weights - along_polyline(np.arange(len(path)), knots, weights)
    return _longest(away, path.samples, control)


def _fitted(path: RefinedPath, knots: list[int]) -> NDArray[np.float64]:
    """Return weights of positions at the knots, (k, s): at both ends as they are, in between by least squares."""
    hats = along_polyline(np.arange(len(path)), knots, np.eye(len(knots)))
    # The inner positions are linear in those of the path.
    inverse = np.linalg.pinv(hats[:, 1:-1])
    inner = inverse.copy()
    inner[:, [0, -1]] -= inverse @ hats[:, [0, -1]]
    found = path.weights[knots]
    found[1:-1] = inner @ path.weights
    return found


def _longest(weights: NDArray[np.float64], samples: NDArray[np.float64], control: Control) -> float:
    """Return the largest length of weighted sums, with weights (f, s), of samples of vectors, (s, n, 3)."""
    longest = 0.0
    for some in chunks(samples.shape[1], _AT_ONCE):
        control.check()
        part = samples[:, some]
        squares = np.square(product(weights, part.reshape(len(part), -1)))
        longest = max(longest, float((squares[:, ::3] + squares[:, 1::3] + squares[:, 2::3]).max()))
    return float(np.sqrt(longest))
