# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends of inputs of different size have the interpolated volume."""

from dataclasses import dataclass

import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import Blend
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.motions.growing_motion import GrowingMotion, growth
from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import payloads
from tests.applications.maps import coarse_maps
from tests.shapes import ball


@dataclass(frozen=True)
class Scaling:
    """Balls whose radii are interpolated."""

    shapes: tuple[TriangleMesh, ...]
    radii: tuple[float, ...]

    def moved(self, weights):
        radius = np.dot(weights, self.radii)
        scaled = [shape.vertices * radius / own for shape, own in zip(self.shapes, self.radii, strict=True)]
        return [
            MovedShape(shape, vertices) if weight else None
            for shape, vertices, weight in zip(self.shapes, scaled, weights, strict=True)
        ]


def test_the_growth_makes_up_for_interpolated_lengths():
    assert growth((0.5, 0.5), (1.0, 8.0)) == pytest.approx(4.5 ** (1 / 3) / 1.5)
    assert growth((0.3, 0.7), (2.0, 2.0)) == pytest.approx(1.0)
    assert growth((1.0, 0.0, 0.0), (1.0, 8.0, 27.0)) == pytest.approx(1.0)


@pytest.mark.parametrize("t", [0.0, 0.2, 0.5, 1.0])
def test_balls_have_the_interpolated_volume_and_center(t):
    radii, centers = (1.0, 3.0), np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]])
    shapes = tuple(ball(radius, points=200) for radius in radii)
    volumes = np.array([shape.volume for shape in shapes])
    placed = GrowingMotion(Scaling(shapes, radii), volumes, np.zeros((2, 3)))
    for shape in filter(None, placed.moved((1.0 - t, t))):
        assert shape.mesh.volume == pytest.approx((1.0 - t) * volumes[0] + t * volumes[1])
    scaled = GrowingMotion(Scaling(shapes, radii), volumes, centers).moved((1.0 - t, t))
    plain = Scaling(shapes, radii).moved((1.0 - t, t))
    scale, center = growth((1.0 - t, t), volumes), t * centers[1]
    for one, other in zip(scaled, plain, strict=True):
        assert (one is None) == (other is None)
        if one is not None:
            np.testing.assert_allclose(one.vertices - center, scale * (other.vertices - center))


def test_a_small_head_becomes_a_large_one():
    small = TriangleMesh(ball(points=400).vertices * (1.0, 0.4, 0.3), ball(points=400).faces)
    large = TriangleMesh(2.2 * small.vertices, small.faces)
    settings = MorphSettings(resolution=32, motion="guided")
    work = morph(MorphInputs.of([small, large], ["A", "B"]), [Blend((0.5, 0.5))], settings, computation=Computation(1))
    with coarse_maps():
        (frame,) = payloads(work, MorphFrame)
    assert frame.mesh.volume == pytest.approx(0.5 * (small.volume + large.volume), rel=0.01)
    assert frame.record["motion"]["kind"] == "guided"
    # Its size follows from the volume, instead of an offset of the surface that would make it rounder.
    sizes = np.ptp(frame.mesh.bounds, axis=0)
    assert sizes[1:] / sizes[0] == pytest.approx([0.4, 0.3], abs=0.015)
