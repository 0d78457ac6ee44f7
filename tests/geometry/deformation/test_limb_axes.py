# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Axes of limbs on cylinders, and none on shapes without limbs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.deformation.limb_axes import LimbAxes
from convwass_addon.geometry.deformation.unit_shape import UnitShape
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing.subdivision import with_short_edges
from tests.shapes import ball, box, tube_with_caps


def fine(mesh):
    return with_short_edges(mesh, 0.03 * mesh.root_area, 20_000).mesh


def test_a_rod_has_its_axis_up_to_its_ends():
    turn = Rotation.from_euler("xy", [40, 25], degrees=True)
    rod = tube_with_caps(radius=0.2, height=4.0, sides=24)
    found = LimbAxes.of(UnitShape.of(fine(TriangleMesh(turn.apply(rod.vertices), rod.faces))))
    np.testing.assert_allclose(np.abs(found.directions @ turn.apply([0, 0, 1])), 1.0, atol=1e-3)
    assert found.weights.min() > 0.5


@pytest.mark.parametrize("mesh", [ball(points=3000), box((4.0, 4.0, 0.1))], ids=["ball", "plate"])
def test_a_shape_without_limbs_has_no_axes(mesh):
    assert np.median(LimbAxes.of(UnitShape.of(fine(mesh))).weights) == 0.0
