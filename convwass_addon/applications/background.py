# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Do long work beside other things: on a worker thread, or in turn with its caller; a timer collects the reports."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from typing import Any, Generic, TypeVar

from ..errors import Cancelled
from ..progress import Control, Progress, Request, Work

Result = TypeVar("Result")


class BackgroundJob(Generic[Result]):
    """Long work on a thread of its own.

    The thread touches arrays only; whoever polls does the rest, and answers the requests among the reports.

    Parameters
    ----------
    work : callable
        ``work(control)`` returns the work; the control is cancelled by :meth:`cancel`.
    """

    def __init__(self, work: Callable[[Control], Work[Result]]) -> None:
        self._control = Control()
        self._done = threading.Event()
        self._queue: queue.SimpleQueue[Progress[Any]] = queue.SimpleQueue()
        self._result: Result | None = None
        self._error: BaseException | None = None
        self._work = work
        self._thread = threading.Thread(target=self._run, name="convwass", daemon=True)
        self._thread.start()

    def poll(self) -> Iterator[Progress[Any]]:
        """Yield the reports that have come, each once; those that nobody takes wait for the next call."""
        while True:
            try:
                yield self._queue.get_nowait()
            except queue.Empty:
                return

    @property
    def done(self) -> bool:
        """Whether the thread has ended; reports may still be waiting to be polled."""
        return self._done.is_set()

    @property
    def cancelled(self) -> bool:
        """Whether it has been asked to end."""
        return self._control.cancelled

    @property
    def result(self) -> Result | None:
        """What the work has returned; None before that, and where it ended early."""
        return self._result

    @property
    def error(self) -> BaseException | None:
        """What ended the work early, if anything; :class:`.errors.Cancelled` after `cancel`."""
        return self._error

    def cancel(self, patience: float | None = None) -> bool:
        """Cancel the work and wait for its end, for so many seconds at most; return whether it has ended."""
        self._control.cancel()
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            self._result = self._worked()
        except BaseException as error:  # handed to whoever polls
            self._error = error
        finally:
            self._done.set()

    def _worked(self) -> Result:
        """Do the work and queue its reports."""
        work = self._work(self._control)
        while True:
            try:
                report = next(work)
            except StopIteration as end:
                # What was cancelled in its last part is not to be used.
                self._control.check()
                return end.value
            self._queue.put(report)
            if isinstance(report.payload, Request):
                report.payload.wait(self._control)
            self._control.check()


class InlineJob(Generic[Result]):
    """Long work on the thread that polls, in turn with whatever else that does; used as :class:`BackgroundJob`.

    Parameters
    ----------
    work : callable
        ``work(control)`` returns the work; the control is cancelled by :meth:`cancel`.
    """

    def __init__(self, work: Callable[[Control], Work[Result]]) -> None:
        self._control = Control()
        self._work = work(self._control)
        self.done = False
        self.result: Result | None = None
        self.error: BaseException | None = None

    def poll(self) -> Iterator[Progress[Any]]:
        """Work on, and yield the reports; where nobody takes more of them the work waits for the next call."""
        while not self.done:
            try:
                report = next(self._work)
            except StopIteration as end:
                self.result, self.done = end.value, True
            except BaseException as error:  # handed to whoever polls, as that of a thread is
                self.error, self.done = error, True
            else:
                yield report

    @property
    def cancelled(self) -> bool:
        """Whether it has been asked to end."""
        return self._control.cancelled

    def cancel(self, patience: float | None = None) -> bool:
        """End the work; return True, since it has ended."""
        self._control.cancel()
        if not self.done:
            self._work.close()
            self.error, self.done = Cancelled("Cancelled."), True
        return True
