# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Extruded shapes move as their sections do, whatever the axis."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.motions.motion_memory import MotionMemory
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.applications.outlines.extruded_motion import extruded_motion
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.applications.maps import coarse_surfaces
from tests.flat_shapes import ellipse, rectangle
from tests.shapes import ball, box, extruded, joined, rotated

TILT = np.array([0.5, 1.0, -0.25])
PLATE = extruded(rectangle((-1.0, -0.7), (1.0, 0.7)))
DISC = extruded(ellipse(), low=-0.4, high=0.4)
RING = extruded(ellipse(), ellipse(radii=(0.6, 0.6)))
# Its hole is so small that opening it to the outside is not tried.
WASHER = extruded(ellipse(), ellipse(radii=(0.3, 0.3)))
# A C: a ring with a gap to the right.
AROUND = np.linspace(0.4, 2.0 * np.pi - 0.4, 80)
GAPPED = extruded(
    np.concatenate([r * np.column_stack([np.cos(a), np.sin(a)]) for r, a in ((1, AROUND), (0.6, AROUND[::-1]))])
)
BARS = extruded(rectangle((-1.0, -1.0), (-0.4, 1.0)), rectangle((0.4, -1.0), (1.0, 1.0)))
MOTIONS = MotionMemory()


@pytest.fixture(scope="module", autouse=True)
def coarse():
    with coarse_surfaces():
        yield


def choice(*shapes, kind="automatic", pairs=((0, 1),), coherence=0.5):
    names = [f"shape {index}" for index in range(len(shapes))]
    return drained(MOTIONS.chosen(MotionRequest(shapes, names, pairs, kind, coherence), UNINTERRUPTED))


def moved_halfway(first, second):
    return choice(first, second).motion.moved([0.5, 0.5])


def test_a_plate_that_grows_stays_a_plate():
    larger = extruded(rectangle((-3.0, -2.0), (3.0, 2.0)), low=-0.2, high=0.8)
    found = choice(PLATE, larger)
    assert (found.kind, found.reason) == ("guided", "OUTLINES")
    for time in (0.25, 0.5, 0.75):
        for own in found.motion.moved([1.0 - time, time]):
            sides = (1.0 - time) * np.array([2.0, 1.4, 0.4]) + time * np.array([6.0, 4.0, 1.0])
            assert np.ptp(own.mesh.bounds, axis=0) == pytest.approx(sides, rel=0.01)
            assert own.mesh.volume == pytest.approx(np.prod(sides), rel=0.015)
            assert topology(own.mesh).closed


@pytest.mark.parametrize(("first", "second"), [(PLATE, DISC), (WASHER, DISC), (RING, GAPPED), (BARS, DISC)])
def test_moved_shapes_coincide_with_ends_between(first, second):
    one, other = moved_halfway(first, second)
    assert one.mesh.bounds == pytest.approx(other.mesh.bounds, abs=0.02)
    assert one.mesh.volume == pytest.approx(other.mesh.volume, rel=0.03)
    ends = [0.5 * (first.bounds[side, 2] + second.bounds[side, 2]) for side in (0, 1)]
    for own, target in ((one, other), (other, one)):
        assert own.mesh.bounds[:, 2] == pytest.approx(ends)
        assert target.finder.find_about(own.vertices).distances.max() < 0.03


def test_shapes_without_weight_of_others_are_unchanged():
    motion = choice(RING, GAPPED).motion
    ring, none = motion.moved([1.0, 0.0])
    assert none is None
    assert ring.mesh.volume == pytest.approx(RING.volume, rel=0.01)
    assert cKDTree(ring.vertices).query(RING.vertices)[0].max() < 0.05


def test_parents_face_the_same_way_as_the_parts_of_the_surface():
    shape, _ = moved_halfway(DISC, PLATE)
    normals = (
        np.cross(m[:, 1] - m[:, 0], m[:, 2] - m[:, 0]) for m in (shape.rest.corners, DISC.corners[shape.parents])
    )
    own, others = (each / np.linalg.norm(each, axis=1)[:, None] for each in normals)
    assert (own * others).sum(axis=1).min() > 0.9


def test_the_axis_does_not_matter():
    one, _ = moved_halfway(DISC, PLATE)
    tilted, _ = moved_halfway(rotated(DISC, TILT), rotated(PLATE, TILT))
    wanted = rotated(one.mesh, TILT)
    assert tilted.mesh.volume == pytest.approx(wanted.volume, rel=0.01)
    assert tilted.finder.find_about(wanted.vertices).distances.max() < 0.02


def test_chamfers_are_followed():
    """A square plate with chamfers of 45 degrees, and one of another size without."""
    corners = rectangle((-1.0, -1.0), (1.0, 1.0))
    rings, heights = [0.9 * corners, corners, corners, 0.9 * corners], [-0.3, -0.2, 0.2, 0.3]
    points = np.column_stack([np.concatenate(rings), np.repeat(heights, 4)])
    faces = [(0, 2, 1), (0, 3, 2), (12, 13, 14), (12, 14, 15)]
    for a, b in ((4 * level + side, 4 * level + (side + 1) % 4) for level in range(3) for side in range(4)):
        faces += [(a, b, b + 4), (a, b + 4, a + 4)]
    chamfered = TriangleMesh.from_arrays(points, faces)
    rest, _ = choice(chamfered, box((3.0, 3.0, 0.6))).motion.moved([1.0, 0.0])
    assert rest.mesh.volume == pytest.approx(chamfered.volume, rel=0.005)
    assert rest.finder.find_about(points).distances.max() < 0.02


def test_a_body_inside_does_not_dent_the_ends():
    inner = box((0.3, 0.3, 0.3))
    plate = extruded(rectangle((-1.0, -1.0), (1.0, 1.0)))
    moved = choice(joined(box(), inner), plate).motion.moved([1.0, 0.0])[0]
    assert moved.mesh.area == pytest.approx(box().area)
    assert moved.mesh.volume == pytest.approx(1.0)


def test_all_shapes_must_be_extruded_along_one_axis():
    def is_extruded(*shapes):
        request = MotionRequest(shapes, ["one", "other"], [(0, 1)], "automatic", 0.5)
        return extruded_motion(request, UNINTERRUPTED) is not None

    upright = rotated(DISC, (0.5 * np.pi, 0.0, 0.0))
    assert not is_extruded(PLATE, ball())
    assert not is_extruded(RING, upright)
    # The plate is also extruded along that axis.
    assert is_extruded(PLATE, upright)


def test_the_user_may_ask_for_it_or_for_none():
    assert choice(PLATE, DISC, kind="guided").reason == "ASKED"
    assert choice(PLATE, DISC, kind="transport").motion is None
    assert choice(PLATE, DISC, coherence=0.0).motion is None


def test_less_coherence_moves_part_of_the_way():
    half = choice(PLATE, DISC, coherence=0.25).motion.moved([0.5, 0.5])[0]
    assert half.mesh.bounds[1, 2] == pytest.approx(0.2 + 0.5 * 0.5 * 0.2)


def test_around_a_triangle_the_way_closes():
    oval = extruded(ellipse(radii=(1.5, 0.6)))
    motion = choice(PLATE, DISC, oval, pairs=((0, 1), (0, 2), (1, 2))).motion
    weights = [(0.5, 0.3, 0.2), (0.2, 0.5, 0.3), (0.5, 0.3, 0.2)]
    first, _, last = (motion.moved(own)[0].vertices for own in weights)
    assert np.array_equal(first, last)


def test_a_ring_opens_once_while_it_becomes_a_c():
    settings = MorphSettings(resolution=48)
    computation = Computation(motions=MOTIONS)
    inputs = MorphInputs.of([RING, GAPPED], ["shape 0", "shape 1"])
    steps = morph(inputs, path_blends(2, 6), settings, computation=computation)
    found = {step.payload.blend: step.payload for step in steps if isinstance(step.payload, MorphFrame)}
    between = [frame for blend, frame in sorted(found.items(), key=lambda own: own[0].frame) if blend.source is None]
    genera = [1 - topology(frame.mesh).euler // 2 for frame in between]
    assert (genera[0], genera[-1]) == (1, 0)
    assert genera == sorted(genera, reverse=True)
    for frame in between:
        assert frame.record["motion"] == {"kind": "guided", "reason": "OUTLINES"}
        assert topology(frame.mesh).closed
        share = frame.blend.weights[1]
        assert frame.mesh.volume == pytest.approx((1.0 - share) * RING.volume + share * GAPPED.volume, rel=0.005)
