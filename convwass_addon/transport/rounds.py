# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress reports of solvers, estimated from the remaining error."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..progress import Progress
from ..sentence import Sentence

COARSE_SHARE = 0.15
"""Fraction of a coarse-to-fine solve that all coarser levels together take."""
# Upper limit of the progress of a solve that has not ended.
_LARGEST_SHARE = 0.95


@dataclass(frozen=True)
class Round:
    """One round of an iteration.

    Attributes
    ----------
    elements : int
        Number of elements of the domain.
    iteration : int
        Number of the round on this domain, from 1.
    error : float
        The remaining error; the iteration ends when it is below the tolerance.
    """

    elements: int
    iteration: int
    error: float


class RoundReports:
    """Reports rounds. Errors fall about geometrically, so progress is measured in their logarithm.

    Parameters
    ----------
    elements : int
        Elements of the domain.
    tolerance : float
        The error at which the iteration ends.
    """

    def __init__(self, elements: int, tolerance: float) -> None:
        self._elements, self._tolerance = elements, tolerance
        self._first = self._share = 0.0

    def after(self, iteration: int, error: float) -> Progress[Round]:
        """Return the report after a round."""
        if 0.0 < error < math.inf:
            self._first = max(self._first, error)
            way = math.log(self._first / self._tolerance)
            done = math.log(self._first / error) / way if way > 0 else 1.0
            self._share = max(self._share, _LARGEST_SHARE * min(done, 1.0))
        message = Sentence("Solving, round {iteration}", {"iteration": iteration})
        return Progress(self._share, message, Round(self._elements, iteration, error))
