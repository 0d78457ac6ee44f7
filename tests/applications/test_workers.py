# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from threading import Barrier

import pytest

from convwass_addon.applications import workers
from convwass_addon.applications.workers import both_ways, in_step, side_by_side
from convwass_addon.progress import drained
from convwass_addon.sentence import Sentence


def test_both_directions_run_in_parallel():
    meeting = Barrier(2)

    def gone(k):
        # Neither may continue before the other has arrived.
        meeting.wait(timeout=10.0)
        return 10 * k

    assert both_ways(gone) == (0, 10)


@pytest.mark.parametrize("failing", [0, 1])
def test_a_failure_in_either_direction_is_raised(failing):
    def gone(k):
        if k == failing:
            raise ValueError(f"way {k}")

    with pytest.raises(ValueError, match=f"way {failing}"):
        both_ways(gone)


def test_work_for_several_numbers_runs_in_parallel_and_in_order(monkeypatch):
    monkeypatch.setattr(workers, "thread_count", lambda wanted=None: wanted or 3)
    meeting = Barrier(3)

    def gone(number):
        meeting.wait(timeout=10.0)
        return 10 * number

    assert side_by_side(gone, 6) == [0, 10, 20, 30, 40, 50]


def test_works_in_step_report_their_mean_and_wait_for_each_other(monkeypatch):
    monkeypatch.setattr(workers, "thread_count", lambda wanted=None: wanted or 2)
    meeting = Barrier(2)

    def steps(shares, result):
        for share in shares:
            meeting.wait(timeout=10.0)
            yield share
        return result

    work, reports = in_step([steps((0.1, 0.5), "first"), steps((0.3, 0.9), "second")], Sentence("Working")), []
    with pytest.raises(StopIteration) as end:
        while True:
            reports.append(next(work))
    assert end.value.value == ["first", "second"]
    assert [report.fraction for report in reports] == pytest.approx([0.0, 0.2, 0.7])
    assert {str(report.message) for report in reports} == {"Working"}


def test_a_failure_of_works_in_step_is_raised():
    def steps(fails):
        yield 0.5
        if fails:
            raise ValueError("second step")
        yield 0.6

    with pytest.raises(ValueError, match="second step"):
        drained(in_step([steps(False), steps(True)], Sentence("Working")))
