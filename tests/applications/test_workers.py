# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from threading import Barrier

import pytest

from convwass_addon.applications import workers
from convwass_addon.applications.workers import both_ways, side_by_side


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
