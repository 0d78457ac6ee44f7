# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends whose distance to a neighboring blend is limited."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.blending import solve_blends
from convwass_addon.applications.morphs.demands import Demand
from convwass_addon.applications.morphs.layouts import Blend
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.progress import drained
from tests.shapes import ball, joined

SETTINGS = MorphSettings(motion="transport", resolution=32)
SHAPES = (ball(1.0, (3, 0, 0)), joined(ball(0.7, (-0.9, 0, 0)), ball(0.7, (0.9, 0, 0))))
BLEND = Blend((0.2, 0.8))
ONE, TWO = Connectivity(1, 0, 0), Connectivity(2, 0, 0)


@pytest.fixture(scope="module")
def problem():
    return drained(prepared_problem(MorphInputs.of(SHAPES, ("a", "b")), SETTINGS, 1))


def frame_of(problem, demand=None):
    (frame,) = solve_blends(problem if demand is None else problem.demanding(demand), [BLEND])
    return frame


def test_a_blend_reaches_no_farther_than_it_may(problem):
    free = frame_of(problem)
    # It stands at a fifth of the way to the first shape.
    near, cell = ball(0.8, (0.6, 0, 0)), problem.lattice.spacing
    held = frame_of(problem, Demand(TWO, near, 2.0 * cell))
    assert held.record["held"] > 100
    for frame, least, most in ((free, 1.3, 2.0), (held, 0.0, 0.8 + 2.6 * cell)):
        away = np.linalg.norm(frame.mesh.vertices - (0.6, 0, 0), axis=1).max()
        assert least < away < most


def test_a_blend_within_its_limit_is_unchanged(problem):
    free = frame_of(problem)
    held = frame_of(problem, Demand(TWO, free.mesh, 3.0 * problem.lattice.spacing))
    assert held.record["held"] == 0
    np.testing.assert_array_equal(held.mesh.vertices, free.mesh.vertices)


def test_different_demands_have_different_digests():
    demands = [
        Demand(ONE),
        Demand(TWO),
        Demand(ONE, ball(), 1.0),
        Demand(ONE, ball(), 2.0),
        Demand(ONE, ball(2.0), 1.0),
        Demand(ONE, has=TWO),
        Demand(ONE, has=Connectivity(3, 0, 0)),
    ]
    assert len({demand.digest() for demand in demands}) == len(demands)
    assert Demand(ONE, ball(), 1.0).digest() == demands[2].digest()
