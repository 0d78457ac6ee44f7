# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
import pickle

import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.progress import (
    UNINTERRUPTED,
    Control,
    Progress,
    Request,
    Work,
    as_part,
    drained,
    payloads,
    watched,
    within,
)
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


def test_within_can_replace_messages():
    reports = list(within(counting(2), 0.0, 1.0, Sentence("Preparing")))
    assert [str(report.message) for report in reports] == ["Preparing", "Preparing"]


def test_parts_divide_the_fractions_evenly():
    reports = [report.fraction for number in range(4) for report in as_part(counting(2), number, 4)]
    expected = [report.fraction for report in counting(2)]
    assert reports == [0.25 * (number + fraction) for number in range(4) for fraction in expected]


def test_payloads_are_distinguished_by_type():
    def mixed() -> Work[None]:
        for payload in (1, "a", None, 2):
            yield Progress(0.0, Sentence("Mixing"), payload)

    assert list(payloads(mixed(), int)) == [1, 2]


def test_watched_work_reports_and_returns_the_same():
    seen, results = [], []

    def outer() -> Work[None]:
        results.append((yield from watched(counting(2), seen.append)))

    assert list(outer()) == seen
    assert [report.payload for report in seen] == [0, 1]
    assert results == ["done"]


def test_uninterrupted_work_cannot_be_cancelled():
    UNINTERRUPTED.check()
    assert not UNINTERRUPTED.cancelled
    with pytest.raises(RuntimeError, match="cannot be cancelled"):
        UNINTERRUPTED.cancel()
    UNINTERRUPTED.check()
    assert pickle.loads(pickle.dumps(UNINTERRUPTED)) is UNINTERRUPTED


def doubled() -> Work[int]:
    request = Request()
    yield Progress(0.5, Sentence("Asking"), request)
    return 2 * request.value


def test_a_request_is_answered_by_the_caller():
    assert drained(watched(doubled(), lambda report: report.payload.answer(21))) == 42


def test_an_unanswered_request_is_an_error():
    with pytest.raises(RuntimeError, match="has not been answered"):
        drained(doubled())


def test_cancelling_ends_waiting_for_an_answer():
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        Request().wait(control)
