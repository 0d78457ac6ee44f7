# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads that compute frames side by side."""

from __future__ import annotations

import os
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
        limit_blas(stack)
        executor = ThreadPoolExecutor(count or os.cpu_count() or 1, thread_name_prefix="convwass")
        stack.callback(executor.shutdown, wait=True, cancel_futures=True)
        yield executor


def limit_blas(stack: ExitStack) -> None:
    """Limit BLAS to one thread until the stack is closed, where threadpoolctl is there to do it."""
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        return
    stack.enter_context(threadpool_limits(1, user_api="blas"))
