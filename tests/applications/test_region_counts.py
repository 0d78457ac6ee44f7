# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes of different numbers of regions: pieces have their shares of the area, and the rest grows from points."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.outlines.outline_motion import outline_motion
from convwass_addon.applications.outlines.outline_pairs import vanishing_share
from convwass_addon.applications.outlines.outlined_shape import OutlinedShape
from convwass_addon.applications.outlines.region_counts import with_equal_counts
from convwass_addon.geometry.plane.closed_curves import boundary_of
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.plane.ring_nesting import outline_of
from convwass_addon.progress import UNINTERRUPTED
from tests.flat_shapes import ellipse, rectangle

TIMES = (0.2, 0.5, 0.8)
# Larger than any share: all regions but the largest one grow.
GROWING = 1.0


def shape(*rings):
    return OutlinedShape.of(filled_boundary(list(rings), "even-odd"))


def areas(own):
    """The areas of the regions that are not points, largest first."""
    found = [boundary_of(own.rim(region)).area for region in own.regions if not region.is_point]
    return sorted(found, reverse=True)


def moved(first, second, *times):
    """Each of the times with both shapes at that moment of their motion, which is solved once for all of them."""
    motion = outline_motion([first.filled, second.filled], ["one", "other"], [(0, 1)], GuidedSettings(), UNINTERRUPTED)
    for time in times:
        shapes = motion.choice.motion.moved([1.0 - time, time])
        yield time, [sheet.moved(own) for sheet, own in zip(motion.sheets, shapes, strict=True)]


def regions(boundary):
    """Its regions from left to right."""
    outlines = [filled_boundary([region.outer], "non-zero") for region in outline_of(boundary).regions]
    return sorted(outlines, key=lambda own: own.center[0])


def test_a_region_is_divided_in_proportion_to_the_areas_of_the_others():
    square, others = shape(rectangle((0, 0), (4, 4))), [rectangle((0, 1), (1, 3)), rectangle((2, -1), (3, 5))]
    divided, same = with_equal_counts([square, shape(*others)], [(0, 1)], 0.0)
    assert areas(divided) == pytest.approx([12.0, 4.0], rel=0.005)
    left = min((boundary_of(divided.rim(region)) for region in divided.regions), key=lambda own: own.area)
    assert np.concatenate(left.bounds) == pytest.approx([0, 0, 1, 4], abs=0.01)
    assert len(same.curves) == 2


def test_small_regions_grow_from_points_in_their_places():
    disc = shape(ellipse())
    dotted = shape(ellipse(), ellipse((0, 1.5), (0.1, 0.1)), ellipse((0, -1.5), (0.1, 0.1)))
    grown, same = with_equal_counts([disc, dotted], [(0, 1)], 0.1)
    assert areas(grown) == pytest.approx(areas(disc))
    assert vanishing_share(grown, same) == pytest.approx(0.02 / 1.02, rel=0.01)
    assert vanishing_share(same, grown) == vanishing_share(grown, same)
    points = [grown.curves[region.outer].points for region in grown.regions if region.is_point]
    assert sorted(own.mean(axis=0)[1] for own in points) == pytest.approx([-1.5, 1.5], abs=1e-6)
    assert max(np.ptp(own, axis=0).max() for own in points) < 0.02


def test_every_region_has_a_counterpart():
    """Of three discs, the two on the left belong to the left one of two."""
    pair = shape(ellipse((0, 0)), ellipse((10, 0)))
    three = shape(ellipse((-1, 0), (0.5, 0.5)), ellipse((1, 0), (0.5, 0.5)), ellipse((9, 0), (0.5, 0.5)))
    divided, _ = with_equal_counts([pair, three], [(0, 1)], 0.0)
    centers = sorted(boundary_of(divided.rim(region)).center[0] for region in divided.regions)
    assert areas(divided) == pytest.approx(np.pi * np.array([1.0, 0.5, 0.5]), rel=0.005)
    assert centers == pytest.approx([-4 / (3 * np.pi), 4 / (3 * np.pi), 10.0], abs=0.01)


def test_a_dot_divides_within_a_frame_of_the_same_center():
    """The dots of a die belong to the dot, and not to the frame around it."""
    frame = rectangle((-3, -3), (3, 3)), rectangle((-2.5, -2.5), (2.5, 2.5))
    six = [ellipse((x, y), (0.4, 0.4)) for x in (-1, 1) for y in (-1.5, 0, 1.5)]
    divided, _ = with_equal_counts([shape(*frame, ellipse(radii=(0.4, 0.4))), shape(*frame, *six)], [(0, 1)], 0.1)
    assert areas(divided) == pytest.approx([36.0 - 25.0, *[np.pi * 0.4**2 / 6.0] * 6], rel=0.02)


def test_a_region_that_a_cut_would_tear_is_left_whole():
    """The upper half of a U is two pieces."""
    u = np.array([(0, 0), (3, 0), (3, 4), (2, 4), (2, 1), (1, 1), (1, 4), (0, 4)], dtype=np.float64)
    grown, _ = with_equal_counts([shape(u), shape(ellipse((0, 0)), ellipse((0, 4)))], [(0, 1)], 0.0)
    assert areas(grown) == pytest.approx([9.0])
    assert [region.is_point for region in grown.regions] == [False, True]


@pytest.mark.parametrize("counts", [(1, 2, 4), (4, 1, 2), (1, 3, 1)])
def test_all_shapes_of_a_triangle_get_equal_counts(counts):
    """With at most as many regions as the shape that has most, and all of their areas."""
    shapes = [shape(*(ellipse((3.0 * place, 0.0)) for place in range(count))) for count in counts]
    found = with_equal_counts(shapes, [(0, 1), (1, 2), (0, 2)], 0.1)
    assert {len(own.regions) for own in found} == {max(counts)}
    for own, before in zip(found, shapes, strict=True):
        assert sum(areas(own)) == pytest.approx(before.filled.area, rel=0.006)


def test_a_bar_divides_into_two():
    """Both halves keep their form, and the gap between them opens evenly."""
    bar, halves = shape(rectangle((-2, 0), (2, 1))), shape(rectangle((-3, 0), (-1, 1)), rectangle((1, 0), (3, 1)))
    for time, shapes in moved(bar, halves, *TIMES):
        for own in shapes:
            left, right = regions(own)
            assert np.concatenate(left.bounds) == pytest.approx([-2 - time, 0, -time, 1], abs=0.02)
            assert np.concatenate(right.bounds) == pytest.approx([time, 0, 2 + time, 1], abs=0.02)


def test_a_dot_grows_evenly():
    """Its diameter is a share of that which it will have, also within the hole of a ring that opens from a point."""
    disc, eye = shape(ellipse()), shape(ellipse(), ellipse(radii=(0.4, 0.4)), ellipse(radii=(0.2, 0.2)))
    for time, shapes in moved(disc, eye, *TIMES):
        for own in shapes:
            _, dot = sorted(regions(own), key=lambda region: -region.area)
            assert np.sqrt(dot.area / np.pi) == pytest.approx(0.2 * time, abs=0.006)
            assert dot.center == pytest.approx((0, 0), abs=0.01)


def test_division_backward_is_division_in_reverse():
    bar, halves = shape(rectangle((-2, 0), (2, 1))), shape(ellipse((-2, 0.5)), ellipse((2, 0.5)))
    forth, reverse = moved(bar, halves, *TIMES), moved(halves, bar, *TIMES[::-1])
    for (_, (there, _)), (_, (_, back)) in zip(forth, reverse, strict=True):
        for one, other in zip(regions(there), regions(back), strict=True):
            assert one.area == pytest.approx(other.area, rel=0.01)
            assert one.center == pytest.approx(other.center, abs=0.02)
