# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import pytest

from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.steady_topology import legs_of
from convwass_addon.applications.morphs.surface_steps import SurfaceSteps, farthest
from tests.shapes import ball, joined

BLENDS = path_blends(2, 12)


def chains_of(places, extra=()):
    """Return the chains of balls at positions along x, with a second ball in some blends."""
    steps = SurfaceSteps(legs_of(BLENDS))
    for index, (blend, x) in enumerate(zip(BLENDS, places, strict=True)):
        here = ball(1.0, (x, 0, 0))
        mesh = joined(here, ball(0.3, (x + 2.0, 0, 0))) if index in extra else here
        steps.add(MorphFrame(blend, None if blend.source is not None else mesh, {}))
    return steps.chains()


def test_distances_of_balls():
    assert farthest(ball(), ball(1.0, (0.5, 0, 0))) == pytest.approx(0.5, abs=0.05)
    assert farthest(ball(), joined(ball(), ball(0.3, (2, 0, 0)))) == 0.0
    assert farthest(joined(ball(), ball(0.3, (2, 0, 0))), ball()) == pytest.approx(1.3, abs=0.05)


def test_even_steps_are_unchanged():
    assert chains_of([0.2 * i for i in range(13)]) == []


def test_appearing_parts_grow_afterwards_and_vanishing_parts_shrink_before():
    (grows,) = chains_of([0.2 * i for i in range(13)], extra=range(4, 13))
    assert (grows.beside, grows.blends) == (BLENDS[3], tuple(BLENDS[4:12]))
    assert len(grows.near.vertices) == len(ball().vertices)
    # In the eight remaining steps the small ball moves by 1.3 and seven times 0.2.
    assert grows.reach == pytest.approx(2.7 / 8, abs=0.03)
    (shrinks,) = chains_of([0.2 * i for i in range(13)], extra=range(9))
    assert (shrinks.beside, shrinks.blends) == (BLENDS[9], tuple(BLENDS[8:0:-1]))
    assert len(shrinks.near.vertices) == len(ball().vertices)


def test_a_part_in_one_blend_grows_and_shrinks():
    grows, shrinks = chains_of([0.2 * i for i in range(13)], extra=[4])
    assert (grows.blends[0], shrinks.blends[0]) == (BLENDS[4], BLENDS[4])
