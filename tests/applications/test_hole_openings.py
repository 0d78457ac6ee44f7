# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Holes of flat shapes that are opened to the outside, where the other shape has none."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.outlines.hole_openings import surplus_holes, with_open_holes
from convwass_addon.applications.outlines.outline_motion import outline_motion
from convwass_addon.applications.outlines.outlined_shape import OutlinedShape
from convwass_addon.geometry.plane.closed_curves import ClosedCurve, boundary_of, opened_curve
from convwass_addon.geometry.plane.outlines import ring_area
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.plane.ring_nesting import boundary_rings
from convwass_addon.progress import UNINTERRUPTED
from tests.applications.maps import coarse_outlines
from tests.flat_shapes import ellipse, rectangle

TIMES = (0.2, 0.5, 0.8)
RING = ellipse(), ellipse(radii=(0.7, 0.7))
# Enough where the ring is to move.
COARSE_RING = ellipse(corners=64), ellipse(radii=(0.7, 0.7), corners=64)


@pytest.fixture(scope="module", autouse=True)
def coarse():
    with coarse_outlines():
        yield


def shape(*rings):
    return OutlinedShape.of(filled_boundary(list(rings), "even-odd"))


def arc(begin, end):
    """A part of the ring between two angles in degrees."""
    angles = np.radians(np.linspace(begin, end, 61))
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.concatenate([around, 0.7 * around[::-1]])


def moved(first, second, *times):
    """Each of the times with both shapes at that moment of their motion, which is solved once for all of them."""
    motion = outline_motion([first.filled, second.filled], ["one", "other"], [(0, 1)], GuidedSettings(), UNINTERRUPTED)
    for time in times:
        shapes = motion.choice.motion.moved([1.0 - time, time])
        yield time, [sheet.moved(own) for sheet, own in zip(motion.sheets, shapes, strict=True)]


def test_a_slit_takes_its_area_only():
    outer, hole = ClosedCurve(rectangle((0, 0), (6, 6))), ClosedCurve(rectangle((2, 2), (4, 4))[::-1])
    places = tuple(float(own.nearest(np.array([[place, 3.0]]))[0][0]) for own, place in ((outer, 6.0), (hole, 4.0)))
    opened = opened_curve(outer, hole, places, 0.01)
    assert ring_area(opened.points) == pytest.approx(32.0 - 2.0 * 0.01)
    inside = boundary_of([opened]).contains(np.array([(5.0, 3.0), (5.0, 3.02), (5.0, 2.98), (3.0, 3.0), (1.0, 3.0)]))
    assert inside.tolist() == [False, True, True, False, True]


@pytest.mark.parametrize("angle", [0.0, 90.0, 135.0])
def test_the_slit_is_where_the_other_shape_is_open(angle):
    ring, gap = shape(*RING), shape(arc(angle + 30.0, angle + 330.0))
    assert surplus_holes([ring, gap], [(0, 1)]) == 1
    opened, same = with_open_holes([ring, gap], [(0, 1)])
    assert surplus_holes([opened, same], [(0, 1)]) == 0
    assert same is gap
    (region,) = opened.regions
    filled = boundary_of(opened.rim(region))
    directions = np.radians(np.arange(0.0, 360.0, 45.0))
    middle = 0.85 * np.stack([np.cos(directions), np.sin(directions)], axis=1)
    assert np.degrees(directions[~filled.contains(middle)]).tolist() == pytest.approx([angle])


def test_a_ring_opens_to_an_arc():
    """Its width stays the same, and the gap opens evenly."""
    for time, shapes in moved(shape(*COARSE_RING), shape(arc(30.0, 330.0)), *TIMES):
        for own in shapes:
            rings = boundary_rings(own)
            assert [ring_area(ring) > 0 for ring in rings] == [True]
            radii = np.linalg.norm(own.starts - own.center, axis=1)
            tips = own.starts[(own.starts[:, 0] > 0.5) & (np.abs(own.starts[:, 1]) > 0.0)]
            gap = np.degrees(np.abs(np.arctan2(tips[:, 1], tips[:, 0])).min())
            assert gap == pytest.approx(30.0 * time, abs=5.0)
            assert own.area == pytest.approx(np.pi * 0.51 * (1.0 - time / 6.0), rel=0.03)
            assert radii.max() < 1.2


def test_a_hole_in_the_middle_of_a_disc_is_not_opened():
    for _, shapes in moved(shape(*COARSE_RING), shape(ellipse(corners=64)), *TIMES):
        for own in shapes:
            assert sorted(ring_area(ring) > 0 for ring in boundary_rings(own)) == [False, True]


def test_all_shapes_of_a_path_are_opened():
    ring, gap = shape(*RING), shape(arc(30.0, 330.0))
    opened = with_open_holes([ring, ring, gap], [(0, 1), (1, 2)])
    assert [len(own.regions[0].holes) for own in opened] == [0, 0, 0]


def test_a_slit_that_fails_leaves_the_hole_closed(monkeypatch):
    def failing(*_):
        raise ValueError("no slit")

    ring, gap = shape(*COARSE_RING), shape(arc(30.0, 330.0))
    monkeypatch.setattr("convwass_addon.applications.outlines.matched_motion.with_open_holes", failing)
    for _, shapes in moved(ring, gap, 0.5):
        for own in shapes:
            assert sorted(ring_area(each) > 0 for each in boundary_rings(own)) == [False, True]


def test_a_hole_behind_others_is_opened_through_the_outline_only():
    """A slit never ends at another hole."""
    disc = shape(ellipse(radii=(3, 3)), *(ellipse((x, 0), (0.5, 0.5)) for x in (-1.4, 0.0, 1.4)))
    opened, _ = with_open_holes([disc, shape(ellipse(radii=(3, 3)))], [(0, 1)])
    (region,) = opened.regions
    assert not region.holes
    areas = [ring_area(ring) for ring in boundary_rings(boundary_of(opened.rim(region)))]
    assert areas == [pytest.approx(disc.filled.area, rel=0.02)]
