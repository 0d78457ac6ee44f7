# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads that compute frames side by side, and one thread of BLAS in each."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager


@contextmanager
def frame_workers(count: int | None = None) -> Iterator[Executor]:
    """Provide threads for frames; BLAS gets one thread in each, with which it does twice as much for its CPU time.

    Where threads of BLAS wait for each other on a machine that has other work, the same products take several times
    longer than on one thread.

    Parameters
    ----------
    count : int, optional
        Threads; by default one per processor.

    Yields
    ------
    concurrent.futures.Executor
        Ends with the context; runs that have not begun are dropped.
    """
    with ExitStack() as stack:
        stack.enter_context(one_blas_thread())
        executor = ThreadPoolExecutor(count or os.cpu_count() or 1, thread_name_prefix="convwass")
        stack.callback(executor.shutdown, wait=True, cancel_futures=True)
        yield executor


class _BlasLimit:
    """A limit that holds while anybody in the process wants it: the last to leave lifts it, not the first."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._users = 0
        self._limit = ExitStack()

    def enter(self) -> None:
        """Limit BLAS, where threadpoolctl is there to do it."""
        with self._lock:
            if self._users == 0:
                try:
                    from threadpoolctl import threadpool_limits
                except ImportError:
                    pass
                else:
                    self._limit.enter_context(threadpool_limits(1, user_api="blas"))
            self._users += 1

    def leave(self) -> None:
        """Let BLAS be as it was, unless others still want it limited."""
        with self._lock:
            self._users -= 1
            if self._users == 0:
                self._limit.close()


_blas = _BlasLimit()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Limit BLAS in this process to one thread, also where several threads enter and leave in any order."""
    _blas.enter()
    try:
        yield
    finally:
        _blas.leave()
