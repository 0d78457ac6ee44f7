# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Filled areas cut along straight lines: the shares are exact, and both sides together are the whole."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.line_cuts import cut_at_share
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.plane.ring_nesting import outline_of
from tests.flat_shapes import ellipse, rectangle

SHAPES = {
    "ring": [ellipse(), ellipse(radii=(0.5, 0.5))],
    "steps": [np.array([(0, 0), (3, 0), (3, 1), (2, 1), (2, 2), (1, 2), (1, 3), (0, 3)], dtype=np.float64)],
    "comb": [rectangle((x, 0), (x + 0.5, 2)) for x in range(4)],
}


@pytest.mark.parametrize("share", [0.1, 0.5, 0.8])
@pytest.mark.parametrize("normal", [(1.0, 0.0), (0.0, -2.0), (0.3, 0.7)])
@pytest.mark.parametrize("shape", SHAPES)
def test_both_sides_have_their_shares_and_are_the_whole(shape, normal, share):
    whole = filled_boundary(SHAPES[shape], "even-odd")
    behind, beyond = cut_at_share(whole, np.array(normal), share)
    assert behind.area == pytest.approx(share * whole.area, rel=1e-6)
    assert beyond.area == pytest.approx((1.0 - share) * whole.area, rel=1e-6)
    heights = [own.starts @ normal for own in (behind, beyond)]
    assert heights[0].max() <= heights[1].min() + 1e-6
    joined = behind.united([beyond])
    assert joined.area == pytest.approx(whole.area, rel=1e-6)
    assert len(outline_of(joined).regions) == len(outline_of(whole).regions)


def test_a_line_through_corners_leaves_no_slivers():
    diamond = filled_boundary([np.array([(0, -1), (1, 0), (0, 1), (-1, 0)], dtype=np.float64)], "non-zero")
    for own, side in zip(cut_at_share(diamond, np.array([1.0, 0.0]), 0.5), (-1, 1), strict=True):
        assert sorted(map(tuple, np.round(own.starts, 6) + 0.0)) == sorted([(0, -1), (0, 1), (side, 0)])


def test_a_line_along_an_edge_cuts_there():
    """The lower half of a T is its stem."""
    outline = np.array([(-0.5, 0), (0.5, 0), (0.5, 2), (1, 2), (1, 3), (-1, 3), (-1, 2), (-0.5, 2)])
    stem, bar = cut_at_share(filled_boundary([outline], "non-zero"), np.array([0.0, 1.0]), 0.5)
    assert np.concatenate(stem.bounds) == pytest.approx([-0.5, 0, 0.5, 2], abs=1e-6)
    assert np.concatenate(bar.bounds) == pytest.approx([-1, 2, 1, 3], abs=1e-6)
    assert [len(outline_of(own).regions) for own in (stem, bar)] == [1, 1]
