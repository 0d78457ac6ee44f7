# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The protocol of long work: a generator that yields its progress and returns its result, and a control to stop it.

- Work that takes long and has something to tell is a generator of :class:`Progress` that returns its result. The caller
  drives it with a loop, uses the payloads, and takes the result with ``yield from`` or :func:`drained`. A work that is
  part of another one is reported :func:`within` it.
- All long work takes a ``control: Control``, by default :data:`UNINTERRUPTED`, and calls ``control.check()`` in its
  loops; it never has to ask whether there is one. Cancelling raises :class:`.errors.Cancelled` there.
- What only the caller can provide, because only the main thread may read it from Blender, is asked for with a
  :class:`Request` as payload.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from .errors import Cancelled
from .sentence import Sentence

# Seconds between two looks at the control while a request waits for its answer.
_PATIENCE = 0.05

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


class _Uninterrupted(Control):
    """A control without a state, for work that nobody stops."""

    def cancel(self) -> None:
        raise RuntimeError("Work that was started without a control cannot be cancelled.")

    def check(self) -> None:
        pass

    def __reduce__(self) -> str:
        return "UNINTERRUPTED"


UNINTERRUPTED: Control = _Uninterrupted()
"""The control of work that runs to its end."""


class Request(Generic[Payload]):
    """Something that only the caller of the work can provide.

    The work yields it as the payload of a :class:`Progress` and then takes its `value`; the caller answers it before it
    asks for the next report, or, where the work is on another thread, that thread waits for the answer.
    """

    def __init__(self) -> None:
        self._answered = threading.Event()
        self._value: Payload | None = None

    def answer(self, value: Payload) -> None:
        """Provide it; called by whoever has received the request."""
        self._value = value
        self._answered.set()

    def wait(self, control: Control) -> None:
        """Wait until it is answered, or raise :class:`.errors.Cancelled`; for the thread that drives the work."""
        while not self._answered.wait(_PATIENCE):
            control.check()

    @property
    def value(self) -> Payload:
        """The answer; taking it before there is one is an error of the caller."""
        if not self._answered.is_set():
            raise RuntimeError("The request has not been answered.")
        return self._value


def drained(work: Generator[Any, None, Result]) -> Result:
    """Do all of the work and return its result."""
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value


def payloads(work: Iterable[Progress[Any]], kind: type[Payload]) -> Iterator[Payload]:
    """Do the work and yield its payloads of one kind as they come."""
    for report in work:
        if isinstance(report.payload, kind):
            yield report.payload


def watched(work: Work[Result], watch: Callable[[Progress[Any]], None]) -> Work[Result]:
    """Hand reports on once `watch` has been called with them, and return the result of the work."""
    while True:
        try:
            report = next(work)
        except StopIteration as done:
            return done.value
        watch(report)
        yield report


def within(work: Work[Result], begin: float, end: float, message: Sentence | None = None) -> Work[Result]:
    """Report work that is one part of other work: its fractions run from `begin` to `end`.

    Its own messages are replaced by `message` if that is given.
    """
    while True:
        try:
            report = next(work)
        except StopIteration as done:
            return done.value
        fraction = begin + (end - begin) * report.fraction
        yield replace(report, fraction=fraction, message=message or report.message)
