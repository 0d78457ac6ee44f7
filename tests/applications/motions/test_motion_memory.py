# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions are found once for the same shapes and settings, and again if any of them changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from convwass_addon.applications.motions import motion_memory
from convwass_addon.applications.motions.motion_choice import MotionChoice
from convwass_addon.applications.motions.motion_memory import MotionMemory
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.errors import InputError
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.shapes import ball

SHAPES = (ball(points=40), ball(2.0, points=40))
SAME = MotionRequest(SHAPES, ("A", "B"), [(0, 1)], "automatic", 0.5)


@pytest.fixture
def finding(monkeypatch):
    """Replace the search, which takes seconds; return the list of all searches."""
    searches = []

    def found(request, _control):
        searches.append(request)
        if request.kind == "guided":
            raise InputError("no map")
        return MotionChoice("warp", "ASKED", np.zeros(len(request.shapes[0].vertices)))
        yield

    monkeypatch.setattr(motion_memory, "chosen_motion", found)
    return searches


def choice(memory, **changed):
    return drained(memory.chosen(replace(SAME, **changed), UNINTERRUPTED))


def test_the_same_motion_is_found_once(finding):
    memory = MotionMemory()
    first = choice(memory)
    assert choice(memory, shapes=(ball(points=40), ball(2.0, points=40))) is first
    assert len(finding) == 1
    assert choice(MotionMemory()) is not first


@pytest.mark.parametrize(
    "changed",
    [
        {"shapes": (SHAPES[0], ball(2.1, points=40))},
        {"shapes": SHAPES[::-1]},
        {"names": ("A", "C")},
        {"kind": "warp"},
        {"coherence": 0.6},
        {"guides": [{0: 1, 1: 2}]},
    ],
)
def test_anything_that_changes_is_found_again(finding, changed):
    memory = MotionMemory()
    first = choice(memory)
    assert choice(memory, **changed) is not first
    assert choice(memory) is first and len(finding) == 2


def test_as_many_are_kept_as_fit(finding, monkeypatch):
    monkeypatch.setattr(motion_memory, "_MOST_BYTES", 200_000)
    memory, shapes = MotionMemory(), (ball(points=10_000), ball(2.0, points=40))
    first = choice(memory, shapes=shapes)
    last = choice(memory, shapes=shapes, coherence=0.1)
    assert choice(memory, shapes=shapes) is first
    choice(memory, shapes=shapes, coherence=0.2)
    assert choice(memory, shapes=shapes, coherence=0.1) is not last
    # Larger motions than that are searched for again.
    large = (ball(points=26_000), ball(2.0, points=40))
    assert choice(memory, shapes=large) is not choice(memory, shapes=large)


def test_errors_are_not_kept(finding):
    memory = MotionMemory()
    for _ in range(2):
        with pytest.raises(InputError, match="no map"):
            choice(memory, kind="guided")
    assert len(finding) == 2
