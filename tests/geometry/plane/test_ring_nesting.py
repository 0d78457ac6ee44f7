# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Assembly and nesting of rings, and cuts that connect them."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.outlines import FlatRegion, ring_area
from convwass_addon.geometry.plane.planar_fill import Boundary, filled_boundary
from convwass_addon.geometry.plane.ring_nesting import boundary_rings, is_within, keyholed, outline_of, without_slivers
from tests.flat_shapes import ellipse, rectangle


def test_holes_belong_to_the_smallest_region_around_them():
    rings = [ellipse(radii=(4, 4)), ellipse(radii=(3, 3)), ellipse(radii=(2, 2)), ellipse(radii=(1, 1))]
    outline = outline_of(filled_boundary([*rings, ellipse((9, 0))], "even-odd"))
    assert [len(region.holes) for region in outline.regions] == [1, 1, 0]
    areas = [ring_area(region.outer) + sum(map(ring_area, region.holes)) for region in outline.regions]
    np.testing.assert_allclose(areas, np.pi * np.array([7, 3, 1]), rtol=1e-6)


def test_crossing_rings_become_one():
    outline = outline_of(filled_boundary([rectangle((0, 0), (2, 2)), rectangle((1, 1), (3, 3))], "non-zero"))
    assert [len(region.rings) for region in outline.regions] == [1]
    assert outline.area == pytest.approx(7.0)


def test_slivers_are_dropped():
    rings = [rectangle((0, 0), (2, 2)), rectangle((0.5, 0.5), (1, 1)), rectangle((1.5, 0.5), (1.501, 0.6))]
    boundary = filled_boundary([*rings, rectangle((3, 0), (3.001, 0.1))], "even-odd")
    outline = outline_of(without_slivers(boundary, 1e-4))
    assert [len(region.holes) for region in outline.regions] == [1]
    assert outline.area == pytest.approx(3.75, rel=1e-6)
    assert len(outline_of(without_slivers(boundary, 1e-6)).regions) == 2


@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_a_region_with_cuts_fills_the_same_area_as_with_holes(count):
    outer = ellipse(radii=(6, 4))
    angles = 2 * np.pi * np.arange(count) / max(count, 1)
    holes = tuple(ellipse((3 * np.cos(a), 2 * np.sin(a)), (0.7, 0.7))[::-1] for a in angles)
    ring = keyholed(FlatRegion(outer, holes))
    assert len(ring) == len(outer) + sum(len(hole) + 2 for hole in holes)
    expected = filled_boundary([outer, *holes], "non-zero")
    for rule in ("non-zero", "even-odd"):
        found = filled_boundary([ring], rule)
        assert found.area == pytest.approx(expected.area, rel=1e-6)
        np.testing.assert_allclose(found.center, expected.center, atol=1e-6)


def test_points_inside_a_ring_are_recognized():
    ring = ellipse(radii=(2, 1))
    assert is_within(np.array([1.9, 0.1]), ring)
    assert not is_within(np.array([1.9, 0.9]), ring)


def test_a_boundary_consists_of_rings():
    rings = [rectangle((0, 0), (4, 4)), rectangle((1, 1), (2, 2))[::-1], rectangle((6, 0), (7, 1))]
    found = boundary_rings(filled_boundary(rings, "non-zero"))
    assert sorted(map(ring_area, found)) == pytest.approx([-1.0, 1.0, 16.0])
    assert Boundary.of_rings(found).area == pytest.approx(16.0)


@pytest.mark.parametrize("angle", np.radians([0.0, 90.0, 180.0, 270.0]))
def test_regions_that_touch_at_a_corner_have_their_own_rings(angle):
    """Also if a ring begins there."""
    c, s = np.cos(angle), np.sin(angle)
    rings = (
        np.array(ring) @ np.array([[c, s], [-s, c]]) for ring in ([(0, 0), (2, -2), (2, -1)], [(0, 0), (2, 1), (3, 3)])
    )
    found = boundary_rings(filled_boundary(list(rings), "non-zero"))
    assert sorted(map(ring_area, found)) == pytest.approx([1.0, 1.5])
