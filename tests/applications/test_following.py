# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of animated inputs use the shapes in the poses of their frames."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.animation import Animation, ShapeAnimation
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.demands import Demand
from convwass_addon.applications.morphs.following_problem import FollowingProblem
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.origins import velocities
from convwass_addon.applications.morphs.part_labels import unparted
from convwass_addon.applications.morphs.preparing import sketchable_problem
from convwass_addon.applications.motions.guided_motion import GuidedMotion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.motions.posed_motion import PosedMotion
from convwass_addon.applications.motions.warp_motion import WarpEffort, warp_motion
from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.laid_meshes import Laid
from convwass_addon.applications.registrations.shape_deformations import split_deformation
from convwass_addon.errors import Cancelled
from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing.subdivision import with_short_edges
from convwass_addon.progress import UNINTERRUPTED, Control, drained
from tests.shapes import ball, box, torus

FRAMES = 4


def turned(mesh, angle, to=(0.0, 0.0, 0.0)):
    """Turn a mesh about the Z axis, and move it."""
    c, s = np.cos(angle), np.sin(angle)
    return TriangleMesh(mesh.vertices @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + to, mesh.faces)


def frames_of(shapes, animation, blends=None, **settings):
    blends = blends or path_blends(2, FRAMES)
    chosen = MorphSettings(32, **settings)
    work = morph(MorphInputs.of(shapes, ["A", "B"], animation=animation), blends, chosen, computation=Computation(1))
    return [report.payload for report in work if isinstance(report.payload, MorphFrame)]


def animated(*poses, frames=FRAMES):
    """Return an animation of inputs whose poses are functions of the frame."""
    times = tuple(map(float, range(frames + 1)))
    shapes = tuple(ShapeAnimation(times, tuple(pose(time) for time in times)) for pose in poses)
    return Animation(shapes, tuple(np.linspace(0.0, frames, len(poses))))


@pytest.fixture(scope="module")
def cubes():
    """Frames of cubes that turn alike and go their ways; and where the cube between them is at a time."""
    start = box((1, 1, 1))

    def first(time):
        return turned(start, 0.3 * time, (2.0 * time, 0, 0))

    def second(time):
        return turned(start, 0.3 * time, (0, -time, 4))

    def place(time):
        share = time / FRAMES
        return (1 - share) * np.array([2.0 * time, 0, 0]) + share * np.array([0, -time, 4.0])

    return frames_of([first(1), second(1)], animated(first, second), motion="transport"), place


def test_a_cube_that_moves_becomes_a_cube_that_moves(cubes):
    frames, place = cubes
    assert [frame.blend.frame for frame in frames] == list(range(FRAMES + 1))
    for frame in frames[1:-1]:
        time = frame.blend.frame
        found = turned(TriangleMesh(frame.mesh.vertices - place(time), frame.mesh.faces), -0.3 * time)
        np.testing.assert_allclose(found.bounds, [[-0.5] * 3, [0.5] * 3], atol=0.03)
        assert frame.mesh.volume == pytest.approx(1.0, rel=0.03)


def test_velocities_are_those_of_the_inputs_and_of_the_way_between_them(cubes):
    frames, place = cubes
    frame = frames[2]
    found = velocities(frame.velocity_points, (-1.0 / FRAMES, 1.0 / FRAMES))
    around = frame.mesh.vertices - place(2)
    spun = 0.3 * np.stack([-around[:, 1], around[:, 0], 0 * around[:, 2]], axis=1)
    expected = (place(2.001) - place(1.999)) / 0.002 + spun
    np.testing.assert_allclose(np.median(np.abs(found - expected), axis=0), 0.0, atol=0.03)


def test_origins_are_on_the_inputs_as_they_were_read(cubes):
    """There their colors are looked up."""
    rest = turned(box((1, 1, 1)), 0.3, (2.0, 0, 0))
    origins = cubes[0][3].origins[0]
    inside = turned(TriangleMesh(origins - (2.0, 0, 0), rest.faces), -0.3).vertices
    assert np.abs(np.abs(inside).max(axis=1) - 0.5).max() < 1e-4


def test_a_blend_equals_that_of_static_shapes_in_the_same_poses():
    def first(time):
        return TriangleMesh(
            torus(0.8, 0.3).vertices * (1.0, 1.0 + 0.2 * time, 1.0) + (time, 0, 0), torus(0.8, 0.3).faces
        )

    def second(time):
        return TriangleMesh(ball(1.0, points=400).vertices * (1.0 + 0.1 * time, 1.0, 1.0), ball(1.0, points=400).faces)

    settings = {"motion": "transport"}
    followed = frames_of([first(0), second(0)], animated(first, second), **settings)[1]
    (still,) = frames_of([first(1), second(1)], None, [Blend((0.75, 0.25))], **settings)
    cell = np.ptp(first(0).bounds, axis=0).max() / 26
    assert followed.mesh.volume == pytest.approx(still.mesh.volume, rel=0.02)
    distances = ClosestPointFinder(still.mesh.corners).find(followed.mesh.vertices).distances
    assert np.quantile(distances, 0.95) < 0.5 * cell


def test_blends_by_transport_start_from_the_preceding_one_also_when_computed_again():
    def first(time):
        return turned(box((1, 1, 1)), 0.1 * time)

    def second(time):
        return turned(box((3.0, 0.4, 0.4)), 0.1 * time)

    shapes, names = [first(0), second(0)], ["A", "B"]
    still = drained(sketchable_problem(MorphInputs.of(shapes, names), MorphSettings(32, motion="transport"), 1))
    animation = animated(first, second, frames=8)
    problem = FollowingProblem.around(still.with_connectivity(), None, animation, shapes, names, unparted(2))
    run = path_blends(2, 8)[2:5]
    frames = problem.frames(run)
    alone = problem.frame(run[2], UNINTERRUPTED)
    assert sum(frames[2].record["iterations"]) < sum(alone.record["iterations"])
    one_piece = Connectivity(pieces=1, handles=0, bubbles=0)
    (again,) = problem.frames_again(run, {run[2]: Demand(one_piece)})
    np.testing.assert_array_equal(again.mesh.vertices, frames[2].mesh.vertices)
    (near,) = problem.frames_again(run, {run[2]: Demand(one_piece, first(4), 0.15)})
    assert near.record["held"] > 100
    found = ClosestPointFinder(first(4).corners)
    assert found.find(near.mesh.vertices).distances.max() < found.find(frames[2].mesh.vertices).distances.max()


def test_triangles_may_change_from_frame_to_frame():
    def first(time):
        return ball(0.5 + 0.05 * time, points=300 + 20 * int(time))

    frames = frames_of([first(0), box((1, 1, 1))], animated(first, lambda _: box((1, 1, 1))), motion="warp")
    assert frames[1].mesh.volume == pytest.approx(0.75 * first(1).volume + 0.25, rel=0.1)
    assert frames[1].record["motion"]["reason"] == "TOPOLOGY"


def rod(angle, to=0.0):
    """A rod along x that is bent to an arc of a circle."""
    points = with_short_edges(box((3.0, 0.4, 0.4)), 0.12, 100_000).mesh
    if angle == 0:
        return TriangleMesh(points.vertices + to, points.faces)
    radius = 3.0 / angle
    turn, out = points.vertices[:, 0] / radius, radius - points.vertices[:, 1]
    bent = np.stack([out * np.sin(turn), radius - out * np.cos(turn), points.vertices[:, 2]], axis=1)
    return TriangleMesh(bent + to, points.faces)


def angle_of(vertices):
    """How far the ends of a rod have turned against each other."""
    rest = rod(0).vertices
    ends = [vertices[np.abs(rest[:, 0] - x) < 0.11] for x in (-1.4, 1.4)]
    near = [vertices[np.abs(rest[:, 0] - x) < 0.11] for x in (-1.2, 1.2)]
    inward, outward = (far.mean(axis=0) - close.mean(axis=0) for far, close in zip(ends, near, strict=True))
    x, y = -inward[:2]
    return float(np.arctan2(x * outward[1] - y * outward[0], x * outward[0] + y * outward[1]))


@pytest.fixture(scope="module")
def posed():
    """The motion of a straight rod and a bent one, whose vertices belong together."""
    shapes = [rod(0.0), rod(1.5)]
    carriers = tuple(carrier_of(shape, "rod", 6000, Control()) for shape in shapes)
    found = {}
    for one, other in ((0, 1), (1, 0)):
        laid = Laid(carriers[other].mesh.vertices, np.ones(len(carriers[one].mesh.vertices)))
        found[one, other] = split_deformation(carriers[one], carriers[other], laid, found.get((other, one)), Control())
    motion = GuidedMotion(carriers, found, {}, GuidedSettings())
    return PosedMotion.of(motion, shapes, ["A", "B"], [(0, 1)], 0.5, Control()), shapes


def test_a_motion_between_poses_at_rest_is_that_of_the_shapes(posed):
    motion, shapes = posed
    weights = (0.3, 0.7)
    found = motion.at(shapes, [0, 1], Control()).moved(weights)
    for own, expected in zip(found, motion.chosen.moved(weights), strict=True):
        np.testing.assert_allclose(own.vertices, expected.vertices, atol=1e-3)


def test_a_motion_follows_the_poses(posed):
    """Rods whose bend changes during the morph: halfway, each is bent by the mean."""
    motion, _ = posed
    poses = [rod(0.6, (0, 5, 0)), rod(2.0, (3, 0, 0))]
    found = motion.at(poses, [0, 1], Control()).moved((0.5, 0.5))
    for own, rest in zip(found, motion.guided.carriers, strict=True):
        assert angle_of(own.vertices[: len(poses[0].vertices)]) == pytest.approx(1.3 * 2.6 / 3.0, abs=0.1)
        assert own.rest is rest.rest
    np.testing.assert_allclose(found[0].vertices, found[1].vertices, atol=0.05)


def test_the_velocity_is_the_same_up_to_the_ends_of_what_is_known():
    """Inputs are read only where they have a weight, so there may be no frame after the last blend."""
    start = box((1, 1, 1))
    animation = ShapeAnimation((0.0, 1.0, 2.0), tuple(start.moved((3.0 * time, 0, 0)) for time in range(3)))
    for time in (0.0, 0.3, 1.0, 2.0):
        np.testing.assert_allclose(animation.velocity(time), np.tile([3.0, 0, 0], (len(start.vertices), 1)), atol=1e-12)
    assert not ShapeAnimation((1.0,), (start,)).velocity(1.0).any()


def test_cached_blends_of_animated_inputs_are_used(tmp_path):
    shapes = [box((1, 1, 1)), box((1, 1, 2))]
    still = animated(*(lambda time, own=own: own.moved((0.1 * time, 0, 0)) for own in shapes))
    for reused in (0, FRAMES + 1):
        cache = FrameCache(tmp_path)
        settings, computation = MorphSettings(24, motion="transport"), Computation(1, cache=cache)
        blends = path_blends(2, FRAMES)
        drained(morph(MorphInputs.of(shapes, ["A", "B"], animation=still), blends, settings, computation=computation))
        assert (cache.reused, cache.notices) == (reused, [])


def test_following_can_be_cancelled():
    shapes = [box((1, 1, 1)), box((1, 2, 1))]
    control = Control()
    control.cancel()
    still = animated(*(lambda _, own=own: own for own in shapes))
    with pytest.raises(Cancelled):
        inputs = MorphInputs.of(shapes, ["A", "B"], animation=still)
        drained(morph(inputs, path_blends(2, 4), MorphSettings(32), control))


def test_a_warp_follows_the_poses():
    """Shapes with a common rigid motion: the warp moves with them."""
    shapes = [rod(0.0), box((1.5, 1.0, 0.6))]
    chosen = drained(warp_motion(shapes, ["A", "B"], [(0, 1)], 0.5, Control(), WarpEffort(24, 4)))
    motion = PosedMotion.of(chosen, shapes, ["A", "B"], [(0, 1)], 0.5, Control())
    poses = [turned(shape, 0.7, (1.0, 2.0, 0.0)) for shape in shapes]
    found = motion.at(poses, [0, 1], Control()).moved((0.4, 0.6))
    for own, expected in zip(found, chosen.moved((0.4, 0.6)), strict=True):
        assert own.rest is expected.rest
        placed = turned(expected.mesh, 0.7, (1.0, 2.0, 0.0))
        assert np.linalg.norm(own.vertices - placed.vertices, axis=1).max() < 0.03
