# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.progress import Control, Progress, Work, drained, within
from convwass_addon.sentence import Sentence


def counting(count: int) -> Work[str]:
    for number in range(count):
        yield Progress((number + 1) / count, Sentence("Counting"), number)
    return "done"


def test_drained_returns_the_result():
    assert drained(counting(3)) == "done"


def test_within_maps_fractions_and_keeps_payloads_and_the_result():
    results = []

    def outer() -> Work[None]:
        results.append((yield from within(counting(2), 0.5, 0.9)))

    reports = list(outer())
    assert [report.fraction for report in reports] == pytest.approx([0.7, 0.9])
    assert [report.payload for report in reports] == [0, 1]
    assert results == ["done"]


def test_control_raises_once_cancelled():
    control = Control()
    control.check()
    control.cancel()
    assert control.cancelled
    with pytest.raises(Cancelled):
        control.check()


def test_control_follows_its_parents_but_not_its_children():
    user, job = Control(), Control()
    both = Control(user, job)
    both.check()
    job.cancel()
    with pytest.raises(Cancelled):
        both.check()
    other = Control(user)
    other.cancel()
    user.check()
