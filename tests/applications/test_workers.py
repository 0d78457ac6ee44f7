# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from threading import Barrier

import pytest

from convwass_addon.applications.workers import both_ways


def test_both_ways_are_gone_at_the_same_time():
    meeting = Barrier(2)

    def gone(k):
        # Nobody passes before the other has come.
        meeting.wait(timeout=10.0)
        return 10 * k

    assert both_ways(gone) == (0, 10)


@pytest.mark.parametrize("failing", [0, 1])
def test_a_failure_of_either_way_is_told(failing):
    def gone(k):
        if k == failing:
            raise ValueError(f"way {k}")

    with pytest.raises(ValueError, match=f"way {failing}"):
        both_ways(gone)
