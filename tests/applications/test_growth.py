# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes of blends of shapes of different size, against closed forms."""

import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.interpolated_volumes import interpolated_volumes
from convwass_addon.applications.morphs.layouts import Blend
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import payloads
from tests.applications.maps import coarse_maps
from tests.shapes import ball

T = 0.25


def test_volumes_or_lengths_are_interpolated():
    assert interpolated_volumes((0.5, 0.5), [(1.0, 8.0)], "volume") == pytest.approx([4.5])
    assert interpolated_volumes((0.5, 0.5), [(1.0, 8.0)], "size") == pytest.approx([1.5**3])
    assert interpolated_volumes((0.2, 0.3, 0.5), [(1.0, 8.0, 27.0)], "size") == pytest.approx([2.3**3])


def test_parts_share_the_volume_of_the_whole_shape():
    # Parts of one shape only are not lost on the way.
    parts = [(1.0, 0.0), (0.0, 8.0)]
    assert interpolated_volumes((0.5, 0.5), parts, "volume") == pytest.approx([0.5, 4.0])
    found = interpolated_volumes((0.5, 0.5), parts, "size")
    assert found.sum() == pytest.approx(1.5**3)
    assert found[1] / found[0] == pytest.approx(8.0)


@pytest.mark.parametrize("motion", ["guided", "transport"])
@pytest.mark.parametrize(("growth", "length"), [("volume", np.cbrt(1.0 + (2.2**3 - 1.0) * T)), ("size", 1.0 + 1.2 * T)])
def test_a_body_grows_evenly_in_volume_or_size(motion, growth, length):
    unit = ball(points=400)
    small = TriangleMesh(unit.vertices * (1.0, 0.4, 0.3), unit.faces)
    large = TriangleMesh(2.2 * small.vertices, small.faces)
    settings = MorphSettings(resolution=28, motion=motion, growth=growth)
    inputs = MorphInputs.of([small, large], ["A", "B"])
    work = morph(inputs, [Blend((1.0 - T, T))], settings, computation=Computation(1))
    with coarse_maps():
        (frame,) = payloads(work, MorphFrame)
    assert frame.mesh.volume == pytest.approx(small.volume * length**3, rel=0.01)
    if motion == "guided":
        # The blur of transport makes small bodies rounder.
        found = np.ptp(frame.mesh.bounds, axis=0) / np.ptp(small.bounds, axis=0)
        np.testing.assert_allclose(found, length, rtol=0.02)
