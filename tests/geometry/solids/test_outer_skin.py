# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface of the union of overlapping bodies."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.solids.outer_skin import outer_skin
from tests.shapes import ball, box, joined, piece_count, torus

PLATE, POST = box((2.0, 2.0, 0.3)), box((0.3, 0.3, 2.0), (0.5, 0.2, -0.9))


def test_overlapping_bodies_have_the_volume_of_their_union():
    skin = outer_skin(joined(PLATE, POST))
    # The post reaches from -1.9 to 0.1, and the plate from -0.15 to 0.15.
    assert skin.volume == pytest.approx(2.0 * 2.0 * 0.3 + 0.3 * 0.3 * 1.75, rel=0.01)
    assert skin.area == pytest.approx(2.0 * 4.0 + 4.0 * 2.0 * 0.3 + 4.0 * 0.3 * 1.75, rel=0.02)
    assert topology(skin).closed
    assert piece_count(skin) == 1


def test_the_skin_lies_on_the_bodies():
    whole = joined(ball(points=2000), ball(center=(1.2, 0.3, 0.0), points=2000))
    skin = outer_skin(whole)
    assert ClosestPointFinder(whole.corners).find(skin.vertices).distances.max() < 0.01 * whole.longest_side
    inside = np.minimum(*(np.linalg.norm(skin.vertices - c, axis=1) for c in ((0, 0, 0), (1.2, 0.3, 0)))) < 0.97
    assert not inside.any()


def test_what_is_inside_is_left_out():
    skin = outer_skin(joined(box((2.0, 2.0, 2.0)), ball(0.5)))
    assert skin.volume == pytest.approx(8.0, rel=0.005)
    assert piece_count(skin) == 1


def test_bodies_that_touch_are_one():
    assert piece_count(outer_skin(joined(box(), box(center=(1.0, 0.0, 0.0))))) == 1


def test_other_bodies_stay_apart():
    skin = outer_skin(joined(PLATE, POST, ball(0.4, (3.0, 0.0, 0.0))))
    assert piece_count(skin) == 2


@pytest.mark.parametrize(
    "mesh",
    [
        torus(),
        joined(ball(), ball(center=(3.0, 0.0, 0.0))),
        joined(box(), box((1.0, 0.004, 2.0), (0.0, 0.0, 1.2))),
    ],
    ids=["one body", "apart", "too thin"],
)
def test_without_overlaps_there_is_no_skin(mesh):
    assert outer_skin(mesh) is None
