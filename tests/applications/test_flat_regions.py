# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of one color in flat blends with known regions."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatShape
from convwass_addon.applications.morphs.layouts import path_blends, single_blend
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from tests.flat_shapes import ellipse, rectangle

SETTINGS = FlatSettings(resolution=128, motion="transport")
RED, GREEN, BLUE, WHITE = np.array([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1], [1, 1, 1, 1]], dtype=float)


def shape(*colored):
    return FlatShape(tuple(ring for ring, _ in colored), colors=np.stack([color for _, color in colored]))


def frames_of(shapes, blends, settings=SETTINGS):
    names = [f"shape {index}" for index in range(len(shapes))]
    return [step.payload for step in flat_morph(shapes, names, blends, settings) if step.payload is not None]


def center(outline):
    return filled_boundary(list(outline.rings), "non-zero").center


def test_halves_stay_halves_and_each_mixes_with_the_other_shape():
    two = shape((rectangle((0, 0), (1, 2)), RED), (rectangle((1, 0), (2, 2)), BLUE))
    plain = shape((rectangle((10, 0), (12, 2)), WHITE))
    (frame,) = frames_of([two, plain], single_blend([3, 1], 2))
    left, right = sorted(frame.regions, key=lambda region: center(region.outline)[0])
    np.testing.assert_allclose([left.color, right.color], [[1, 0.25, 0.25, 1], [0.25, 0.25, 1, 1]])
    for region, x in ((left, 3.0), (right, 4.0)):
        assert region.outline.area == pytest.approx(2.0, rel=3e-2)
        np.testing.assert_allclose(center(region.outline), (x, 1.0), atol=0.03)
        assert (len(region.outline.regions), region.outline.holes) == (1, 0)


def test_layers_of_both_shapes_cross():
    upright = shape((rectangle((0, 0), (1, 2)), RED), (rectangle((1, 0), (2, 2)), GREEN))
    lying = shape((rectangle((0, 0), (2, 1)), BLUE), (rectangle((0, 1), (2, 2)), WHITE))
    (frame,) = frames_of([upright, lying], single_blend([1, 1], 2))
    assert len(frame.regions) == 4
    for region in frame.regions:
        x, y = center(region.outline)
        expected = 0.5 * (RED if x < 1 else GREEN) + 0.5 * (BLUE if y < 1 else WHITE)
        np.testing.assert_allclose(region.color, expected)
        np.testing.assert_allclose(np.abs([x - 1, y - 1]), 0.5, atol=0.03)


def test_later_layers_cover_earlier_ones():
    target = shape((ellipse(radii=(2, 2)), RED), (ellipse(radii=(1, 1)), WHITE))
    plain = shape((ellipse((6, 0), (2, 2)), BLUE))
    (frame,) = frames_of([target, plain], single_blend([1, 1], 2))
    large, small = frame.regions
    np.testing.assert_allclose([large.color, small.color], [[0.5, 0, 0.5, 1], [0.5, 0.5, 1, 1]])
    assert [large.outline.holes, small.outline.holes] == [1, 0]
    assert small.outline.area == pytest.approx(np.pi, rel=0.08)
    assert large.outline.area + small.outline.area == pytest.approx(frame.outline.area, rel=0.02)


def test_regions_leave_no_gap_between_them():
    two = shape((ellipse((0, 0)), RED), (ellipse((1, 0)), GREEN), (ellipse((0.5, 0.8)), BLUE))
    other = shape((rectangle((0, 0), (3, 1)), RED), (rectangle((1, 0), (2, 1)), WHITE))
    for frame in frames_of([two, other], path_blends(2, 4))[1:-1]:
        united = filled_boundary([ring for region in frame.regions for ring in region.outline.rings], "non-zero")
        assert united.area == pytest.approx(frame.outline.area, rel=5e-3)
        summed = sum(region.outline.area for region in frame.regions)
        assert summed == pytest.approx(frame.outline.area, rel=0.08)
        assert summed > united.area


@pytest.mark.parametrize("colors", [(RED, RED), (RED, BLUE)])
def test_shapes_of_one_color_are_not_divided(colors):
    shapes = [shape((ellipse((4 * index, 0)), color)) for index, color in enumerate(colors)]
    (frame,) = frames_of(shapes, single_blend([1, 1], 2))
    assert frame.regions == ()


def test_without_colors_there_are_no_regions():
    two = shape((rectangle((0, 0), (1, 2)), RED), (rectangle((1, 0), (2, 2)), BLUE))
    (frame,) = frames_of(
        [two, two], single_blend([1, 1], 2), FlatSettings(resolution=128, motion="transport", carry=False)
    )
    assert frame.regions == ()
