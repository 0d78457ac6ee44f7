# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids of revolution stay some while they move, whatever the axis."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.props import revolved, smooth, vase, wine_glass
from convwass_addon.applications.motions.motion_memory import MotionMemory
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.applications.outlines.revolved_motion import motion_with_parts, revolved_motion
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import triangle_normals
from convwass_addon.geometry.recognition.revolved_bodies import common_revolved_bodies
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.applications.maps import coarse_surfaces
from tests.applications.motions.test_known_motions import known_motion
from tests.revolutions import BOWL, CONE, CUP, LARGER_CONE, asideness, floor
from tests.shapes import box, joined, piece_count, rotated, torus

TILT = np.array([0.5, 1.0, -0.25])
AWAY = LARGER_CONE.moved((2.0, 0.0, 0.0))
# As few sides as solids of revolution may have.
PYRAMIDS = tuple(revolved([(0.0, 0.0), (radius, 0.0), (0.0, 2.0)], 8) for radius in (1.0, 1.5))
# Alike if one of them is turned upside down.
PIN = revolved(smooth([(0.0, 0.0), (0.25, 0.0), (0.42, 0.5), (0.38, 0.9), (0.16, 1.4), (0.22, 1.65), (0.0, 1.92)]))
BULB = revolved(smooth([(0.0, 0.0), (0.2, 0.0), (0.2, 0.4), (0.5, 0.95), (0.5, 1.2), (0.3, 1.5), (0.0, 1.6)]))
# A peg from the middle of the wall to 0.6 beside it, and a cup of twice the size without one.
PEG = box((0.66, 0.2, 0.2), (1.22, 0.0, 0.9))
PEGGED, LARGE_CUP = joined(CUP, PEG), TriangleMesh(2.0 * CUP.vertices, CUP.faces)
VASE = vase()
TIMES = (0.25, 0.5, 0.75)
MOTIONS = MotionMemory()


@pytest.fixture(scope="module", autouse=True)
def coarse():
    with coarse_surfaces():
        yield


def pair(*shapes, kind="automatic", coherence=0.5):
    return MotionRequest(shapes, ["one", "other"], [(0, 1)], kind, coherence)


def choice(*shapes, kind="automatic", coherence=0.5):
    return drained(MOTIONS.chosen(pair(*shapes, kind=kind, coherence=coherence), UNINTERRUPTED))


def test_a_cone_that_grows_stays_a_cone():
    found = choice(CONE, AWAY)
    assert (found.kind, found.reason) == ("guided", "OUTLINES")
    for time in TIMES:
        for own in found.motion.moved([1.0 - time, time]):
            radius, height = 1.0 + 2.0 * time, 2.0 + time
            assert np.ptp(own.mesh.bounds, axis=0) == pytest.approx([2.0 * radius, 2.0 * radius, height], rel=0.02)
            assert own.mesh.volume == pytest.approx(CONE.volume / 2.0 * radius**2 * height, rel=0.05)


@pytest.mark.parametrize(
    ("first", "second", "time"),
    [*((CUP, BOWL, time) for time in TIMES), (CONE, AWAY, 0.5), (PIN, BULB, 0.5)],
)
def test_moved_shapes_coincide_and_are_revolved(first, second, time):
    moved = choice(first, second).motion.moved([1.0 - time, time])
    center = time * second.bounds.mean(axis=0)
    for own, other in (moved, moved[::-1]):
        assert asideness(own.mesh, (0.0, 0.0, 1.0), center) < 0.05
        assert other.finder.find_about(own.vertices).distances.max() < 0.05
    assert moved[0].mesh.volume == pytest.approx(moved[1].mesh.volume, rel=0.03)


def test_thin_walls_swell_little():
    glass = wine_glass()
    wanted = (0.5 * np.cbrt(glass.volume) + 0.5 * np.cbrt(VASE.volume)) ** 3
    # Before it is scaled; with the arithmetic mean of stretches, the volume is 2.1 times as large.
    assert choice(glass, VASE).motion.motion.moved([0.5, 0.5])[0].mesh.volume < 1.8 * wanted


def test_sides_stay_plane():
    sides, step = 8, np.pi / 4.0
    thin = revolved([(0.0, 0.0), (0.5, 0.0), (0.5, 1.4), (0.47, 1.4), (0.47, 0.03), (0.0, 0.03)], sides)
    solid = revolved([(0.0, 0.0), (0.6, 1.0), (0.0, 2.0)], sides)
    found = choice(thin, solid)
    assert found.reason == "OUTLINES"
    for own in found.motion.moved([0.5, 0.5]):
        # The middle of the side that a triangle is on; edges are at multiples of the step.
        angles = np.arctan2(*own.mesh.corners.mean(axis=1)[:, 1::-1].T)
        middles = (np.floor(angles / step) + 0.5) * step
        around = np.column_stack([-np.sin(middles), np.cos(middles), np.zeros(len(middles))])
        aside = np.abs((triangle_normals(own.mesh.corners) * around).sum(axis=1))
        assert own.mesh.face_areas @ aside < 0.02 * own.mesh.area


def test_sections_match_as_they_stand():
    found = choice(PIN, BULB)
    assert found.reason == "OUTLINES"
    moved = found.motion.moved([0.5, 0.5])[0]
    top = PIN.vertices[:, 2] > 1.9
    assert moved.vertices[: len(PIN.vertices)][top, 2].min() > moved.mesh.bounds[1, 2] - 0.1


def test_points_of_the_axis_stay_on_it():
    motion = choice(CUP, BOWL).motion
    on_axis = np.hypot(*CUP.vertices[:, :2].T) < 1e-9
    assert on_axis.any()
    moved = motion.moved([0.5, 0.5])[0].vertices[: len(CUP.vertices)]
    assert np.hypot(*moved[on_axis, :2].T).max() < 1e-9


def test_between_two_vessels_nothing_fills_up():
    moved = choice(CUP, BOWL).motion.moved([0.5, 0.5])[0].mesh
    assert floor(moved) < 0.25


def test_a_shape_alone_is_unchanged():
    cup, none = choice(CUP, BOWL).motion.moved([1.0, 0.0])
    assert none is None
    np.testing.assert_allclose(cup.vertices, cup.rest.vertices, rtol=0.0, atol=1e-6)


def test_the_axis_does_not_matter():
    one = choice(CUP, BOWL).motion.moved([0.5, 0.5])[0]
    tilted = choice(rotated(CUP, TILT), rotated(BOWL, TILT)).motion.moved([0.5, 0.5])[0]
    wanted = rotated(one.mesh, TILT)
    assert tilted.finder.find_about(wanted.vertices).distances.max() < 0.02


def test_less_coherence_moves_part_of_the_way():
    one, other = PYRAMIDS
    cone = choice(one, other.moved((1.0, 0.0, 0.0)), coherence=0.25).motion.moved([0.5, 0.5])[0]
    assert cone.mesh.bounds[:, 0].mean() == pytest.approx(0.5 * 0.5 * 1.0, abs=0.01)


def test_sections_must_have_equal_numbers_of_regions():
    request = MotionRequest([CONE, torus()], ["one", "other"], [(0, 1)], "automatic", 0.5)
    assert revolved_motion(request, UNINTERRUPTED) is None


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("turned_around", [False, True])
def test_attached_parts_retract_and_are_in_both_shapes(time, turned_around):
    found = choice(LARGE_CUP, PEGGED) if turned_around else choice(PEGGED, LARGE_CUP)
    assert found.reason == "OUTLINES"
    moved = found.motion.moved([time, 1.0 - time] if turned_around else [1.0 - time, time])
    wall, out = 1.0 + time, PEG.bounds[1, 0] - 0.92
    for own, other in (moved, moved[::-1]):
        assert other.finder.find_about(own.vertices).distances.max() < 0.05 * wall
        # At the height of the peg, whose tip is as wide as ever, the wall is at 0.92 of the radius.
        tip = own.mesh.vertices[own.mesh.vertices[:, 0] > own.mesh.bounds[1, 0] - 0.05]
        assert own.mesh.bounds[1, 0] == pytest.approx(max(wall, 0.92 * wall + (1.0 - time) * out), abs=0.06)
        if time < 0.5:
            assert np.ptp(tip[:, 1]) == pytest.approx(0.2, abs=0.02)


def test_at_rest_an_added_part_is_flat_and_closed():
    moved = choice(PEGGED, LARGE_CUP).motion.moved([0.0, 1.0])[1]
    np.testing.assert_allclose(moved.vertices, moved.rest.vertices, rtol=0.0, atol=1e-6)
    assert moved.mesh.volume == pytest.approx(LARGE_CUP.volume, rel=1e-3)
    assert topology(moved.mesh).closed
    assert moved.mesh.bounds == pytest.approx(LARGE_CUP.bounds, abs=0.01)
    assert moved.parents.max() < len(LARGE_CUP.faces)


def test_parts_are_added_only_to_shapes_that_are_reached():
    for coherence, pieces in ((0.25, 1), (0.5, 2)):
        moved = choice(PEGGED, LARGE_CUP, coherence=coherence).motion.moved([0.01, 0.99])[1]
        assert piece_count(moved.mesh) == pieces


def bulging(mesh, height):
    """A shape with a flat bulge on the side +x, over about 100 degrees."""
    angles = np.degrees(np.arctan2(mesh.vertices[:, 1], mesh.vertices[:, 0]))
    shares = ((70.0 - np.abs(angles)) / 25.0).clip(0.0, 1.0)
    radii = np.hypot(*mesh.vertices[:, :2].T)
    factors = 1.0 + height * shares**2 * (3.0 - 2.0 * shares) / np.maximum(radii, 0.2)
    return TriangleMesh(mesh.vertices * np.column_stack([factors, factors, np.ones_like(factors)]), mesh.faces)


@pytest.mark.parametrize("second", [0, 1])
def test_a_bulge_is_no_attached_part(second):
    """It would crumple while it retracts."""
    shapes = (bulging(PIN, 0.05), CONE)[:: -1 if second else 1]
    assert common_revolved_bodies(shapes) is not None
    assert revolved_motion(pair(*shapes), UNINTERRUPTED) is None


def stemmed(lean):
    """A ball with a stem whose upper end leans away from the axis."""
    arc = np.radians(np.linspace(-90.0, 73.0, 30))
    stem = [(0.29, 0.98), (0.15, 1.0), (0.15, 1.25), (0.15, 1.5), (0.15, 1.75), (0.0, 1.75)]
    ball = revolved([*np.column_stack([np.cos(arc), np.sin(arc)]), *stem])
    heights = (ball.vertices[:, 2] - 1.0).clip(0.0)
    return TriangleMesh(ball.vertices + np.outer(lean * heights, (1.0, 0.0, 0.0)), ball.faces)


def test_a_stem_that_leans_is_no_attached_part():
    """It would retract while that of the other shape grows."""
    assert revolved_motion(pair(stemmed(0.0), CONE), UNINTERRUPTED) is not None
    leaning = pair(stemmed(0.4), CONE)
    assert not common_revolved_bodies(leaning.shapes)[1][0].is_whole
    assert revolved_motion(leaning, UNINTERRUPTED) is None


def test_a_handle_over_the_axis_retracts():
    """It stands on both sides of the axis."""
    solid = revolved([(0.0, 0.0), (1.0, 0.0), (1.0, 1.5), (0.0, 1.5)])
    ring = rotated(torus(0.6, 0.08), (np.pi / 2.0, 0.0, 0.0)).moved((0.0, 0.0, 1.5))
    found = revolved_motion(pair(joined(solid, ring), CONE), UNINTERRUPTED)
    assert found.reason == "OUTLINES"


def test_two_handles_are_left_to_the_map():
    assert revolved_motion(pair(PEGGED, PEGGED), UNINTERRUPTED) is None


def test_of_two_handles_one_retracts_while_the_other_grows():
    """Where the map would take them into the body on the way."""
    peg, other_peg = box((0.64, 0.2, 0.2), (1.23, 0.0, 0.9)), box((0.84, 0.4, 0.4), (-2.24, 0.0, 1.8))
    shapes = [joined(CUP, peg), joined(LARGE_CUP, other_peg)]
    motion = motion_with_parts(pair(*shapes), known_motion(shapes), UNINTERRUPTED).motion
    # At the height of the pegs, the wall is at 0.92 of the radius.
    reaches = np.array([peg.bounds[1, 0] - 0.92, -other_peg.bounds[0, 0] - 1.84])
    for time in TIMES:
        moved, wall = motion.moved([1.0 - time, time]), 1.0 + time
        ends = np.maximum(wall, 0.92 * wall + [1.0 - time, time] * reaches)
        for own, other in (moved, moved[::-1]):
            assert (own.mesh.bounds[1, 0], -own.mesh.bounds[0, 0]) == pytest.approx(ends, abs=0.06)
            assert other.finder.find_about(own.vertices).distances.max() < 0.05 * wall


def test_a_handle_that_becomes_another_one_follows_the_map():
    """Up the wall, where sections alone would not take it."""
    peg, other_peg = box((0.64, 0.2, 0.2), (1.23, 0.0, 0.9)), box((0.84, 0.4, 0.4), (2.32, 0.0, 2.4))
    shapes = [joined(CUP, peg), joined(LARGE_CUP, other_peg)]
    motion = motion_with_parts(pair(*shapes), known_motion(shapes), UNINTERRUPTED).motion
    for time in TIMES:
        moved = motion.moved([1.0 - time, time])
        out, _, top = (1.0 - time) * peg.bounds[1] + time * other_peg.bounds[1]
        for own, other in (moved, moved[::-1]):
            assert own.mesh.bounds[1, 0] == pytest.approx(out, abs=0.1)
            assert own.vertices[own.vertices[:, 0] > out - 0.2, 2].max() == pytest.approx(top, abs=0.1)
            # Their feet are drawn to where they begin on the wall.
            assert other.finder.find_about(own.vertices).distances.max() < 0.1 * (1.0 + time)


def test_a_handle_follows_the_map_around_the_body():
    """Evenly, although the map turns the bodies, which stay as they are."""
    one = joined(CUP, box((0.64, 0.2, 0.2), (1.23, 0.0, 0.9)))
    shapes = [one, rotated(one, (0.0, 0.0, 0.6))]
    motion = motion_with_parts(pair(*shapes), known_motion(shapes), UNINTERRUPTED).motion
    for time in (0.01, 0.25, 0.75):
        for own in motion.moved([1.0 - time, time]):
            tip = own.vertices[np.hypot(*own.vertices[:, :2].T) > 1.5].mean(axis=0)
            assert np.arctan2(tip[1], tip[0]) == pytest.approx(0.6 * time, abs=0.02)


def test_one_handle_needs_no_map():
    assert motion_with_parts(pair(PEGGED, LARGE_CUP), known_motion([CUP, CUP]), UNINTERRUPTED) is None


def test_the_user_may_ask_for_it():
    assert choice(*PYRAMIDS, kind="guided").reason == "ASKED"
