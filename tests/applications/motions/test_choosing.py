# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The choice of a motion by the score of the map; the motions themselves have their own tests."""

from types import SimpleNamespace

import pytest

from convwass_addon.applications.motions import choosing
from convwass_addon.applications.motions.choosing import chosen_motion
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.errors import InputError, ResourceError
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.shapes import ball, box, joined, square

BARBELL = joined(ball(points=40), ball(center=(4.0, 0.0, 0.0), points=40))
SHAPES = (BARBELL, ball(2.0, points=40))


def guided_with(score, turn=0.0, detour=1.0):
    return SimpleNamespace(pairs={(0, 1): SimpleNamespace(score=score, turn=turn, detour=detour)})


def warp_leaving(fraction):
    return SimpleNamespace(signals={(0, 1): SimpleNamespace(length_before=8.0, length_left=8.0 * fraction)})


MEETING_WARP = warp_leaving(0.1)


def work_of(outcome):
    """Return a generator function that yields nothing and returns the outcome, or raises it."""

    def work(*_arguments):
        if isinstance(outcome, Exception):
            raise outcome
        return outcome
        yield

    return work


@pytest.fixture
def motions(monkeypatch):
    def given(guided, warp=MEETING_WARP, combined="the combined motion"):
        for name, outcome in (("guided_motion", guided), ("warp_motion", warp), ("combined_motion", combined)):
            monkeypatch.setattr(choosing, name, work_of(outcome))

    return given


def choice(kind="automatic", coherence=0.5, guides=(), shapes=SHAPES):
    request = MotionRequest(shapes, ("A", "B"), [(0, 1)], kind, coherence, guides)
    return drained(chosen_motion(request, UNINTERRUPTED))


@pytest.mark.parametrize(("score", "kind"), [(0.95, "guided"), (0.6, "combined"), (0.1, "warp")])
def test_automatic_follows_the_score_of_the_map(motions, score, kind):
    motions(guided_with(score))
    found = choice()
    assert (found.kind, found.score) == (kind, score)
    assert found.reason == ("FITS" if kind == "guided" else "UNLIKE")


def test_the_record_says_by_how_much_shapes_were_turned(motions):
    motions(guided_with(0.95, turn=-90.0))
    assert choice().record()["turned"] == 90


def test_automatic_warps_without_a_map(motions):
    motions(InputError("no map"))
    assert choice().record() == {"kind": "warp", "reason": "FAILED", "failure": "no map", "left": 0.1}


def test_maps_that_make_detours_are_replaced_by_a_warp(motions):
    """Unless guides say what corresponds, or the map is good: limbs may swing far."""
    motions(guided_with(0.6, detour=1.8))
    assert choice().record() == {"kind": "warp", "reason": "UNLIKE", "score": 0.6, "detour": 1.8, "left": 0.1}
    assert choice(guides=[{0: 7, 1: 7}]).kind == "combined"
    motions(guided_with(0.95, detour=1.8))
    assert choice().kind == "guided"


def test_shapes_that_a_warp_does_not_bring_together_are_transported(motions):
    motions(guided_with(0.6, detour=1.8), warp=warp_leaving(0.5))
    found = choice()
    assert found.motion is None
    assert found.record() == {"kind": "transport", "reason": "APART", "score": 0.6, "detour": 1.8, "left": 0.5}
    motions(InputError("no map"), warp=warp_leaving(0.5))
    assert choice().record() == {"kind": "transport", "reason": "FAILED", "failure": "no map", "left": 0.5}


def test_automatic_falls_back_to_transport_after_errors(motions):
    motions(guided_with(0.1), warp=ResourceError("no memory"))
    found = choice()
    assert found.motion is None
    assert found.record() == {"kind": "transport", "reason": "FAILED", "score": 0.1, "failure": "no memory"}


def test_a_requested_motion_is_computed_or_refused(motions):
    motions(guided_with(0.1))
    assert [choice(kind).kind for kind in ("guided", "warp", "transport")] == ["guided", "warp", "transport"]
    motions(InputError("no map"))
    with pytest.raises(InputError, match="no map"):
        choice("guided")


def test_guides_are_never_dropped_silently(motions):
    motions(InputError("no vertex 7"))
    with pytest.raises(InputError, match="no vertex 7"):
        choice(guides=[{0: 7, 1: 7}])


def test_shapes_without_limbs_are_transported(motions):
    motions(AssertionError("must not be asked for"))
    assert choice(shapes=(ball(points=200), box())).record() == {"kind": "transport", "reason": "SOLID"}
    motions(guided_with(0.95))
    assert choice(shapes=(ball(points=200), square())).kind == "guided"
    assert choice("guided", shapes=(ball(points=200), box())).kind == "guided"


def test_without_coherence_there_is_no_motion(motions):
    motions(AssertionError("must not be asked for"))
    assert choice(coherence=0.0).kind == "transport"
