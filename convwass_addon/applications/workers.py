# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads that compute frames side by side, and one thread of BLAS in each."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

T = TypeVar("T")


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


def both_ways(work: Callable[[int], T]) -> tuple[T, T]:
    """Do the same from the first to the second of two things and back, at the same time; return both results.

    Parameters
    ----------
    work : callable
        Called with 0 in this thread and with 1 in another. Where one fails, the other is waited for.
    """
    with ThreadPoolExecutor(1, thread_name_prefix="convwass") as executor:
        other = executor.submit(work, 1)
        return work(0), other.result()


class _BlasLimit:
    """A limit that holds while anybody in the process wants it: the last to leave lifts it, not the first."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._users = 0
        self._limit = ExitStack()
        self._found: ThreadpoolController | None = None
        self._modules = 0

    def enter(self) -> None:
        """Limit BLAS, where threadpoolctl is there to do it."""
        with self._lock:
            if self._users == 0:
                libraries = self._libraries()
                if libraries is not None:
                    self._limit.enter_context(libraries.limit(limits=1, user_api="blas"))
            self._users += 1

    def _libraries(self) -> ThreadpoolController | None:
        """Return the libraries of BLAS in this process; None without threadpoolctl.

        In a Blender it takes 3 ms to find them. Others come only with a module, so they are looked for again where one
        has been imported.
        """
        if self._modules != len(sys.modules):
            try:
                from threadpoolctl import ThreadpoolController
            except ImportError:
                return None
            self._found, self._modules = ThreadpoolController(), len(sys.modules)
        return self._found

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
