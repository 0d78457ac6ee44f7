# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Overlaps of filled areas; coverage of cells is tested where areas are filled."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.plane.coverage import overlap, self_overlap
from convwass_addon.geometry.plane.planar_fill import Boundary, filled_boundary
from tests.flat_shapes import rectangle


def area(low, high):
    return filled_boundary([rectangle(low, high)], "non-zero")


@pytest.mark.parametrize("offset", [0.0, 0.25, 0.5, 1.0])
def test_a_square_overlaps_with_itself_beside_it(offset):
    one, other = (area((x, -0.5), (x + 1.0, 0.5)) for x in (0.0, offset))
    assert overlap(one, other, 64) == pytest.approx((1.0 - offset) / (1.0 + offset), abs=0.01)
    assert overlap(other, one, 64) == pytest.approx(overlap(one, other, 64))


def test_overlaps_depend_on_neither_place_nor_size():
    one, other = area((0.0, 0.0), (2.0, 1.0)), area((0.5, 0.2), (1.0, 2.0))
    found = overlap(one, other, 200)
    assert found == pytest.approx(0.4 / (2.0 + 0.9 - 0.4), abs=0.01)
    far = [own.moved(np.array([-30.0, 7.0]), 1e-3) for own in (one, other)]
    assert overlap(*far, 200) == pytest.approx(found, abs=1e-6)


@pytest.mark.parametrize(("offset", "share"), [(2.0, 0.0), (0.5, 0.25), (0.0, 0.5)])
def test_what_lies_upon_itself_is_counted_once(offset, share):
    squares = [rectangle((x, 0.0), (x + 1.0, 1.0)) for x in (0.0, offset)]
    assert self_overlap(Boundary.of_rings(squares), 128) == pytest.approx(share, abs=0.01)


def test_what_is_turned_over_counts_as_overlap():
    squares = [rectangle((0.0, 0.0), (2.0, 2.0)), rectangle((3.0, 0.0), (4.0, 1.0))[::-1]]
    assert self_overlap(Boundary.of_rings(squares), 128) == pytest.approx(0.2, abs=0.01)
