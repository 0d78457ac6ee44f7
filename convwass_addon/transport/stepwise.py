# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves that can be done step by step: generators that return what they have found."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass
from typing import TypeVar

Found = TypeVar("Found")


@dataclass(frozen=True)
class Round:
    """One round of a solve.

    Attributes
    ----------
    elements : int
        Of the domain that it was on.
    error : float
        After it.
    """

    elements: int
    error: float


def finished(rounds: Generator[Round, None, Found]) -> Found:
    """Do all rounds and return what they have found."""
    while True:
        try:
            next(rounds)
        except StopIteration as end:
            return end.value


class RoundsDone:
    """Estimates from rounds what share of a solve is done, by how far the error has come on its way down.

    Parameters
    ----------
    elements : int
        Of the finest domain; rounds on coarser ones count for little.
    tolerance : float
        Where the error is to end.
    """

    def __init__(self, elements: int, tolerance: float) -> None:
        self._elements, self._tolerance = elements, tolerance
        self._first: float | None = None
        self.share = 0.0

    def after(self, done: Round) -> float:
        """Return the share after one more round; it never falls, and stays below 1."""
        own = done.elements / self._elements
        if own < 1.0 or not 0.0 < done.error < math.inf:
            self.share = max(self.share, 0.5 * min(own, 0.5))
            return self.share
        self._first = max(self._first or 0.0, done.error)
        way = math.log(self._first / self._tolerance)
        come = math.log(self._first / done.error) / way if way > 0 else 1.0
        self.share = max(self.share, 0.15 + 0.8 * min(come, 1.0))
        return self.share
