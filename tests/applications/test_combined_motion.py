# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import pickle
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.motions.combined_motion import combined_motion
from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.applications.motions.remaining_distance import remaining_share
from convwass_addon.applications.motions.warp_motion import WarpEffort
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control, drained
from tests.shapes import ball

ANGLE = 1.2
FIRST, SECOND = (
    TriangleMesh(ball(points=300).vertices * size, ball(points=300).faces)
    for size in ((1.6, 0.8, 0.7), (0.8, 1.0, 1.2))
)


@dataclass(frozen=True)
class Turning:
    """Both shapes turn about an axis, as far as the other has weight, and are not deformed."""

    coherence: float = 0.5

    def moved(self, weights):
        turns = (Rotation.from_rotvec((0.0, 0.0, angle * ANGLE)) for angle in (weights[1], -weights[0]))
        return [
            MovedShape(shape, turn.apply(shape.vertices)) if weight > 0 else None
            for shape, turn, weight in zip((FIRST, SECOND), turns, weights, strict=True)
        ]

    def with_coherence(self, coherence):
        return Turning(coherence)


@pytest.fixture(scope="module", params=[1.0, 0.25, 0.0])
def combined(request):
    asked = MotionRequest((FIRST, SECOND), ("a", "b"), [(0, 1)], "automatic", 0.5)
    effort = WarpEffort(cells=24, rounds=5)
    return drained(combined_motion(Turning(), asked, effort, request.param, Control()))


def test_ends_are_those_of_the_first_motion(combined):
    for weights in ((1.0, 0.0), (0.0, 1.0)):
        moved, expected = combined.moved(weights), Turning().moved(weights)
        assert [shape is None for shape in moved] == [weight == 0.0 for weight in weights]
        np.testing.assert_array_equal(moved[int(weights[1])].vertices, expected[int(weights[1])].vertices)
    near = (1.0 - 1e-6, 1e-6)
    np.testing.assert_allclose(combined.moved(near)[0].vertices, Turning().moved(near)[0].vertices, atol=1e-4)


def test_half_way_it_is_the_warp(combined):
    warp = combined.warps[0, 1]
    # Arrivals differ, the warps do not.
    if combined.arrival == 1.0:
        assert remaining_share(warp, [rest.mesh for rest in warp.rests]) < 0.5
    for found, expected in zip(combined.moved((0.5, 0.5)), warp.moved((0.5, 0.5)), strict=True):
        np.testing.assert_allclose(found.vertices, expected.vertices[: len(found.vertices)], atol=1e-6)


@pytest.mark.parametrize("t", [0.2, 0.7])
def test_the_warp_turns_with_the_body(combined, t):
    weights = (1.0 - t, t)
    warp = combined.warps[0, 1]
    displaced = [
        moved.vertices - rest.mesh.vertices for moved, rest in zip(warp.moved(weights), warp.rests, strict=True)
    ]
    turn = Rotation.from_rotvec((0.0, 0.0, (t - 0.5) * ANGLE))
    for place, (found, before) in enumerate(zip(combined.moved(weights), Turning().moved(weights), strict=True)):
        by = displaced[place][: len(before.vertices)]
        # The shape of less weight has gone most of the way to the other.
        lost = (1.0 - combined.arrival) * np.cos(np.pi * t) ** 2 if weights[place] < 0.5 else 0.0
        np.testing.assert_allclose(found.vertices, before.vertices + (1.0 - lost) * turn.apply(by), atol=1e-6)


def test_a_warp_that_fades_leaves_the_end_of_the_first_motion(combined):
    last = (1e-6, 1.0 - 1e-6)
    (found, _), (before, _), (displaced, _) = (own.moved(last) for own in (combined, Turning(), combined.warps[0, 1]))
    by = displaced.vertices[: len(found.vertices)] - combined.warps[0, 1].rests[0].mesh.vertices[: len(found.vertices)]
    assert np.linalg.norm(by, axis=1).max() > 0.1
    apart = np.linalg.norm(found.vertices - before.vertices, axis=1)
    np.testing.assert_allclose(apart, combined.arrival * np.linalg.norm(by, axis=1), atol=1e-4)


def test_it_is_the_same_in_another_process(combined):
    copy = pickle.loads(pickle.dumps(combined))
    for one, other in zip(copy.moved((0.3, 0.7)), combined.moved((0.3, 0.7)), strict=True):
        np.testing.assert_array_equal(one.vertices, other.vertices)


def test_without_coherence_it_adds_nothing(combined):
    still = combined.with_coherence(0.0)
    assert still.guided.coherence == 0.0
    for one, other in zip(still.moved((0.4, 0.6)), Turning().moved((0.4, 0.6)), strict=True):
        np.testing.assert_allclose(one.vertices, other.vertices, atol=0.02)
