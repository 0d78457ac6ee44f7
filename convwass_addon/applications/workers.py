# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Worker threads for computing frames in parallel, with one BLAS thread each."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from ..errors import InputError
from ..progress import Progress, Work
from ..sentence import Sentence

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

T = TypeVar("T")


def thread_count(wanted: int | None = None) -> int:
    """Return how many threads to use: the wanted number, by default one per processor.

    Raises
    ------
    InputError
        The number is less than one.
    """
    if wanted is not None and wanted < 1:
        raise InputError("There must be at least one worker.")
    return wanted or os.cpu_count() or 1


@contextmanager
def frame_workers(count: int | None = None) -> Iterator[Executor]:
    """Provide worker threads for frames, with one BLAS thread each, which doubles the throughput per CPU time.

    On a machine with other work, BLAS threads that wait for each other make the same products several times slower than
    on one thread.

    Parameters
    ----------
    count : int, optional
        Number of threads; by default one per processor.

    Yields
    ------
    concurrent.futures.Executor
        Shut down with the context; calls that have not started are dropped.
    """
    with ExitStack() as stack:
        stack.enter_context(one_blas_thread())
        executor = ThreadPoolExecutor(thread_count(count), thread_name_prefix="convwass")
        stack.callback(executor.shutdown, wait=True, cancel_futures=True)
        yield executor


def both_ways(work: Callable[[int], T]) -> tuple[T, T]:
    """Run work for both directions between two things in parallel; return both results.

    Parameters
    ----------
    work : callable
        Called with 0 in this thread and with 1 in another. If one fails, the other is awaited.
    """
    with ThreadPoolExecutor(1, thread_name_prefix="convwass") as executor:
        other = executor.submit(work, 1)
        return work(0), other.result()


def side_by_side(work: Callable[[int], T], count: int) -> list[T]:
    """Run work for the numbers below `count` in worker threads; return the results in order.

    Parameters
    ----------
    work : callable
        Called with every number. If one call fails, those that have started are awaited.
    count : int
        How many numbers, at least one.
    """
    with frame_workers(min(count, thread_count())) as executor:
        return list(executor.map(work, range(count)))


def in_step(works: Sequence[Generator[float, None, T]], message: Sentence) -> Work[list[T]]:
    """Do several works in worker threads, each until it yields before any of them goes on.

    Parameters
    ----------
    works : sequence of generators
        At least one; they yield their finished shares. If one fails, the others are awaited until they yield.
    message : Sentence
        Reported with the mean of these shares.

    Returns
    -------
    list
        Their results in order.
    """
    states = [_Advanced(0.0, False, None)] * len(works)
    with frame_workers(min(len(works), thread_count())) as executor:
        while not all(state.is_done for state in states):
            yield Progress(sum(state.share for state in states) / len(states), message)
            states = list(executor.map(_advanced, works, states))
    return [state.result for state in states]


@dataclass(frozen=True)
class _Advanced:
    """The finished share of some work, and its result once it is done."""

    share: float
    is_done: bool
    result: Any


def _advanced(work: Generator[float, None, Any], last: _Advanced) -> _Advanced:
    """Do some work until it yields or ends."""
    if last.is_done:
        return last
    try:
        return _Advanced(next(work), False, None)
    except StopIteration as end:
        return _Advanced(1.0, True, end.value)


class _BlasLimit:
    """A process-wide limit with a user count: the last user to leave lifts it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._users = 0
        self._limit = ExitStack()
        self._found: ThreadpoolController | None = None
        self._modules = 0

    def enter(self) -> None:
        """Limit BLAS, if threadpoolctl is installed."""
        with self._lock:
            if self._users == 0:
                libraries = self._libraries()
                if libraries is not None:
                    self._limit.enter_context(libraries.limit(limits=1, user_api="blas"))
            self._users += 1

    def _libraries(self) -> ThreadpoolController | None:
        """Return the BLAS libraries in this process; None without threadpoolctl.

        Finding them takes 3 ms in Blender. New ones only come with imports, so the search is repeated if the number of
        imported modules has changed.
        """
        if self._modules != len(sys.modules):
            try:
                from threadpoolctl import ThreadpoolController
            except ImportError:
                return None
            self._found, self._modules = ThreadpoolController(), len(sys.modules)
        return self._found

    def leave(self) -> None:
        """Lift the limit unless others still need it."""
        with self._lock:
            self._users -= 1
            if self._users == 0:
                self._limit.close()


_blas = _BlasLimit()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Limit BLAS in this process to one thread; threads may enter and leave in any order."""
    _blas.enter()
    try:
        yield
    finally:
        _blas.leave()
