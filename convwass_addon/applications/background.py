# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run a job's steps on a worker thread, to be collected by a timer."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

from ..progress import Control

Step = TypeVar("Step")


class BackgroundJob(Generic[Step]):
    """A generator of steps on a thread of its own.

    The thread touches arrays only; whoever polls does the rest.

    Parameters
    ----------
    steps : callable
        ``steps(control)`` returns the generator, which checks the control often.
    """

    def __init__(self, steps: Callable[[Control], Iterator[Step]]) -> None:
        self._control = Control()
        self._done = threading.Event()
        self._queue: queue.SimpleQueue[Step] = queue.SimpleQueue()
        self._error: BaseException | None = None
        self._steps = steps
        self._thread = threading.Thread(target=self._run, name="convwass", daemon=True)
        self._thread.start()

    def poll(self) -> Iterator[Step]:
        """Yield the steps that have been done, each once; those that nobody takes wait for the next call."""
        while True:
            try:
                yield self._queue.get_nowait()
            except queue.Empty:
                return

    @property
    def done(self) -> bool:
        """Whether the thread has ended; steps may still be waiting to be polled."""
        return self._done.is_set()

    @property
    def cancelled(self) -> bool:
        """Whether it has been asked to end."""
        return self._control.cancelled

    @property
    def error(self) -> BaseException | None:
        """What ended the job early, if anything; :class:`.errors.Cancelled` after `cancel`."""
        return self._error

    def cancel(self, patience: float | None = None) -> bool:
        """Ask the job to end at its next check, and wait for it, for so many seconds at most; tell if it has ended."""
        self._control.cancel()
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            for step in self._steps(self._control):
                self._queue.put(step)
                self._control.check()
        except BaseException as error:  # handed to whoever polls
            self._error = error
        finally:
            self._done.set()
