# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions between shapes with known correspondence and known motion."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.motions.guided_motion import GuidedMotion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.laid_meshes import Laid
from convwass_addon.applications.registrations.shape_deformations import split_deformation
from convwass_addon.applications.workers import one_blas_thread
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing.subdivision import with_short_edges
from convwass_addon.progress import Control
from tests.applications.maps import arm
from tests.grids import figure
from tests.shapes import ball, joined


def fine(mesh, share=0.028):
    """The same surface, with edges so short that motions do not cut them."""
    return with_short_edges(mesh, share * mesh.root_area, 100_000).mesh


def deformed(mesh, points):
    return TriangleMesh(points, mesh.faces)


def known_motion(shapes, pairs=None, **settings):
    """A motion between meshes of the same triangles, whose vertices belong together."""
    # Meshes of so many vertices are neither divided nor simplified.
    counts = [1 + 2 * len(mesh.vertices) // 3 for mesh in shapes]
    carriers = [carrier_of(mesh, f"shape {k}", counts[k], Control()) for k, mesh in enumerate(shapes)]
    found = {}
    for one, other in pairs or [(i, j) for j in range(len(shapes)) for i in range(j)]:
        for ends in ((one, other), (other, one)):
            here, there = (carriers[shape] for shape in ends)
            trust = np.ones(len(here.mesh.vertices))
            back = found.get(ends[::-1])
            found[ends] = split_deformation(here, there, Laid(there.mesh.vertices, trust), back, Control())
    return GuidedMotion(tuple(carriers), found, {}, GuidedSettings(**settings))


def rotated(points, vector, offset=0.0):
    return points @ Rotation.from_rotvec(vector).as_matrix().T + offset


def bent(points, angle):
    """Bend the x axis to an arc of a circle in the plane of x and y, keeping its length."""
    low, high = points[:, 0].min(), points[:, 0].max()
    radius = (high - low) / angle
    turn, out = (points[:, 0] - low) / radius, radius - points[:, 1]
    return np.stack([low + out * np.sin(turn), radius - out * np.cos(turn), points[:, 2]], axis=1)


def center_line(rest, points):
    """Means of the slices of a rod along x."""
    slices = np.digitize(rest[:, 0], np.linspace(rest[:, 0].min(), rest[:, 0].max(), 21)[1:-1])
    return np.stack([points[slices == k].mean(axis=0) for k in range(20)])


def line_length(rest, points):
    return np.linalg.norm(np.diff(center_line(rest, points), axis=0), axis=1).sum()


@pytest.fixture(scope="module")
def body():
    return figure()[0]


@pytest.fixture(scope="module")
def rod():
    return arm(along=80)[0]


@pytest.fixture(scope="module")
def bent_rod(rod):
    """A rod that is straight and bent by 2 radians, and their motion."""
    shapes = [rod, deformed(rod, bent(rod.vertices, 2.0))]
    # As in bakes; with several threads, matrices that are factorized again differ in the last bits.
    with one_blas_thread():
        return shapes, known_motion(shapes)


VECTOR = np.radians(90.0) * np.array([2.0, -1.0, 2.0]) / 3.0


@pytest.fixture(scope="module")
def rotation(body):
    return known_motion([body, deformed(body, rotated(body.vertices, VECTOR, 2.0))])


@pytest.mark.parametrize("share", [0.1, 0.5, 0.8])
def test_a_rotation_is_one_all_the_way(body, rotation, share):
    vector, motion = VECTOR, rotation
    one, other = motion.moved([1.0 - share, share])
    center = body.vertex_areas @ body.vertices / body.area
    expected = rotated(body.vertices - center, share * vector)
    path = one.vertices - expected
    np.testing.assert_allclose(path, np.tile(path.mean(axis=0), (len(path), 1)), atol=1e-5)
    np.testing.assert_allclose(other.vertices, one.vertices, atol=1e-5)
    # Its centroid, though not its center of mass, moves on a straight line.
    straight = (1.0 - share) * center + share * rotated(center, vector, 2.0)
    np.testing.assert_allclose(path[0], straight, atol=0.01)


def test_a_rod_that_is_bent_keeps_its_length(rod):
    """By more than half a turn, which single rotations cannot tell from less in the other direction."""
    angle = 220.0
    motion = known_motion([rod, deformed(rod, bent(rod.vertices, np.radians(angle)))])
    length = line_length(rod.vertices, rod.vertices)
    for share in (0.25, 0.5, 0.75):
        for shape in motion.moved([1.0 - share, share]):
            line = center_line(rod.vertices, shape.vertices)
            assert line_length(rod.vertices, shape.vertices) == pytest.approx(length, rel=0.005)
            first, last = line[1] - line[0], line[-1] - line[-2]
            turned = np.degrees(np.arctan2(last[1], last[0]) - np.arctan2(first[1], first[0])) % 360.0
            # The center line of slices turns by 19 of its 20 parts.
            assert turned == pytest.approx(0.93 * share * angle, rel=0.05)


def test_similar_inputs_move_alike(bent_rod):
    shapes, motion = bent_rod
    vector, scale, offset = np.array([0.5, -1.2, 0.3]), 7.0, np.array([3.0, 0.0, -5.0])
    others = [deformed(mesh, scale * rotated(mesh.vertices, vector) + offset) for mesh in shapes]
    expected = motion.moved([0.6, 0.4])
    for found, shape in zip(known_motion(others).moved([0.6, 0.4]), expected, strict=True):
        np.testing.assert_allclose(found.vertices, scale * rotated(shape.vertices, vector) + offset, atol=1e-6)


def test_swapped_inputs_move_the_other_way(bent_rod):
    """Up to how well the limbs' axes can be told, which are those of the first shape."""
    shapes, motion = bent_rod
    there, back = motion.moved([0.7, 0.3]), known_motion(shapes[::-1]).moved([0.3, 0.7])
    np.testing.assert_allclose(back[1].vertices, there[0].vertices, atol=1e-4)
    np.testing.assert_allclose(back[0].vertices, there[1].vertices, atol=1e-4)


def elbow(points, swing, twist):
    """A rod along x whose second half swings in the plane of x and y about its middle, and twists there."""
    x = points[:, 0]
    middle, width = x.min() + 0.7 * np.ptp(x), 0.3 * np.ptp(x)
    line = np.linspace(x.min(), x.max(), 2001)
    share = np.clip((line - middle) / width + 0.5, 0.0, 1.0)
    steps = np.diff(line)[:, None] * np.stack([np.cos(swing * share), np.sin(swing * share)], axis=1)[1:]
    center = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    own = np.interp(x, line, share)
    turns = Rotation.from_euler("xz", np.stack([twist * own, swing * own], axis=1))
    across = turns.apply(points * [0.0, 1.0, 1.0])
    return across + np.stack([*(np.interp(x, line, along) for along in center.T), np.zeros(len(x))], axis=1)


@pytest.fixture(scope="module")
def thin_rod():
    return arm(around=6, radius=0.15)[0]


def curled(points, angle):
    """A rod along x whose last two fifths are bent to an arc of a circle in the plane of x and y."""
    x = points[:, 0]
    start = x.min() + 0.6 * np.ptp(x)
    radius = (x.max() - start) / angle
    turn, out = np.maximum(x - start, 0.0) / radius, radius - points[:, 1]
    return np.stack([np.minimum(x, start) + out * np.sin(turn), radius - out * np.cos(turn), points[:, 2]], axis=1)


def test_a_limb_curls_by_more_than_half_a_turn(thin_rod):
    """The shortest rotations of its end would bend it the other way."""
    angle = np.radians(220.0)
    motion = known_motion([thin_rod, deformed(thin_rod, curled(thin_rod.vertices, angle))])
    for shape in motion.moved([0.5, 0.5]):
        np.testing.assert_allclose(shape.vertices, curled(thin_rod.vertices, 0.5 * angle), atol=0.03)


def test_a_body_turns_the_way_on_which_all_of_it_turns_less(thin_rod):
    """Most of it turns by 200 degrees, and its end by 50 back, which is less than 160 and 410."""
    vertical = np.array([0.0, 0.0, 1.0])
    turned = rotated(elbow(thin_rod.vertices, np.radians(-250.0), 0.0), np.radians(200.0) * vertical)
    halfway = rotated(elbow(thin_rod.vertices, np.radians(-125.0), 0.0), np.radians(100.0) * vertical)
    # The second shape crosses itself.
    shape, _ = known_motion([thin_rod, deformed(thin_rod, turned)]).moved([0.5, 0.5])
    apart = shape.vertices - halfway
    assert np.linalg.norm(apart - apart.mean(axis=0), axis=1).max() < 0.15


def test_a_limb_that_swings_and_twists_stays_in_a_plane(rod):
    """Along the shortest rotations, its end would leave the plane by 8 % of the rod's length."""
    points = elbow(rod.vertices, np.radians(100.0), np.radians(80.0))
    at_rest = rod.vertices[:, 0] < np.quantile(rod.vertices[:, 0], 0.3)
    length = line_length(rod.vertices, rod.vertices)
    for shape in known_motion([rod, deformed(rod, points)]).moved([0.5, 0.5]):
        line = center_line(rod.vertices, shape.vertices)
        centered = [own[at_rest] - own[at_rest].mean(axis=0) for own in (rod.vertices, shape.vertices)]
        turn, _ = Rotation.align_vectors(*centered)
        assert abs(turn.apply(line[-1] - line[0])[2]) < 0.015 * length


def test_a_limb_that_becomes_most_of_the_surface_still_swings_and_twists(thin_rod):
    """By itself, the second shape would rotate as a whole, with its end, and both would be apart halfway."""
    along = (thin_rod.vertices[:, :1] - thin_rod.vertices[:, 0].min()) / np.ptp(thin_rod.vertices[:, 0])
    growth = np.clip((along - 0.55) / 0.3, 0.0, 1.0) * (0.0, 2.0, 2.0)
    swing, twist = np.radians([100.0, 80.0])
    motion = known_motion([thin_rod, deformed(thin_rod, elbow(thin_rod.vertices * (1.0 + growth), swing, twist))])
    halfway = elbow(thin_rod.vertices * (1.0 + 0.5 * growth), 0.5 * swing, 0.5 * twist)
    for shape in motion.moved([0.5, 0.5]):
        assert np.linalg.norm(shape.vertices - halfway, axis=1).max() < 0.06


def test_three_shapes_meet_wherever_they_are_blended(body):
    axis = np.array([0.0, 0.6, 0.8])
    shapes = [deformed(body, rotated(body.vertices, angle * axis, 3.0 * angle)) for angle in (0.0, 1.0, -0.8)]
    motion = known_motion(shapes)
    center = body.vertex_areas @ body.vertices / body.area
    for weights in ([0.2, 0.3, 0.5], [1 / 3, 1 / 3, 1 / 3], [0.5, 0.5, 0.0]):
        angle = weights[1] - 0.8 * weights[2]
        straight = sum(
            weight * rotated(center, turn * axis, 3.0 * turn)
            for weight, turn in zip(weights, (0.0, 1.0, -0.8), strict=True)
        )
        moved = motion.moved(weights)
        path = moved[0].vertices - rotated(body.vertices - center, angle * axis)
        np.testing.assert_allclose(path, np.tile(path.mean(axis=0), (len(path), 1)), atol=1e-5)
        np.testing.assert_allclose(path[0], straight, atol=0.01)
        for weight, shape in zip(weights, moved, strict=True):
            assert (shape is None) == (weight == 0)
            if shape is not None:
                np.testing.assert_allclose(shape.vertices, moved[0].vertices, atol=1e-5)


def test_the_way_around_a_triangle_closes(rod):
    swung = [
        rod,
        deformed(rod, bent(rod.vertices, 2.0)),
        deformed(rod, bent(rod.vertices[:, [0, 2, 1]], 1.0)[:, [0, 2, 1]]),
    ]
    motion = known_motion(swung)
    loop = [[1, 0, 0], [0.5, 0.5, 0], [0, 1, 0], [0, 0.5, 0.5], [0, 0, 1], [0.5, 0, 0.5], [1, 0, 0]]
    frames = [motion.moved(weights) for weights in loop]
    np.testing.assert_array_equal(frames[0][0].vertices, frames[-1][0].vertices)
    # Three shapes that rotate about different axes still differ, but by little compared with their motion.
    moved = motion.moved([1 / 3, 1 / 3, 1 / 3])
    apart = [np.linalg.norm(moved[k].vertices - moved[0].vertices, axis=1).mean() for k in (1, 2)]
    before = [np.linalg.norm(swung[k].vertices - swung[0].vertices, axis=1).mean() for k in (1, 2)]
    assert (np.array(apart) < 0.05 * np.array(before)).all()
    # There is no jump when a weight approaches zero.
    nearly, at = motion.moved([0.5, 0.5 - 1e-7, 1e-7]), motion.moved([0.5, 0.5, 0.0])
    for one, other in zip(nearly[:2], at[:2], strict=True):
        np.testing.assert_allclose(one.vertices, other.vertices, atol=1e-5)


def test_ends_are_exact(rod, bent_rod):
    shapes, motion = bent_rod
    for weights, own in (([1.0, 0.0], 0), ([0.0, 1.0], 1)):
        found = motion.moved(weights)
        assert found[1 - own] is None
        np.testing.assert_array_equal(found[own].vertices, shapes[own].vertices)
    # And nothing jumps there.
    nearly = motion.moved([1.0 - 1e-9, 1e-9])
    np.testing.assert_allclose(nearly[0].vertices, rod.vertices, atol=1e-6)
    np.testing.assert_allclose(nearly[1].vertices, rod.vertices, atol=1e-6)


def test_coherence_goes_from_no_motion_to_no_stretch(rod):
    longer = rod.vertices * (1.5, 1.0, 1.0)
    motion = known_motion([rod, deformed(rod, bent(longer, 2.0))])
    still = motion.with_coherence(0.0).moved([0.5, 0.5])
    np.testing.assert_array_equal(still[0].vertices, rod.vertices)
    # Half of the motion half of the way is a quarter of it.
    slow, quarter = motion.with_coherence(0.25).moved([0.5, 0.5]), motion.moved([0.75, 0.25])
    lines = [center_line(rod.vertices, shape[0].vertices) for shape in (slow, quarter)]
    spans = [np.linalg.norm(line[-1] - line[0]) for line in lines]
    assert spans[0] == pytest.approx(spans[1], rel=0.01)
    lengths = []
    for coherence in (0.5, 0.75, 1.0):
        moved = motion.with_coherence(coherence).moved([0.5, 0.5])[0].vertices
        lengths.append(line_length(rod.vertices, moved) / line_length(rod.vertices, rod.vertices))
    scale = 0.5 * (1.0 + motion.deformations[0, 1].scale)
    assert lengths[0] == pytest.approx(1.25, rel=0.01)
    assert lengths[2] == pytest.approx(scale, rel=0.05)
    assert lengths[2] < lengths[1] < lengths[0]


def test_components_keep_their_position_on_the_body():
    mesh = fine(joined(arm()[0], ball(0.2, (3.8, 0.45, 0.0), points=60)))
    target = deformed(mesh, bent(mesh.vertices, np.radians(150.0)))
    one, _ = known_motion([mesh, target]).moved([0.5, 0.5])
    apart = []
    for points in (mesh.vertices, one.vertices):
        on_rod = np.flatnonzero(np.linalg.norm(mesh.vertices - (3.8, 0.3, 0.0), axis=1) < 0.12)
        is_ball = np.linalg.norm(mesh.vertices - (3.8, 0.45, 0.0), axis=1) < 0.21
        apart.append(np.linalg.norm(points[is_ball].mean(axis=0) - points[on_rod].mean(axis=0)))
    assert apart[1] == pytest.approx(apart[0], abs=0.03)


def test_it_can_be_sent_to_another_process(bent_rod):
    _, motion = bent_rod
    with one_blas_thread():
        expected, again = (own.moved([0.5, 0.5]) for own in (motion, pickle.loads(pickle.dumps(motion))))
    for found, shape in zip(again, expected, strict=True):
        np.testing.assert_array_equal(found.vertices, shape.vertices)


def test_only_prepared_shapes_occur_together():
    body = arm()[0]
    shapes = [body, deformed(body, bent(body.vertices, 1.0)), deformed(body, bent(body.vertices, 2.0))]
    motion = known_motion(shapes, [(0, 1), (1, 2)])
    assert motion.moved([0.0, 0.5, 0.5])[0] is None
    with pytest.raises(ValueError, match="not prepared"):
        motion.moved([0.5, 0.0, 0.5])
    with pytest.raises(ValueError, match="3 shapes"):
        motion.moved([0.5, 0.5])


@pytest.mark.parametrize("wrong", [{"coherence": 1.1}, {"coherence": -0.1}, {"carrier_vertices": 10}])
def test_settings_that_make_no_sense_are_refused(wrong):
    with pytest.raises(InputError):
        GuidedSettings(**wrong)
