# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much a motion leaves of the distance between two shapes, on pairs of balls at known distances."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.applications.motions.remaining_distance import TIMES, remaining_share
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, joined


def two_balls(apart: float) -> TriangleMesh:
    """Two balls at this distance from the center."""
    return joined(ball(radius=0.5, center=(-apart, 0, 0)), ball(radius=0.5, center=(apart, 0, 0)))


@dataclass(frozen=True)
class Closing:
    """Moves balls at 1 and at 2 towards each other, leaving a fraction of their distance."""

    left: float

    def moved(self, weights):
        t, done = weights[1], 1.0 - self.left
        return [
            MovedShape(shape, two_balls(place).vertices)
            for shape, place in ((two_balls(1.0), 1.0 + done * t), (two_balls(2.0), 2.0 - done * (1.0 - t)))
        ]


@pytest.mark.parametrize("left", [1.0, 0.4])
def test_the_share_of_the_distance_that_a_motion_leaves(left):
    assert 0.5 in TIMES
    found = remaining_share(Closing(left), [two_balls(1.0), two_balls(2.0)])
    assert found == pytest.approx(left, rel=0.05)


@pytest.mark.parametrize("cells", [20, 24, 32, 48])
def test_equal_shapes_leave_nothing(cells):
    """Rounding must not be compared with rounding."""
    shapes = [two_balls(1.0)] * 2
    still = SimpleNamespace(moved=lambda _weights: [MovedShape(shape, shape.vertices) for shape in shapes])
    assert remaining_share(still, shapes, cells=cells) == 0.0
