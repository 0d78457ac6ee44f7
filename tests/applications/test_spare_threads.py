# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work for threads that have run out of their own: it is done once, whoever does it, and nobody waits for ever."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from convwass_addon.applications.morphs.spare_threads import SpareThreads, at_once


def here():
    return threading.get_ident()


def test_while_jobs_wait_everything_is_done_at_once():
    with ThreadPoolExecutor(1) as executor:
        spare = SpareThreads(executor, jobs=2, most=1)
        spare.begin()
        assert spare.hand_over(here)() == here()
        assert at_once(here)() == here()


def test_once_all_have_begun_an_idle_thread_does_it():
    with ThreadPoolExecutor(1) as executor:
        spare = SpareThreads(executor, jobs=1, most=1)
        spare.begin()
        done = threading.Event()
        result = spare.hand_over(lambda: (done.set(), here())[1])
        assert done.wait(10)
        assert result() != here()


def test_what_no_thread_has_taken_up_is_done_by_who_waits():
    """The only thread is busy until after the result is there: waiting for it would be for ever."""
    busy = threading.Event()
    with ThreadPoolExecutor(1) as executor:
        executor.submit(busy.wait, 30)
        spare = SpareThreads(executor, jobs=0, most=1)
        result = spare.hand_over(here)
        assert result() == here()
        busy.set()


def test_no_more_is_handed_over_than_allowed_and_room_comes_back():
    busy = threading.Event()
    with ThreadPoolExecutor(2) as executor:
        spare = SpareThreads(executor, jobs=0, most=1)
        first = spare.hand_over(lambda: (busy.wait(30), here())[1])
        assert spare.hand_over(here)() == here()
        busy.set()
        assert first() != here()
        deadline = time.monotonic() + 10
        # The result is there a moment before the room is.
        while True:
            result = spare.hand_over(here)
            time.sleep(0.02)
            if result() != here():
                break
            assert time.monotonic() < deadline
        assert SpareThreads(executor, jobs=0, most=0).hand_over(here)() == here()


def test_errors_come_to_who_waits():
    def wrong():
        raise ValueError("no")

    with ThreadPoolExecutor(1) as executor:
        spare = SpareThreads(executor, jobs=0, most=1)
        with pytest.raises(ValueError, match="no"):
            spare.hand_over(wrong)()
