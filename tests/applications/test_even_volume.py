# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moved shapes are scaled about the interpolated center if their volume is far off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.applications.outlines.even_volume import EvenVolumeMotion
from tests.shapes import box

ONE, LARGER = box((1.0, 1.0, 1.0)), box((3.0, 3.0, 3.0), (4.0, 0.0, 0.0))
CENTERS = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]])
VOLUMES = np.array([1.0, 27.0])


@dataclass(frozen=True)
class Stays:
    """Moves nothing, but inflates shapes that have weight by a factor."""

    factor: float

    def moved(self, weights):
        return [
            MovedShape(own, center + self.factor * (own.vertices - center)) if weight > 0.0 else None
            for own, center, weight in zip((ONE, LARGER), CENTERS, weights, strict=True)
        ]


def moved(factor, weights, way=1.0):
    return EvenVolumeMotion(Stays(factor), VOLUMES, CENTERS, way).moved(weights)


def test_volumes_become_those_of_similar_shapes():
    for own in moved(1.5, [0.5, 0.5]):
        # Halfway between sides of 1 and 3; an offset reaches the rest.
        assert own.mesh.volume in (pytest.approx(8.0 * 1.05), pytest.approx(8.0 / 1.05))


def test_the_interpolated_center_stays():
    # The center of the second box is two to the right of the interpolated one.
    own = moved(2.0, [0.5, 0.5])[1]
    scale = np.cbrt(8.0 * 1.05 / 216.0)
    assert own.mesh.bounds.mean(axis=0) == pytest.approx([2.0 + 2.0 * scale, 0.0, 0.0])


def test_volumes_that_are_nearly_right_are_left():
    one, none = moved(1.01, [1.0, 0.0])
    assert none is None
    assert one.mesh.bounds == pytest.approx(1.01 * ONE.bounds)


def test_shapes_that_move_part_of_the_way_grow_part_of_the_way():
    one, larger = moved(2.0, [0.5, 0.5], way=0.5)
    assert one.mesh.volume == pytest.approx(1.05 * 1.5**3)
    assert larger.mesh.volume == pytest.approx(1.05 * 2.5**3)
