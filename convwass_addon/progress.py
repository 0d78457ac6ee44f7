# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The protocol of long work: a generator that yields its progress and returns its result, and a control to stop it."""

from __future__ import annotations

import threading
from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from .errors import Cancelled
from .sentence import Sentence

Payload = TypeVar("Payload")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Progress(Generic[Payload]):
    """One report of long work.

    Attributes
    ----------
    fraction : float
        Share of the work that is done, from 0 to 1; it never falls.
    message : Sentence
        What is being done.
    payload : object or None
        An intermediate result that the caller can use at once, such as a finished frame.
    """

    fraction: float
    message: Sentence
    payload: Payload | None = None


Work = Generator[Progress[Any], None, Result]
"""Long work: yields :class:`Progress` and returns its result."""


class Control:
    """Stops long work, from any thread.

    Parameters
    ----------
    *parents : Control
        Cancelling any of them cancels this one too, but not the other way around.
    """

    def __init__(self, *parents: Control) -> None:
        self._parents = parents
        self._event = threading.Event()

    @property
    def cancelled(self) -> bool:
        """Whether the work is to stop."""
        return self._event.is_set() or any(parent.cancelled for parent in self._parents)

    def cancel(self) -> None:
        """Ask the work to stop at its next check."""
        self._event.set()

    def check(self) -> None:
        """Raise :class:`.errors.Cancelled` if the work is to stop; long loops call this between iterations."""
        if self.cancelled:
            raise Cancelled("Cancelled.")


def drained(work: Generator[Any, None, Result]) -> Result:
    """Do all of the work and return its result."""
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value


def within(work: Work[Result], begin: float, end: float) -> Work[Result]:
    """Report work that is one part of other work: its fractions run from `begin` to `end`."""
    while True:
        try:
            report = next(work)
        except StopIteration as done:
            return done.value
        yield replace(report, fraction=begin + (end - begin) * report.fraction)
