# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The coherence benchmark's measures, on shapes with known results."""

from __future__ import annotations

import numpy as np
import pytest

from assets.sculpting import tube
from benchmarks import sculptures
from benchmarks.coherence_measures import (
    Along,
    Evenness,
    Step,
    changes_of_topology,
    crossing_share,
    least_needed,
    limb_errors,
    reach,
    steps_between,
    worst_angle,
)
from benchmarks.coherence_pairs import pairs_named
from benchmarks.limb_paths import LimbPath, turned
from benchmarks.sculptures import Sculpture
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, box, joined, torus

TIMES = np.linspace(0.0, 1.0, 5)


def test_the_reach_of_a_ball_holds_95_percent_of_its_volume():
    assert reach(ball(radius=2.0)) == pytest.approx(2.0 * 0.95 ** (1 / 3), rel=0.01)
    assert reach(ball(radius=2.0).moved([5.0, -3.0, 1.0])) == pytest.approx(reach(ball(radius=2.0)))


def test_steps_are_in_cells():
    one = ball(radius=1.0)
    wider = TriangleMesh(1.1 * one.vertices, one.faces)
    (step,) = steps_between([one, wider], spacing=0.05)
    assert step.mean == pytest.approx(2.0, rel=0.02)
    assert step.largest == pytest.approx(2.0, rel=0.05)


def test_the_mean_distance_does_not_depend_on_the_triangles():
    (step,) = steps_between([box((2.0, 2.0, 2.0)), box((2.2, 2.2, 2.2))], spacing=0.1)
    assert step.mean == pytest.approx(1.0, rel=0.05)


def test_a_single_jumping_point_counts_as_a_jump():
    spiked = ball(radius=1.0)
    vertices = spiked.vertices.copy()
    vertices[0] *= 2.0
    (step,) = steps_between([spiked, TriangleMesh(vertices, spiked.faces)], spacing=0.1)
    assert step.largest == pytest.approx(10.0, rel=0.01)
    assert step.mean < 1.0


def test_even_steps_have_no_jumps():
    even = Evenness.of([Step(0.5, 1.0)] * 6)
    assert (even.jumps, even.largest, even.at_ends) == (0, 1.0, 1.0)
    uneven = Evenness.of([Step(0.9, 1.0), Step(0.3, 1.0), Step(0.3, 6.0), Step(0.3, 1.0), Step(0.3, 1.0)])
    assert uneven.jumps == 1
    assert uneven.largest == pytest.approx(3.0)
    assert uneven.at_ends == pytest.approx(3.0)


@pytest.mark.parametrize(("values", "more"), [([1, 1, 1], 0), ([0, 0, 1, 2], 0), ([0, 1, 0, 1], 2), ([0, 2, 0], 4)])
def test_only_unnecessary_changes_are_counted(values, more):
    assert least_needed(values) == more


def test_flickering_handles_and_components_are_counted():
    plain, ring = ball(radius=1.0), torus()
    pieces = joined(ball(radius=1.0), ball(radius=0.5).moved([4.0, 0.0, 0.0]))
    assert changes_of_topology([plain, ring, ring]) == 0
    assert changes_of_topology([plain, ring, plain, pieces, plain]) == 4


def test_the_worst_angle_is_that_of_slivers():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0], [0.5, np.tan(np.radians(5.0)) / 2, 0]])
    assert worst_angle(TriangleMesh.from_arrays(corners, [[0, 1, 2]])) == pytest.approx(60.0)
    assert worst_angle(TriangleMesh.from_arrays(corners, [[0, 1, 3]])) == pytest.approx(5.0)


def test_crossing_triangles_are_found():
    one = ball(radius=1.0)
    assert crossing_share(one) == 0.0
    both = joined(one, one.moved([0.7, 0.2, 0.1]))
    assert 0.02 < crossing_share(both) < 0.5


def test_frames_are_compared_with_the_interpolated_shapes():
    small, large = ball(radius=1.0), ball(radius=2.0)
    middle = ball(radius=1.5)
    along = Along.of([small, middle, large], [0.0, 0.5, 1.0])
    assert along.area == pytest.approx([1.5**2 / 2.5], rel=1e-6)
    assert along.volume == pytest.approx([1.5**3 / 4.5], rel=1e-6)
    assert along.reach == pytest.approx([1.0], rel=1e-6)


def test_a_vector_rotates_evenly_and_keeps_its_length():
    quarter = turned([2.0, 0.0, 0.0], [0.0, 2.0, 0.0], 1 / 3)
    np.testing.assert_allclose(quarter, [2 * np.cos(np.pi / 6), 2 * np.sin(np.pi / 6), 0.0], atol=1e-12)
    np.testing.assert_allclose(turned([1.0, 0, 0], [3.0, 0, 0], 0.25), [1.5, 0, 0], atol=1e-12)


@pytest.fixture(autouse=True)
def coarse_clay(monkeypatch):
    """Sculpt with wider spacing: the sculptures have limbs, and no details."""
    monkeypatch.setattr(sculptures, "SPACING", 2.0 * sculptures.SPACING)


def _body_with_arm(angle: float, length: float, seed: int) -> TriangleMesh:
    clay = Sculpture(seed)
    clay.add(tube([[0, 0, -0.5], [0, 0, 0.5]], [0.3, 0.3], steps=1))
    clay.add(tube([[0, 0, 0.5], length * _toward(angle) + [0, 0, 0.5]], [0.1, 0.1], steps=1))
    return clay.mesh(2500)


def _toward(angle: float) -> np.ndarray:
    return np.array([np.sin(angle), 0.0, -np.cos(angle)])


def _limb(low: float, high: float) -> LimbPath:
    start = np.array([0.0, 0.0, 0.5])
    return LimbPath(*(np.stack([start, start + 1.2 * _toward(angle)]) for angle in (low, high)))


def test_a_swinging_arm_has_no_error_and_a_shortening_one_has():
    low, high = np.radians(50.0), np.radians(150.0)
    angles = low + TIMES * (high - low)
    swung = [_body_with_arm(angle, 1.2, seed) for seed, angle in enumerate(angles)]
    right = limb_errors(swung, TIMES, _limb(low, high))
    assert right.length < 0.02
    assert right.tip < 0.02
    lengths = 1.2 * (1.0 - 0.25 * np.sin(np.pi * TIMES))
    short = [_body_with_arm(angles[k], lengths[k], k) for k in (1, 2, 3)]
    wrong = limb_errors([swung[0], *short, swung[-1]], TIMES, _limb(low, high))
    # The round end with radius 0.1 does not shrink.
    assert wrong.length == pytest.approx(0.25 * 1.2 / 1.3, abs=0.03)


@pytest.mark.parametrize("pair", pairs_named(["dog rears", "giraffe grazes"], None), ids=lambda pair: pair.name)
def test_bodies_sculpted_in_the_poses_in_between_keep_the_length_of_their_limbs(pair):
    ends, times = pair.ends(), [0.0, 0.35, 0.7, 1.0]
    limb = ends.limb
    between = []
    for t in times[1:-1]:
        body = limb.posed(t)
        # Animals stand on the floor, which a morph does not know.
        between.append(body.mesh.moved(limb.at(t)[limb.root] - body.joints[limb.root]))
    found = limb_errors([ends.first, *between, ends.second], times, limb)
    assert found.length < 0.01
    assert found.tip < 0.01


def test_an_arm_growing_elsewhere_is_not_mistaken_for_the_limb():
    low, high = np.radians(50.0), np.radians(150.0)
    grown = [_body_with_arm(low, 1.2, 1), *[_body_with_arm(low, 0.2, 2)] * 3, _body_with_arm(high, 1.2, 3)]
    found = limb_errors(grown, TIMES, _limb(low, high))
    assert found.length > 0.5
    assert found.tip > 0.2
