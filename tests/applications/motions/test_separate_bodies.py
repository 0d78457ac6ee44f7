# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes whose bodies lie apart: every body moves as it would alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from convwass_addon.applications.motions import choosing
from convwass_addon.applications.motions.choosing import chosen_motion
from convwass_addon.applications.motions.motion_choice import MotionChoice
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.applications.motions.separate_bodies import SeparateBodies
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.shapes import box, joined, renumbered

ASIDE = np.array([6.0, 1.0, 0.0])
PAIRS = (
    (box((1.0, 2.0, 0.2)), box((1.2, 1.6, 0.3))),
    (box((1.0, 1.0, 0.4)).moved(ASIDE), box((1.4, 1.0, 0.4)).moved(ASIDE)),
)
# The bodies are in a different order in both shapes.
SHAPES = joined(PAIRS[0][0], PAIRS[1][0]), joined(PAIRS[1][1], PAIRS[0][1])


def request(*shapes, kind="automatic", guides=()):
    names = [f"shape {number}" for number in range(len(shapes))]
    pairs = [(one, other) for other in range(len(shapes)) for one in range(other)]
    return MotionRequest(shapes, names, pairs, kind, 0.5, guides)


def chosen(*shapes, **about):
    return drained(chosen_motion(request(*shapes, **about), UNINTERRUPTED))


@pytest.fixture(scope="module")
def both():
    """The choice for two shapes of two bodies."""
    return chosen(*SHAPES)


def test_every_body_moves_as_it_would_alone(both):
    assert both.record() == {"kind": "guided", "reason": "OUTLINES", "bodies": 2}
    alone = [chosen(*pair).motion for pair in PAIRS]
    for time in (0.0, 0.3, 1.0):
        weights = [1.0 - time, time]
        for shape, *bodies in zip(
            both.motion.moved(weights), *(motion.moved(weights) for motion in alone), strict=True
        ):
            if shape is None:
                assert bodies == [None, None]
                continue
            np.testing.assert_allclose(shape.vertices, np.concatenate([body.vertices for body in bodies]), atol=1e-9)
            assert shape.mesh.volume == pytest.approx(sum(body.mesh.volume for body in bodies))


def test_triangles_know_those_of_the_shape(both):
    for shape, own in zip(SHAPES, both.motion.moved([0.5, 0.5]), strict=True):
        normals, corners = np.cross(*np.diff(shape.corners, axis=1).transpose(1, 0, 2))[own.parents], shape.corners
        beside = own.rest.corners - corners[own.parents][:, :1]
        # All corners of a triangle lie in the plane of the one that it is part of.
        away = np.einsum("mkd,md->mk", beside, normals) / np.linalg.norm(normals, axis=1)[:, None]
        assert np.abs(away).max() < 1e-6


def cube(place, size=1.0):
    """A cube on the x axis."""
    return box((size, size, size), (place, 0.0, 0.0))


def test_bodies_belong_together_by_place_and_size():
    """Whatever their order, and however large the shapes are."""
    one, other = joined(cube(0.0), cube(4.0, 1.5)), joined(cube(14.0, 1.6), cube(10.0))
    large = TriangleMesh(5.0 * other.vertices, other.faces)
    found = SeparateBodies.of(request(one, other, large))
    volumes = [[body.volume for body in own.shapes] for own in found.requests]
    assert volumes == [pytest.approx([1.0, 1.0, 5.0**3]), pytest.approx([1.5**3, 1.6**3, 8.0**3])]


PAIR = joined(cube(0.0), cube(2.0))
# The last triangle has no area, and its vertex no other triangle.
DEGENERATE = TriangleMesh(np.concatenate([PAIR.vertices, np.ones((1, 3))]), np.append(PAIR.faces, [[16] * 3], axis=0))


@pytest.mark.parametrize(
    "other",
    [
        cube(0.0),
        joined(cube(0.0), cube(1.0)),
        joined(*map(cube, (0.0, 2.0, 4.0))),
        joined(cube(0.0), cube(2.0, 0.4)),
        DEGENERATE,
    ],
    ids=["one body", "bodies that touch", "more bodies", "a small body", "a triangle without area"],
)
def test_other_shapes_are_not_divided(other):
    assert SeparateBodies.of(request(PAIR, PAIR)) is not None
    assert SeparateBodies.of(request(PAIR, other)) is None


def test_shapes_of_very_many_bodies_are_not_divided():
    many = joined(*(cube(2.0 * place) for place in range(7)))
    assert SeparateBodies.of(request(many, many)) is None


def test_bodies_within_the_box_of_others_belong_to_them():
    """A cube between two arms at a right angle, and two such arms beside them."""
    corner = joined(box((4.0, 0.2, 0.2)), box((0.2, 4.0, 0.2), (1.9, 2.0, 0.0)))
    one = joined(corner, cube(0.0, 0.8).moved((0.0, 2.0, 0.0)), corner.moved((6.0, 0.0, 0.0)))
    found = SeparateBodies.of(request(one, one))
    assert sorted(len(own.shapes[0].faces) for own in found.requests) == [24, 36]


@pytest.mark.parametrize("about", [{"kind": "guided"}, {"guides": [{0: 0, 1: 0}]}])
def test_only_automatic_motions_without_guides_are_divided(monkeypatch, about):
    asked = []
    monkeypatch.setattr(choosing.SeparateBodies, "of", asked.append)
    monkeypatch.setattr(choosing, "_by_bodies", whole_for([]))
    monkeypatch.setattr(choosing, "_by_outlines", lambda own, control: None)
    chosen(PAIR, renumbered(PAIR), **about)
    assert not asked
    chosen(PAIR, renumbered(PAIR))
    assert len(asked) == 1


WHOLE = MotionChoice("warp", "APART")


def whole_for(asked):
    """Return what chooses a warp for every request, and notes the number of triangles."""

    def by_bodies(own, control):
        asked.append(len(own.shapes[0].faces))
        return WHOLE
        yield

    return by_bodies


def test_shapes_move_as_a_whole_if_a_body_is_not_guided(monkeypatch):
    asked = []
    monkeypatch.setattr(choosing, "_by_bodies", whole_for(asked))
    monkeypatch.setattr(choosing, "is_compact", lambda mesh: False)
    monkeypatch.setattr(choosing, "_by_outlines", lambda own, control: None)
    monkeypatch.setattr(choosing.Turning, "of", lambda own, control: None)
    assert chosen(PAIR, renumbered(PAIR.moved((0.0, 1.0, 0.0)))) is WHOLE
    assert asked == [12, 24]


def test_bodies_without_limbs_move_together(monkeypatch):
    """A warp would be computed for each of them."""
    asked = []
    monkeypatch.setattr(choosing, "_by_bodies", whole_for(asked))
    monkeypatch.setattr(choosing, "_by_outlines", lambda own, control: None)
    assert chosen(PAIR, renumbered(PAIR.moved((0.0, 1.0, 0.0)))) is WHOLE
    assert asked == [24]


def test_limbs_of_all_bodies_count():
    """Those that retract along themselves, as the strokes of solid letters."""
    apart = SeparateBodies.of(request(*SHAPES))
    alone = [chosen(*pair) for pair in PAIRS]
    found = apart.joined([replace(own, limbs=limbs) for own, limbs in zip(alone, (1, 2), strict=True)])
    assert (found.bodies, found.limbs) == (2, 3)
