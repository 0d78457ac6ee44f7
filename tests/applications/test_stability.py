# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Neighbors of a slow bake hardly differ: nothing flickers, pops or jumps."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.geometry.meshes.centroid import centroid
from convwass_addon.geometry.solids.occupancy import occupancy
from tests.shapes import ball, box, joined, torus

FRAMES = 100
SETTINGS = MorphSettings(motion="transport", resolution=40)


def beast():
    """A body with legs and a head: parts that are pulled apart, and bridged."""
    legs = [box((0.2, 0.2, 0.9), (x, y, -0.6)) for x in (-0.75, 0.75) for y in (-0.3, 0.3)]
    return joined(box((2.0, 0.8, 0.6)), *legs, ball(0.35, (1.2, 0, 0.5)))


PAIRS = {
    "beast to ring": (beast(), torus(0.9, 0.35)),
    "beast to balls": (beast(), joined(ball(0.6, (0, 0, 0.9)), ball(0.6, (0, 0, -0.6)))),
}


def second_differences(curve):
    return np.abs(np.diff(np.asarray(curve), n=2, axis=0)).max()


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("start", [3, 47, 88])
def test_ten_of_a_hundred_frames_are_smooth(pair, start):
    shapes = PAIRS[pair]
    lattice = Lattice.around(shapes, SETTINGS.resolution, SETTINGS.sigma)
    blends = path_blends(2, FRAMES)[start : start + 10]
    frames = [step.payload for step in morph(MorphInputs.of(shapes, ("a", "b")), blends, SETTINGS) if step.payload]
    cells = [(frame.mesh.corners - lattice.origin) / lattice.spacing for frame in frames]
    filled = [occupancy(corners, lattice.shape) for corners in cells]
    areas = [frame.mesh.area / lattice.spacing**2 for frame in frames]
    moved = [
        float(np.abs(after - before).sum()) / area
        for before, after, area in zip(filled, filled[1:], areas, strict=False)
    ]
    # Measured: at most 0.063 cells in a frame, 1.2 times the median; bends of 0.7 % and 0.027 cells.
    assert max(moved) < 0.1
    assert max(moved) < 1.5 * np.median(moved) + 0.01
    assert second_differences([frame.mesh.volume for frame in frames]) < 0.01 * frames[0].mesh.volume
    assert second_differences([centroid(frame.mesh) / lattice.spacing for frame in frames]) < 0.06
