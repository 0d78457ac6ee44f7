# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Protocol of long work: a generator that yields progress reports and returns its result, and a control to stop it.

- Long work is a generator of :class:`Progress` that returns its result. The caller drives it with a loop, uses the
  payloads, and gets the result with ``yield from`` or :func:`drained`. Work that is part of other work is wrapped in
  :func:`within`.
- All long work takes a ``control: Control``, by default :data:`UNINTERRUPTED`, and calls ``control.check()`` in its
  loops, which raises :class:`.errors.Cancelled` if the work was cancelled.
- Data that only the caller can provide, because only the main thread may access Blender, is requested with a
  :class:`Request` as payload.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from .errors import Cancelled
from .sentence import Sentence

# Interval in seconds at which the control is checked while a request waits for its answer.
_PATIENCE = 0.05

Payload = TypeVar("Payload")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Progress(Generic[Payload]):
    """A progress report.

    Attributes
    ----------
    fraction : float
        Finished share of the work, from 0 to 1; never decreases.
    message : Sentence
        The current step.
    payload : object or None
        An intermediate result that the caller can use immediately, such as a finished frame.
    """

    fraction: float
    message: Sentence
    payload: Payload | None = None


Work = Generator[Progress[Any], None, Result]
"""Long work: a generator that yields :class:`Progress` and returns its result."""


class Control:
    """Stops long work from any thread.

    Parameters
    ----------
    *parents : Control
        Cancelling a parent cancels this control too, but not vice versa.
    """

    def __init__(self, *parents: Control) -> None:
        self._parents = parents
        self._event = threading.Event()

    @property
    def cancelled(self) -> bool:
        """Whether the work should stop."""
        return self._event.is_set() or any(parent.cancelled for parent in self._parents)

    def cancel(self) -> None:
        """Request the work to stop at its next check."""
        self._event.set()

    def check(self) -> None:
        """Raise :class:`.errors.Cancelled` if the work should stop; called between iterations of long loops."""
        if self.cancelled:
            raise Cancelled("Cancelled.")


class _Uninterrupted(Control):
    """A stateless control for work that cannot be stopped."""

    def cancel(self) -> None:
        raise RuntimeError("Work that was started without a control cannot be cancelled.")

    def check(self) -> None:
        pass

    def __reduce__(self) -> str:
        return "UNINTERRUPTED"


UNINTERRUPTED: Control = _Uninterrupted()
"""The control of work that is never cancelled."""


class Request(Generic[Payload]):
    """Data that only the caller of the work can provide.

    The work yields a request as the payload of a :class:`Progress`, and then reads its `value`. The caller answers it
    before it asks for the next report. If the work runs on another thread, that thread waits for the answer.
    """

    def __init__(self) -> None:
        self._answered = threading.Event()
        self._value: Payload | None = None

    def answer(self, value: Payload) -> None:
        """Provide the answer; called by the receiver of the request."""
        self._value = value
        self._answered.set()

    def wait(self, control: Control) -> None:
        """Wait for the answer, or raise :class:`.errors.Cancelled`; for the thread that drives the work."""
        while not self._answered.wait(_PATIENCE):
            control.check()

    @property
    def value(self) -> Payload:
        """The answer; must not be read before it was given."""
        if not self._answered.is_set():
            raise RuntimeError("The request has not been answered.")
        return self._value


def drained(work: Generator[Any, None, Result]) -> Result:
    """Run the work to its end and return its result."""
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value


def payloads(work: Iterable[Progress[Any]], kind: type[Payload]) -> Iterator[Payload]:
    """Run the work and yield its payloads of one type."""
    for report in work:
        if isinstance(report.payload, kind):
            yield report.payload


def watched(work: Work[Result], watch: Callable[[Progress[Any]], None]) -> Work[Result]:
    """Pass reports on after calling `watch` with them, and return the result of the work."""
    while True:
        try:
            report = next(work)
        except StopIteration as done:
            return done.value
        watch(report)
        yield report


def within(work: Work[Result], begin: float, end: float, message: Sentence | None = None) -> Work[Result]:
    """Report work as a part of other work, with fractions from `begin` to `end`.

    If `message` is given, it replaces the messages of the work.
    """
    while True:
        try:
            report = next(work)
        except StopIteration as done:
            return done.value
        fraction = begin + (end - begin) * report.fraction
        yield replace(report, fraction=fraction, message=message or report.message)


def shares_within(steps: Generator[float, None, Result], begin: float, end: float) -> Generator[float, None, Result]:
    """Yield finished shares of some work as shares of other work, from `begin` to `end`."""
    while True:
        try:
            share = next(steps)
        except StopIteration as done:
            return done.value
        yield begin + (end - begin) * share


def as_part(work: Work[Result], number: int, count: int) -> Work[Result]:
    """Report work as one of so many equal parts of other work, by its number from 0."""
    return within(work, number / count, (number + 1) / count)
