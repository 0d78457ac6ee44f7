# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs on a worker thread, or in turn with their caller; a timer polls their reports."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from contextlib import closing
from typing import Any, Generic, TypeVar

from ..errors import Cancelled
from ..progress import Control, Progress, Request, Work

Result = TypeVar("Result")


class BackgroundJob(Generic[Result]):
    """A job on a thread of its own.

    The thread only touches arrays. The polling caller does everything else, and answers the requests among the reports.

    Parameters
    ----------
    work : callable
        ``work(control)`` returns the generator to run; :meth:`cancel` cancels the control.
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
        """Yield each queued report once; reports that are not consumed stay queued."""
        while True:
            try:
                yield self._queue.get_nowait()
            except queue.Empty:
                return

    @property
    def done(self) -> bool:
        """Whether the thread has ended; reports may still be queued."""
        return self._done.is_set()

    @property
    def cancelled(self) -> bool:
        """Whether cancellation was requested."""
        return self._control.cancelled

    @property
    def result(self) -> Result | None:
        """What the work returned; None before that, or if it ended early."""
        return self._result

    @property
    def error(self) -> BaseException | None:
        """The exception that ended the work early, if any; :class:`.errors.Cancelled` after `cancel`."""
        return self._error

    def cancel(self, patience: float | None = None) -> bool:
        """Cancel the work and wait for its end, for at most `patience` seconds; return whether it has ended."""
        self._control.cancel()
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            self._result = self._worked()
        except BaseException as error:  # passed on to the polling caller
            self._error = error
        finally:
            self._done.set()

    def _worked(self) -> Result:
        """Run the work and queue its reports."""
        # Work that is left unfinished ends its threads here, and not wherever the garbage collector finds it.
        with closing(self._work(self._control)) as work:
            while True:
                try:
                    report = next(work)
                except StopIteration as end:
                    # A result that was cancelled at the last moment must not be used.
                    self._control.check()
                    return end.value
                self._queue.put(report)
                if isinstance(report.payload, Request):
                    report.payload.wait(self._control)
                self._control.check()


class InlineJob(Generic[Result]):
    """A job on the polling thread, in turn with its other work; same interface as :class:`BackgroundJob`.

    Parameters
    ----------
    work : callable
        ``work(control)`` returns the generator to run; :meth:`cancel` cancels the control.
    """

    def __init__(self, work: Callable[[Control], Work[Result]]) -> None:
        self._control = Control()
        self._work = work(self._control)
        self.done = False
        self.result: Result | None = None
        self.error: BaseException | None = None

    def poll(self) -> Iterator[Progress[Any]]:
        """Continue the work and yield its reports; the work pauses when the caller stops consuming them."""
        while not self.done:
            try:
                report = next(self._work)
            except StopIteration as end:
                self.result, self.done = end.value, True
            except BaseException as error:  # passed on to the polling caller, like that of a thread
                self.error, self.done = error, True
            else:
                yield report

    @property
    def cancelled(self) -> bool:
        """Whether cancellation was requested."""
        return self._control.cancelled

    def cancel(self, patience: float | None = None) -> bool:
        """End the work; return True, since it ends at once."""
        self._control.cancel()
        if not self.done:
            self._work.close()
            self.error, self.done = Cancelled("Cancelled."), True
        return True
