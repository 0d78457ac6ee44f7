# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that are much more alike once they are turned turn as a whole."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from benchmarks.props import revolved
from convwass_addon.applications.motions.choosing import chosen_motion
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.applications.motions.turned_motion import Turning
from convwass_addon.geometry.meshes.centroid import centroid
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.shapes import ball, box, joined, renumbered, rotated

SIDES = 12
ROD = revolved([(0.0, -2.0), (0.3, -2.0), (0.3, 2.0), (0.0, 2.0)], SIDES)
PIN = revolved([(0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.2, 1.6), (0.2, 2.6), (0.0, 2.6)], SIDES)
CONE = revolved([(0.0, 0.0), (0.5, 0.0), (0.0, 3.0)], SIDES)
ABOUT_Y = np.array([0.0, 1.0, 0.0])
QUARTER = 0.5 * np.pi * ABOUT_Y
LYING = renumbered(rotated(PIN, QUARTER).moved((3.0, 0.0, -1.0)))


def request(*shapes, kind="automatic", coherence=0.5, guides=()):
    pairs = [(one, other) for other in range(len(shapes)) for one in range(other)]
    return MotionRequest(shapes, [str(index) for index in range(len(shapes))], pairs, kind, coherence, guides)


def choice(*shapes, **options):
    return drained(chosen_motion(request(*shapes, **options), UNINTERRUPTED))


@pytest.fixture(scope="module")
def falling():
    """The choice for an upright pin, and one that lies elsewhere."""
    return choice(PIN, LYING)


def placed(rest, share, center):
    """Vertices of a shape after a share of a quarter turn about its center, which has come to another place."""
    return rotated(rest.moved(-centroid(rest)), share * QUARTER).vertices + center


def test_an_upright_pin_turns_to_become_a_lying_one(falling):
    assert (falling.kind, falling.reason, falling.record()["turned"]) == ("guided", "OUTLINES", 90)
    begin, end = centroid(PIN), centroid(LYING)
    for t in (0.1, 0.5, 0.8):
        upright, lying = falling.motion.moved([1.0 - t, t])
        center = (1.0 - t) * begin + t * end
        np.testing.assert_allclose(upright.vertices, placed(upright.rest, t, center), rtol=0.0, atol=1e-3)
        np.testing.assert_allclose(lying.vertices, placed(lying.rest, t - 1.0, center), rtol=0.0, atol=1e-3)


def test_shapes_alone_are_unchanged(falling):
    one, none = falling.motion.moved([1.0, 0.0])
    assert none is None
    assert np.array_equal(one.vertices, one.rest.vertices)
    np.testing.assert_allclose(one.vertices[: len(PIN.vertices)], PIN.vertices, rtol=0.0, atol=1e-12)
    _, other = falling.motion.moved([0.0, 1.0])
    np.testing.assert_allclose(
        other.vertices, falling.motion.moved([1e-9, 1.0 - 1e-9])[1].vertices, rtol=0.0, atol=1e-6
    )


def test_swapped_shapes_move_the_same_way(falling):
    swapped, count = choice(LYING, PIN), len(PIN.vertices)
    for t in (0.2, 0.6):
        one, other = (found.motion.moved(w) for found, w in ((falling, [1.0 - t, t]), (swapped, [t, 1.0 - t])))
        np.testing.assert_allclose(one[0].vertices[:count], other[1].vertices[:count], rtol=0.0, atol=1e-3)


def test_ends_that_correspond_meet():
    """A cone and a pin taper to the same side: each lies on the other's axis, and no shape turns upside down."""
    found = choice(CONE, rotated(PIN, QUARTER))
    assert found.record()["turned"] == 90
    middle = found.motion.moved([0.5, 0.5])
    tip, foot = middle[0].vertices[CONE.vertices[:, 2].argmax()], middle[1].vertices[PIN.vertices[:, 2].argmin()]
    along = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)])
    center = found.motion.centers.mean(axis=0)
    assert (tip - center) @ along > 1.0 and (foot - center) @ along < -0.5


def test_around_a_triangle_the_way_closes():
    rods = [ROD, renumbered(rotated(ROD, QUARTER)), rotated(ROD, 0.5 * np.pi * np.array([1.0, 0.0, 0.0]))]
    found = choice(*rods)
    corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    assert found.record()["turned"] in range(90, 121)
    places = [
        found.motion.moved((1.0 - t) * np.array(begin) + t * np.array(end))
        for begin, end in pairwise(corners)
        for t in (1e-6, 0.5, 1.0 - 1e-6)
    ]
    np.testing.assert_allclose(places[0][0].vertices, places[-1][0].vertices, rtol=0.0, atol=1e-4)
    # No jump at a corner, where another shape fades out.
    for before, after, shape in ((2, 3, 1), (5, 6, 2)):
        np.testing.assert_allclose(places[before][shape].vertices, places[after][shape].vertices, rtol=0.0, atol=1e-4)
    between = found.motion.moved([0.3, 0.3, 0.4])
    for shape in between:
        assert shape.mesh.volume == pytest.approx(ROD.volume, rel=1e-3)


def test_with_half_the_way_shapes_turn_half_as_far():
    upright, lying = choice(PIN, LYING, coherence=0.25).motion.moved([0.5, 0.5])
    begin, end = centroid(PIN), centroid(LYING)
    np.testing.assert_allclose(
        upright.vertices, placed(upright.rest, 0.25, 0.75 * begin + 0.25 * end), rtol=0.0, atol=1e-3
    )
    np.testing.assert_allclose(
        lying.vertices, placed(lying.rest, -0.25, 0.25 * begin + 0.75 * end), rtol=0.0, atol=1e-3
    )


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (ROD, ball(points=300)),
        (box((1.0, 1.0, 1.0)), rotated(box((1.0, 1.0, 1.05)), QUARTER)),
        (ROD, ROD.moved((1.0, 0.0, 0.0))),
        (ROD, joined(rotated(ROD, QUARTER), box((0.3, 0.3, 1.0), (1.0, 0.0, 0.5)))),
    ],
    ids=["a ball has no axis", "nearly a cube", "as it stands", "a limb"],
)
def test_others_do_not_turn(one, other):
    assert Turning.of(request(one, other), UNINTERRUPTED) is None
