# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids over triangles of the plane are closed and have the volume under their ends."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.remeshing.planar_mesh import planar_mesh
from convwass_addon.geometry.solids.prism import prism
from tests.flat_shapes import rectangle

FRAME = planar_mesh(filled_boundary([rectangle((0, 0), (3, 2)), rectangle((1, 0.5), (2, 1.5))], "even-odd"), 0.2)


def test_a_frame_has_a_hole_and_the_volume_of_its_area():
    solid = prism(FRAME, (-0.5, 1.5))
    assert topology(solid).closed
    assert topology(solid).euler == 0
    assert solid.volume == pytest.approx(5.0 * 2.0)
    assert solid.bounds == pytest.approx(np.array([(0.0, 0.0, -0.5), (3.0, 2.0, 1.5)]))


def test_ends_may_be_slanted():
    """Under z = x, the volume is the area times the x of its center."""
    heights = np.column_stack([np.full(len(FRAME.vertices), -1.0), FRAME.vertices[:, 0]])
    solid = prism(FRAME, heights)
    assert topology(solid).closed
    assert solid.volume == pytest.approx(5.0 * (1.0 + 1.5))
