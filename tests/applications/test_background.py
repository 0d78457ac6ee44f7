# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in the background, on a thread or interleaved; both are used alike."""

from __future__ import annotations

import threading
import time

import pytest

from convwass_addon.applications.background import BackgroundJob, InlineJob
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.progress import Control, Progress, Request, Work
from convwass_addon.sentence import Sentence

EACH = pytest.mark.parametrize("kind", [BackgroundJob, InlineJob])


def counting(control: Control) -> Work[str]:
    for number in range(3):
        yield Progress(number / 3, Sentence("Counting"), number)
        control.check()
    return "done"


def endless(control: Control) -> Work[None]:
    while True:
        yield Progress(0.5, Sentence("Waiting"))
        time.sleep(0.001)
        control.check()


def asking(control: Control) -> Work[int]:
    request = Request()
    yield Progress(0.5, Sentence("Asking"), request)
    return 2 * request.value


def poll_until_end(job, take=lambda report: None):
    """Return all reports of a job until it has ended."""
    reports, deadline = [], time.monotonic() + 30
    while time.monotonic() < deadline:
        done = job.done
        for report in job.poll():
            take(report)
            reports.append(report)
        if done:
            return reports
        time.sleep(0.001)
    raise AssertionError("It never ends.")


@EACH
def test_reports_come_once_and_in_order_and_the_result_last(kind):
    job = kind(counting)
    assert [report.payload for report in poll_until_end(job)] == [0, 1, 2]
    assert (job.result, job.error, job.cancelled) == ("done", None, False)
    assert list(job.poll()) == []


@EACH
def test_requests_are_answered_by_the_polling_thread(kind):
    job = kind(asking)
    poll_until_end(job, lambda report: report.payload.answer(21))
    assert job.error is None
    assert job.result == 42


@EACH
def test_errors_are_passed_on(kind):
    def refused(control: Control) -> Work[None]:
        yield Progress(0.0, Sentence("Starting"))
        raise InputError("No.")

    job = kind(refused)
    assert len(poll_until_end(job)) == 1
    assert isinstance(job.error, InputError)


@EACH
@pytest.mark.parametrize("work", [endless, asking])
def test_cancelling_ends_waiting_work(kind, work):
    job = kind(work)
    next(report for _ in iter(int, 1) for report in job.poll())
    assert job.cancel()
    assert job.done and job.cancelled
    assert isinstance(job.error, Cancelled)
    assert job.result is None


@EACH
def test_cancelled_work_has_cleaned_up_when_it_is_done(kind):
    cleaned_on = []

    def holding(control: Control) -> Work[None]:
        try:
            while True:
                yield Progress(0.5, Sentence("Holding"))
                time.sleep(0.001)
        finally:
            cleaned_on.append(threading.current_thread().name)

    job = kind(holding)
    next(report for _ in iter(int, 1) for report in job.poll())
    assert job.cancel()
    assert cleaned_on == ["convwass" if kind is BackgroundJob else threading.current_thread().name]


def test_interleaved_work_runs_only_while_polled_on_the_polling_thread():
    places = []

    def noting(control: Control) -> Work[None]:
        for number in range(4):
            places.append(threading.current_thread())
            yield Progress(number / 4, Sentence("Noting"))

    job = InlineJob(noting)
    assert places == []
    next(job.poll())
    assert places == [threading.current_thread()]
    assert len(list(job.poll())) == 3
    assert job.done


def test_work_cancelled_in_its_last_step_has_no_result():
    begun, going = threading.Event(), threading.Event()

    def slow(control: Control) -> Work[str]:
        yield Progress(0.0, Sentence("Factorizing"))
        begun.set()
        assert going.wait(30)
        return "done"

    job = BackgroundJob(slow)
    assert begun.wait(30)
    assert not job.cancel(patience=0.0)
    going.set()
    assert job.cancel()
    assert job.result is None
    assert isinstance(job.error, Cancelled)
