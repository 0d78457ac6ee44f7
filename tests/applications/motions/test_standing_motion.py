# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of shapes that stand on one floor stand on it, too, against rotations about points of the floor."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.morphs import moving_problem
from convwass_addon.applications.morphs.between_frames import between_frames
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.motions.growing_motion import GrowingMotion
from convwass_addon.applications.motions.guided_motion import GuidedPair
from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.applications.motions.standing_motion import StandingMotion, standing_motion
from convwass_addon.applications.one_mesh.key_paths import KeyDemands, paths_along
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained, payloads
from tests.applications.maps import coarse_maps
from tests.applications.motions.test_known_motions import fine, known_motion
from tests.shapes import ball, box, joined

LEAN = 70.0
TIMES = (0.04, 0.3, 0.5, 0.9)


def turned(points, degrees, about=(0.0, 0.0, 0.0)):
    """Points, (n, 3), rotated about the y axis through a point."""
    return Rotation.from_euler("y", degrees, degrees=True).apply(points - np.asarray(about)) + about


def pencil():
    """A thin double cone of length 2 that stands on its blunt tip at the origin."""
    mesh = ball(points=600)
    height = mesh.vertices[:, 2]
    slim = (0.03 + 0.1 * (1.0 - np.abs(height))) / np.maximum(np.sqrt(1.0 - height**2), 1e-9)
    points = mesh.vertices * np.stack([slim, slim, np.ones_like(height)], axis=1)
    return TriangleMesh(points - (0.0, 0.0, points[:, 2].min()), mesh.faces)


@dataclass(frozen=True)
class Leaning:
    """One body at several angles, which turns while its center moves along a straight line."""

    rest: TriangleMesh
    angles: tuple[float, ...]
    feet: tuple[float, ...] | None = None

    @property
    def shapes(self):
        """The body at every angle, with its tip at the origin, or elsewhere on the x axis."""
        feet = self.feet or (0.0,) * len(self.angles)
        return [
            TriangleMesh(turned(self.rest.vertices, angle) + np.array([foot, 0.0, 0.0]), self.rest.faces)
            for angle, foot in zip(self.angles, feet, strict=True)
        ]

    def moved(self, weights):
        centers = np.array([shape.vertices.mean(axis=0) for shape in self.shapes])
        own = turned(self.rest.vertices - self.rest.vertices.mean(axis=0), np.dot(weights, self.angles))
        return [
            MovedShape(shape, own + weights @ centers) if weight else None
            for shape, weight in zip(self.shapes, np.asarray(weights), strict=True)
        ]


@dataclass(frozen=True)
class Flying(Leaning):
    """The last shape is high above the others."""

    def moved(self, weights):
        up = np.array([0.0, 0.0, 3.0 * weights[-1]])
        found = Leaning.moved(self, np.asarray(weights))
        return [None if own is None else replace(own, vertices=own.vertices + up) for own in found]


@pytest.mark.parametrize("t", TIMES)
def test_a_body_that_leans_turns_about_its_tip(t):
    leaning = Leaning(pencil(), (0.0, LEAN))
    standing = standing_motion(leaning, 2, [(0, 1)])
    expected = turned(pencil().vertices, t * LEAN)
    sunk = leaning.moved(np.array([1.0 - t, t]))
    for own in sunk:
        assert np.abs(own.vertices - expected).max() > 0.05 * t * (1.0 - t)
    for own in standing.moved((1.0 - t, t)):
        # A tip weighs little, and points a hundredth of the size above the floor count, too.
        np.testing.assert_allclose(own.vertices, expected, atol=0.03)


@pytest.mark.parametrize("t", TIMES)
def test_a_body_that_travels_keeps_to_its_line(t):
    standing = standing_motion(Leaning(pencil(), (0.0, LEAN), (0.0, 3.0)), 2, [(0, 1)])
    expected = turned(pencil().vertices, t * LEAN) + np.array([3.0 * t, 0.0, 0.0])
    for own in standing.moved((1.0 - t, t)):
        np.testing.assert_allclose(own.vertices, expected, atol=0.03)


def test_shapes_alone_are_not_moved():
    leaning = Leaning(pencil(), (0.0, LEAN))
    standing = standing_motion(leaning, 2, [(0, 1)])
    for index in (0, 1):
        weights = np.eye(2)[index]
        np.testing.assert_array_equal(standing.moved(weights)[index].vertices, leaning.moved(weights)[index].vertices)
        beside = standing.moved(0.9999 * weights + 0.0001 * weights[::-1])[index]
        np.testing.assert_allclose(beside.vertices, leaning.shapes[index].vertices, atol=2e-3)


@dataclass(frozen=True)
class Stepping:
    """A bar with a foot at each end; the second is lifted by a turn about the middle of the bar."""

    rest: TriangleMesh
    raised: float

    def moved(self, weights):
        middle = np.array([0.0, 0.0, 1.0])
        turn = weights[1] * self.raised
        # On the second shape, the first foot is where it was.
        offset = weights[1] * (_foot(self.rest) - _foot(self._turned(self.raised, middle)))
        own = MovedShape(self.rest, self._turned(turn, middle).vertices + offset)
        return [own if weight else None for weight in weights]

    def _turned(self, angle, middle):
        return TriangleMesh(turned(self.rest.vertices, angle, middle), self.rest.faces)


def _foot(mesh):
    """Center of the first foot's vertices."""
    return mesh.vertices[:8].mean(axis=0)


def test_a_lifted_foot_lets_go_and_the_other_stays():
    feet = [box((0.1, 0.1, 0.1), (x, 0.0, 0.05)) for x in (-1.0, 1.0)]
    rest = fine(joined(*feet, box((2.1, 0.1, 0.1), (0.0, 0.0, 1.0))), 0.1)
    stepping = Stepping(rest, -25.0)
    standing = standing_motion(stepping, 2, [(0, 1)])
    slid, held = [], []
    for t in TIMES:
        slid.append(_foot(stepping.moved((1.0 - t, t))[0].mesh) - _foot(rest))
        held.append(_foot(standing.moved((1.0 - t, t))[0].mesh) - _foot(rest))
    assert np.abs(np.array(slid)[:, 0]).max() > 0.015
    assert np.abs(np.array(held)[:, 0]).max() < 0.003


def test_the_height_of_the_lowest_point_is_interpolated():
    leaning = Leaning(pencil(), (0.0, LEAN))
    standing = standing_motion(leaning, 2, [(0, 1)])
    floors = [shape.bounds[0, 2] for shape in leaning.shapes]
    # The rim of the tip is lower.
    assert floors[1] < floors[0] - 0.02
    for t in TIMES:
        for own in standing.moved((1.0 - t, t)):
            assert own.mesh.bounds[0, 2] == pytest.approx((1.0 - t) * floors[0] + t * floors[1], abs=1e-9)


def test_shapes_at_different_heights_have_no_floor():
    bodies = Leaning(pencil(), (0.0, 0.0))
    diagonal = pencil().diagonal

    @dataclass(frozen=True)
    class Raised:
        height: float

        def moved(self, weights):
            up = np.array([0.0, 0.0, weights[1] * self.height])
            return [
                None if own is None else MovedShape(own.rest, own.vertices + up)
                for own in bodies.moved(np.asarray(weights))
            ]

    shares = []
    for height in (0.0, 0.029, 0.045, 0.061):
        motion = standing_motion(Raised(height * diagonal), 2, [(0, 1)])
        shares.append(motion.shares[0, 1] if isinstance(motion, StandingMotion) else 0.0)
    np.testing.assert_allclose(shares, [1.0, 1.0, 0.5, 0.0], atol=0.02)


def test_shapes_stand_on_their_way_to_others_that_do_before_one_flies():
    flying = Flying(pencil(), (0.0, LEAN, -LEAN))
    standing = standing_motion(flying, 3, [(0, 1), (1, 2)])
    floors = [shape.bounds[0, 2] for shape in flying.shapes[:2]]
    own = standing.moved((0.5, 0.5, 0.0))[0].mesh
    assert flying.moved((0.5, 0.5, 0.0))[0].mesh.bounds[0, 2] < -0.05
    assert own.bounds[0, 2] == pytest.approx(np.mean(floors), abs=1e-9)
    weights = (0.0, 0.5, 0.5)
    np.testing.assert_array_equal(standing.moved(weights)[2].vertices, flying.moved(weights)[2].vertices)


@pytest.mark.parametrize("kind", [Leaning, Flying])
def test_the_way_around_a_triangle_is_continuous(kind):
    leaning = kind(pencil(), (0.0, LEAN, -LEAN))
    standing = standing_motion(leaning, 3, [(0, 1), (0, 2), (1, 2)])
    for one, other in ((0, 1), (0, 2), (1, 2)):
        on_edge = np.zeros(3)
        on_edge[[one, other]] = 0.4, 0.6
        inside = (1.0 - 1e-6) * on_edge + 1e-6 * (1.0 - np.ceil(on_edge))
        for own, near in zip(standing.moved(on_edge), standing.moved(inside), strict=True):
            if own is not None:
                np.testing.assert_allclose(near.vertices, own.vertices, atol=1e-4)


def test_what_grows_grows_up_from_the_floor():
    one = ball(0.5, points=300)
    one = one.moved((0.0, 0.0, -one.bounds[0, 2]))
    pair = known_motion([one, TriangleMesh(1.2 * one.vertices, one.faces)])
    volumes = np.array([shape.mesh.volume for shape in (pair.moved((1.0, 0.0))[0], pair.moved((0.0, 1.0))[1])])
    growing = GrowingMotion(pair, volumes, np.array([[0.0, 0.0, 0.5], [0.0, 0.0, 0.6]]))
    assert growing.moved((0.5, 0.5))[0].mesh.bounds[0, 2] < -1e-3
    for own in standing_motion(growing, 2, [(0, 1)]).moved((0.5, 0.5)):
        assert own.mesh.bounds[0, 2] == pytest.approx(0.0, abs=1e-9)


@pytest.fixture(scope="module")
def leaning_rods():
    """A rod that stands, and one that leans, with the lowest points at one height."""
    rest = fine(box((0.4, 0.4, 2.0)), 0.15)
    lean = TriangleMesh(turned(rest.vertices, 60.0), rest.faces)
    return [own.moved((0.0, 0.0, -own.bounds[0, 2])) for own in (rest, lean)]


def test_frames_of_a_morph_stand_on_the_floor(leaning_rods):
    lowest = {}
    for on_floor in (False, True):
        settings = MorphSettings(resolution=32, motion="guided", on_floor=on_floor)
        inputs = MorphInputs.of(leaning_rods, ["A", "B"])
        work = morph(inputs, [Blend((0.5, 0.5))], settings, computation=Computation(1))
        with coarse_maps():
            (frame,) = payloads(work, MorphFrame)
        lowest[on_floor] = frame.mesh.bounds[0, 2]
    assert lowest[False] < -0.05
    # A third of a cell.
    assert lowest[True] == pytest.approx(0.0, abs=0.02)


def test_blends_between_frames_have_the_floor_of_the_whole_path(leaning_rods, tmp_path, monkeypatch):
    """Alone, the first two shapes might get another one."""
    asked = []

    def standing(motion, count, pairs):
        asked.append(pairs)
        return motion

    monkeypatch.setattr(moving_problem, "standing_motion", standing)
    shapes, names, path = [*leaning_rods, leaning_rods[0]], ("A", "B", "C"), path_blends(3, 2)
    settings = MorphSettings(resolution=32, motion="guided", detail=0.0, carry=False)
    with coarse_maps():
        inputs = MorphInputs.of(shapes, names)
        drained(between_frames(inputs, path, [1.0], settings, Computation(1, cache=FrameCache(tmp_path))))
    assert asked == [[(0, 1), (1, 2)]]


def test_shape_keys_stay_on_the_floor(leaning_rods):
    motion = known_motion(leaning_rods)
    motion = replace(motion, pairs={(0, 1): GuidedPair(score=1.0, guides_left_out=0, detour=1.0, turn=0.0)})
    lowest = {}
    for on_floor in (False, True):
        demands = KeyDemands(0.01, on_floor=on_floor)
        (path,) = drained(paths_along(motion, leaning_rods, ["A", "B"], demands, UNINTERRUPTED))
        lowest[on_floor] = path.positions[:, :, 2].min()
    assert lowest[False] < -0.05
    assert lowest[True] > -0.02
