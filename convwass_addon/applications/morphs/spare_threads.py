# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Give work to threads that have become idle, so that all threads finish at about the same time."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Executor
from typing import TypeVar

T = TypeVar("T")


def at_once(work: Callable[[], T]) -> Callable[[], T]:
    """Do some work, and return a function that returns its result."""
    result = work()
    return lambda: result


class SpareThreads:
    """The threads of an executor with a known number of long jobs; once all have begun, threads may be idle.

    Parameters
    ----------
    executor : Executor
        An executor of threads.
    jobs : int
        Number of long jobs that it gets in total; each calls `begin`.
    most : int
        Maximum number of pieces of work handed over at the same time.
    """

    def __init__(self, executor: Executor, jobs: int, most: int) -> None:
        self._executor = executor
        self._lock = threading.Lock()
        self._waiting, self._free = jobs, most

    def begin(self) -> None:
        """Note that a long job has begun."""
        with self._lock:
            self._waiting -= 1

    def hand_over(self, work: Callable[[], T]) -> Callable[[], T]:
        """Give work to an idle thread, or do it at once if there is none; return a function that waits for the result.

        Work that no thread has started is done by the waiting thread itself, which prevents deadlocks.
        """
        with self._lock:
            if self._waiting > 0 or self._free == 0:
                taken = False
            else:
                taken, self._free = True, self._free - 1
        if not taken:
            return at_once(work)
        future = self._executor.submit(work)
        future.add_done_callback(self._release)
        return lambda: work() if future.cancel() else future.result()

    def _release(self, _future: object) -> None:
        with self._lock:
            self._free += 1
