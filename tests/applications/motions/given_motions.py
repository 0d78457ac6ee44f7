# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions and figures that tests give instead of computing them; the motions themselves have their own tests."""

from types import SimpleNamespace

import numpy as np

from convwass_addon.applications.motions import motion_candidates, surface_choice
from convwass_addon.applications.motions.guided_motion import GuidedPair
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.errors import ResourceError
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.shapes import ball, joined, renumbered

BARBELL = joined(ball(points=40), ball(center=(4.0, 1.0, 0.0), points=40))
SHAPES = (BARBELL, renumbered(BARBELL.moved((0.0, 0.0, 1.0))))
COMBINED = SimpleNamespace(with_coherence=lambda coherence: ("combined", coherence))
FADED = SimpleNamespace(with_coherence=lambda coherence: ("faded", coherence))
WARP = SimpleNamespace(with_coherence=lambda coherence: ("warp", coherence), sizes=np.ones(2))


def guided_with(score, turn=0.0, detour=1.0, left_out=0, crumpling=1.0, tumbles=False):
    """Return a guided motion with these figures."""
    pair = GuidedPair(score, left_out, detour, turn, crumpling, tumbles)
    return SimpleNamespace(pairs={(0, 1): pair}, with_coherence=lambda coherence: ("guided", coherence))


def work_of(outcome):
    """Return a generator function that yields nothing and returns the outcome, or raises it."""

    def work(*_arguments, **_options):
        if isinstance(outcome, Exception):
            raise outcome
        return outcome
        yield

    return work


def unless_guided(motion, *_arguments):
    """Return that half of the distance is left, or fail to measure it for a guided motion."""
    if motion == ("guided", 0.5):
        raise ResourceError("no memory")
    return 0.5


def give(
    monkeypatch,
    guided,
    warp=WARP,
    combined=COMBINED,
    left=0.4,
    by_coarse=1.0,
    by_warps=0.1,
    by_warp_alone=0.7,
    may_map=True,
):
    """Let bakes find these motions, or errors, and these shares of the distance that they leave."""
    monkeypatch.setattr(motion_candidates, "guided_motion", work_of(guided))
    monkeypatch.setattr(motion_candidates, "warp_motion", work_of(warp))
    monkeypatch.setattr(surface_choice, "may_map", work_of(may_map))

    def completed(*arguments):
        is_coarse = arguments[2].cells < 32 and arguments[3] == 0.0
        return work_of(FADED if is_coarse and combined is COMBINED else combined)()

    monkeypatch.setattr(motion_candidates, "combined_motion", completed)
    shares = {("guided", 0.5): left, ("combined", 0.5): by_warps, ("warp", 0.5): by_warp_alone}
    shares["faded", 0.5] = by_coarse
    monkeypatch.setattr(motion_candidates, "remaining_share", lambda motion, *_arguments: shares[motion])


def chosen_by(choose, kind="automatic", coherence=0.5, guides=(), shapes=SHAPES):
    """Return the choice for two shapes."""
    return drained(choose(MotionRequest(shapes, ("A", "B"), [(0, 1)], kind, coherence, guides), UNINTERRUPTED))
