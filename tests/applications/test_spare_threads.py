# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work for idle threads is done exactly once, by any thread, without deadlocks."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from convwass_addon.applications.morphs.spare_threads import SpareThreads, at_once


def here():
    return threading.get_ident()


def test_while_jobs_are_queued_work_runs_immediately():
    with ThreadPoolExecutor(1) as executor:
        spare = SpareThreads(executor, jobs=2, most=1)
        spare.begin()
        assert spare.hand_over(here)() == here()
        assert at_once(here)() == here()


def test_an_idle_thread_does_the_work_once_all_jobs_have_begun():
    with ThreadPoolExecutor(1) as executor:
        spare = SpareThreads(executor, jobs=1, most=1)
        spare.begin()
        done = threading.Event()
        result = spare.hand_over(lambda: (done.set(), here())[1])
        assert done.wait(10)
        assert result() != here()


def test_work_not_yet_taken_is_done_by_the_waiting_thread():
    """The only thread is busy until the result exists, so waiting for it would last forever."""
    busy = threading.Event()
    with ThreadPoolExecutor(1) as executor:
        executor.submit(busy.wait, 30)
        spare = SpareThreads(executor, jobs=0, most=1)
        result = spare.hand_over(here)
        assert result() == here()
        busy.set()


def test_the_number_of_pending_results_is_limited():
    busy = threading.Event()
    with ThreadPoolExecutor(2) as executor:
        spare = SpareThreads(executor, jobs=0, most=1)
        first = spare.hand_over(lambda: (busy.wait(30), here())[1])
        assert spare.hand_over(here)() == here()
        busy.set()
        assert first() != here()
        deadline = time.monotonic() + 10
        # The result is available shortly before its slot is free.
        while True:
            result = spare.hand_over(here)
            time.sleep(0.02)
            if result() != here():
                break
            assert time.monotonic() < deadline
        assert SpareThreads(executor, jobs=0, most=0).hand_over(here)() == here()


def test_errors_are_raised_in_the_waiting_thread():
    def wrong():
        raise ValueError("no")

    with ThreadPoolExecutor(1) as executor:
        spare = SpareThreads(executor, jobs=0, most=1)
        with pytest.raises(ValueError, match="no"):
            spare.hand_over(wrong)()
