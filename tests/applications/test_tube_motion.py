# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tubes move as their center lines bend."""

from __future__ import annotations

import pickle
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.motions.choosing import chosen_motion
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.applications.outlines.tube_motion import tube_motion
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.plane.polylines import along_polyline, arc_lengths
from convwass_addon.geometry.recognition.center_lines import sliced_tube
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.line_tubes import helix, straight, tube
from tests.shapes import ball

# A helix of three turns, and its length.
RADIUS, PITCH = 0.5, 0.6
LENGTH = 3.0 * np.hypot(2.0 * np.pi * RADIUS, PITCH)
SPRING, ROD = tube(helix(RADIUS, PITCH, 3.0)), tube(straight(LENGTH, 160))


def choice(*shapes, coherence=0.5):
    pairs = [(one, other) for other in range(len(shapes)) for one in range(other)]
    request = MotionRequest(shapes, [f"shape {k}" for k in range(len(shapes))], pairs, "automatic", coherence)
    return tube_motion(request, UNINTERRUPTED)


def fitted(points, to):
    """Points, (n, 3), rotated and moved to be closest to others."""
    ours, theirs = points - points.mean(axis=0), to - to.mean(axis=0)
    return Rotation.align_vectors(theirs, ours)[0].apply(ours) + to.mean(axis=0)


def resampled(line, count):
    along = arc_lengths(line)
    return along_polyline(np.linspace(0.0, along[-1], count), along, line)


def test_a_spring_that_straightens_is_a_spring_of_half_the_curvature():
    """Its torsion stays the same."""
    square = np.hypot(RADIUS, PITCH / (2.0 * np.pi)) ** 2
    curvature, torsion = 0.5 * RADIUS / square, PITCH / (2.0 * np.pi) / square
    both = curvature**2 + torsion**2
    turns = LENGTH * np.sqrt(both) / (2.0 * np.pi)
    expected = resampled(helix(curvature / both, 2.0 * np.pi * torsion / both, turns), 60)
    motion = choice(SPRING, ROD).motion
    for shape in motion.moved([0.5, 0.5]):
        line = resampled(sliced_tube(shape.mesh).points, 60)
        assert min(np.abs(fitted(own, expected) - expected).max() for own in (line, line[::-1])) < 0.03


def test_tubes_start_as_they_are_and_coincide_on_the_way():
    motion = choice(SPRING, ROD).motion
    for index, weights in enumerate(np.eye(2)):
        shape = motion.moved(weights)[index]
        np.testing.assert_allclose(shape.vertices, shape.rest.vertices, atol=1e-12)
    for time in (0.2, 0.5, 0.8):
        one, other = motion.moved([1.0 - time, time])
        for here, there in ((one, other), (other, one)):
            assert there.finder.find(here.vertices, UNINTERRUPTED).distances.max() < 0.03
        assert one.mesh.volume == pytest.approx(ROD.volume, rel=0.03)


def test_the_way_back_is_the_same():
    there, back = choice(SPRING, ROD).motion.moved([0.7, 0.3]), choice(ROD, SPRING).motion.moved([0.3, 0.7])
    np.testing.assert_allclose(there[0].vertices, back[1].vertices, atol=0.03)


def test_the_axis_of_a_spring_stays_upright():
    for time in (0.2, 0.4, 0.6, 0.8):
        shape = choice(SPRING, ROD).motion.moved([1.0 - time, time])[0]
        line = sliced_tube(shape.mesh).points
        course = np.linspace(-1.0, 1.0, len(line)) @ line
        assert np.linalg.norm(course[:2]) < 0.12 * abs(course[2])


def test_springs_of_opposite_handedness_do_not_whirl():
    """Although a spring between them leads nowhere: halfway, its course points along none of its directions."""
    mirrored = helix(0.5, 0.4, 3.5) * [1.0, -1.0, 1.0]
    motion = choice(tube(helix(0.6, 0.5, 2.5)), tube(mirrored)).motion
    moved = [motion.moved([1.0 - time, time])[0].vertices for time in np.linspace(0.01, 0.99, 50)]
    steps = [np.linalg.norm(after - before, axis=1).mean() for before, after in pairwise(moved)]
    assert max(steps) < 1.5 * np.median(steps)


def test_a_spiral_is_not_turned_by_its_course():
    angles = np.linspace(2.0 * np.pi, 8.0 * np.pi, 240)
    spiral = 0.05 * angles[:, None] * np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)
    assert not choice(tube(spiral, 0.05), ROD).motion.directed
    assert choice(SPRING, ROD).motion.directed


def test_volume_is_the_weighted_mean_everywhere():
    thin, thick = tube(helix(1.0, 0.0, 0.8), 0.1), tube(straight(3.0, 100), np.linspace(0.15, 0.2, 100))
    motion = choice(thin, thick).motion
    lengths = 0.8 * 2.0 * np.pi, 3.0
    for time in (0.25, 0.5, 0.75):
        one, other = motion.moved([1.0 - time, time])
        shares = np.array([1.0 - time, time])
        for shape in (one, other):
            assert shape.mesh.volume == pytest.approx(shares @ [thin.volume, thick.volume], rel=0.04)
            radii = sliced_tube(shape.mesh).radii
            ends = sorted([radii[len(radii) // 6], radii[-len(radii) // 6]])
            squares = np.stack([np.square([0.1, 0.1]) * lengths[0], np.square([0.158, 0.192]) * lengths[1]])
            wanted = np.sqrt(shares @ squares / (shares @ lengths))
            assert ends == pytest.approx(wanted, rel=0.06)


def test_similar_tubes_move_alike():
    turn, scale, shift = Rotation.from_rotvec([0.5, -1.2, 0.3]), 7.0, np.array([3.0, 0.0, -5.0])
    others = [TriangleMesh(scale * turn.apply(mesh.vertices) + shift, mesh.faces) for mesh in (SPRING, ROD)]
    (found, _), (expected, _) = (choice(*own).motion.moved([0.6, 0.4]) for own in (others, (SPRING, ROD)))
    np.testing.assert_allclose(found.vertices, scale * turn.apply(expected.vertices) + shift, atol=1e-2)


def test_the_thick_end_becomes_the_thick_end():
    """Whichever of both a mesh begins with, and wherever it is."""
    radii = np.linspace(0.2, 0.1, 160)
    arc = helix(1.0, 0.0, 0.8)
    for line, own in ((arc, radii), (arc[::-1], radii[::-1]), (arc, radii[::-1])):
        one, other = choice(tube(straight(5.0, 160), radii), tube(line, own)).motion.moved([0.5, 0.5])
        assert cKDTree(other.vertices).query(one.vertices)[0].max() < 0.12
        between = sliced_tube(one.mesh).radii
        assert between.max() > 1.5 * between.min()


def test_three_tubes_meet():
    arc = tube(helix(1.0, 0.0, 0.8))
    moved = choice(SPRING, ROD, arc).motion.moved([0.2, 0.5, 0.3])
    for other in moved[1:]:
        assert other.finder.find(moved[0].vertices, UNINTERRUPTED).distances.max() < 0.03


def test_less_coherence_moves_less_far():
    half, full = choice(SPRING, ROD, coherence=0.25).motion, choice(SPRING, ROD).motion
    np.testing.assert_allclose(half.moved([0.5, 0.5])[0].vertices, full.moved([0.75, 0.25])[0].vertices, atol=1e-9)
    assert half.moved([1.0, 0.0])[1] is None


def test_a_motion_can_be_sent_to_another_process():
    motion = choice(SPRING, ROD).motion
    sent = pickle.loads(pickle.dumps(motion))
    np.testing.assert_array_equal(sent.moved([0.5, 0.5])[1].vertices, motion.moved([0.5, 0.5])[1].vertices)


@pytest.mark.parametrize(
    "shapes", [(ROD, tube(helix(5.0, 0.0, 0.1))), (ROD, ball())], ids=["nearly as straight", "no tube"]
)
def test_other_shapes_are_mapped(shapes):
    assert choice(*shapes) is None


def test_the_choice_says_why():
    requests = [MotionRequest([SPRING, ROD], ["a", "b"], [(0, 1)], kind, 0.5) for kind in ("automatic", "guided")]
    found = [drained(chosen_motion(request, UNINTERRUPTED)).record() for request in requests]
    assert found == [{"kind": "guided", "reason": reason} for reason in ("TUBES", "ASKED")]


def test_a_morph_of_tubes():
    shapes = [tube(helix(1.0, 0.0, 0.75), 0.3), tube(straight(1.5 * np.pi), 0.3)]
    steps = list(morph(MorphInputs.of(shapes, ["hook", "rod"]), path_blends(2, 2), MorphSettings(resolution=40)))
    (frame,) = [step.payload for step in steps if step.payload is not None and step.payload.blend.source is None]
    assert frame.record["motion"] == {"kind": "guided", "reason": "TUBES"}
    assert frame.mesh.volume == pytest.approx(shapes[1].volume, rel=0.03)
