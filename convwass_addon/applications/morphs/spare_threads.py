# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work that is handed to threads which have run out of their own, so that all end at about the same time."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Executor
from typing import TypeVar

T = TypeVar("T")


def at_once(work: Callable[[], T]) -> Callable[[], T]:
    """Do some work, and return what gives its result."""
    result = work()
    return lambda: result


class SpareThreads:
    """The threads of an executor that has so many long jobs to begin; once all have begun, some may be idle.

    Parameters
    ----------
    executor : Executor
        Of threads.
    jobs : int
        How many long jobs it has been or will be given; each calls `begin`.
    most : int
        How many pieces of work may be handed over at a time.
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
        """Give work to an idle thread, or do it at once where there is none; return what waits for its result.

        Whoever waits does what no thread has taken up, so that none waits for another that waits.
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
