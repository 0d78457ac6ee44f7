# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that consist of overlapping bodies move as if they were one body."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.motions.choosing import chosen_motion
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.applications.motions.skinned_motion import SkinnedMotion, following, with_skins
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.applications.maps import coarse_maps
from tests.shapes import ball, box, joined, renumbered, rotated

TRUNK = box((0.8, 0.5, 1.6))
HEAD = ball(0.35, (0.0, 0.0, 1.0), points=300)
LEGS = [box((0.28, 0.28, 1.2), (x, 0.0, -1.3)) for x in (-0.22, 0.22)]
LENGTH = 1.5
ARM = box((0.22, 0.22, LENGTH), (0.0, 0.0, -0.5 * LENGTH + 0.1))
SHOULDER = np.array([0.5, 0.0, 0.65])


def figure(angle):
    """A figure of six bodies; one arm is raised by an angle."""
    other = ARM.moved(SHOULDER * (-1.0, 1.0, 1.0))
    return joined(TRUNK, HEAD, *LEGS, other, rotated(ARM, (0.0, -angle, 0.0)).moved(SHOULDER))


def choice(*shapes, guides=(), kind="automatic"):
    request = MotionRequest(shapes, ["one", "other"], [(0, 1)], kind, 0.5, guides)
    with coarse_maps():
        return drained(chosen_motion(request, UNINTERRUPTED))


@pytest.fixture(scope="module")
def raised():
    return choice(figure(0.1), renumbered(figure(1.6)))


def test_it_is_mapped_well(raised):
    assert (raised.kind, raised.reason) == ("guided", "FITS")
    assert isinstance(raised.motion, SkinnedMotion)


def test_the_arm_swings_without_losing_its_length(raised):
    arm = slice(-8, None)
    first = figure(0.1).vertices[arm]
    for time in (0.3, 0.5, 0.7):
        moved = raised.motion.moved([1.0 - time, time])[0].vertices[: len(figure(0.1).vertices)][arm]
        top, bottom = (moved[first[:, 2] > 0.2].mean(axis=0), moved[first[:, 2] < 0.2].mean(axis=0))
        assert np.linalg.norm(top - bottom) == pytest.approx(LENGTH, rel=0.06)
        angle = np.arctan2(bottom[0] - top[0], top[2] - bottom[2])
        assert angle == pytest.approx(0.1 + 1.5 * time, abs=0.15)


def test_a_shape_alone_is_unchanged(raised):
    one, none = raised.motion.moved([1.0, 0.0])
    assert none is None
    assert one.vertices == pytest.approx(one.rest.vertices, abs=1e-9)
    assert one.vertices[: len(figure(0.1).vertices)] == pytest.approx(figure(0.1).vertices)


def test_inner_vertices_stay_inside(raised):
    """Tops of the legs are within the trunk."""
    moved = raised.motion.moved([0.5, 0.5])[0].vertices
    low, high = moved[:8].min(axis=0), moved[:8].max(axis=0)
    begin = 8 + len(HEAD.vertices)
    tops = moved[begin : begin + 16]
    tops = tops[figure(0.1).vertices[begin : begin + 16, 2] > -1.0]
    assert len(tops) == 8
    assert (tops[:, 2] > low[2] - 0.02).all()
    assert (tops[:, 2] < high[2]).all()


def test_guides_refer_to_the_shape():
    one, other = figure(0.1), figure(1.6)
    lowest = len(one.vertices) - 8
    guides = [{0: lowest, 1: lowest}, {0: 8, 1: 8}]
    skinned = with_skins(MotionRequest((one, other), ["one", "other"], [(0, 1)], "guided", 0.5, guides), UNINTERRUPTED)
    for guide, on_skins in zip(guides, skinned.guides, strict=True):
        for shape, skin, vertex, place in zip(
            (one, other), skinned.shapes, guide.values(), on_skins.values(), strict=True
        ):
            assert np.linalg.norm(skin.vertices[place] - shape.vertices[vertex]) < 0.04
    found = choice(one, other, guides=guides, kind="guided")
    assert found.guides_left_out == 0
    assert found.score > 0.8


def test_shapes_of_one_body_have_no_skin():
    mesh = ball(points=400)
    shapes = mesh, mesh.moved((1.0, 0.0, 0.0))
    request = MotionRequest(shapes, ["one", "other"], [(0, 1)], "guided", 0.5)
    assert with_skins(request, UNINTERRUPTED) is request
    motion = object()
    assert following(motion, shapes, shapes) is motion
